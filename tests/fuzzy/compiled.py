"""Small C++ programs that tests compile for themselves."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def compile_program(folder: Path, sources: list[Path], *flags: str) -> Path:
    """The program, built in `folder` from the sources; skips the test where there is no compiler.

    Source by source, since ccache, where there is one, takes up nothing else.
    """
    compiler = os.environ.get("CXX") or shutil.which("c++")
    if not compiler:
        pytest.skip("needs a C++ compiler")
    cached = [ccache] if (ccache := shutil.which("ccache")) else []
    objects = [folder / f"{source.stem}.o" for source in sources]
    assert len(set(objects)) == len(sources), "two sources of one name"
    for source, made in zip(sources, objects, strict=True):
        command = [*cached, *compiler.split(), "-std=c++17", *flags, "-c", source, "-o", made]
        subprocess.run(command, check=True)
    program = folder / sources[0].stem
    subprocess.run([*compiler.split(), *objects, "-o", program, *flags], check=True)
    return program


def pkg_config(package: str) -> list[str]:
    """Its compiler and linker flags; skips the test where the package is not installed."""
    found = shutil.which("pkg-config") and subprocess.run(
        ["pkg-config", "--cflags", "--libs", package], check=False, capture_output=True, text=True
    )
    if not found or found.returncode != 0:
        pytest.skip(f"needs pkg-config and the development files of {package}")
    return found.stdout.split()

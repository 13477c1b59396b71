"""An installation of the library, made once from the build tree that the tests run on."""

from __future__ import annotations

from pathlib import Path

from build_tree import ROOT, one_at_a_time, run
from pilotfish import core

_BESIDE = Path(core.__file__).parents[2]
BUILD = _BESIDE if (_BESIDE / "build.ninja").exists() else ROOT / "build" / "release"
PREFIX = ROOT / "build" / "installed"


def prefix() -> Path:
    """Where the library of this build is installed."""
    with one_at_a_time(PREFIX):
        # Headers of yesterday go; the others stay where they are, because another test may be compiling with them.
        for header in (PREFIX / "include").rglob("*.hpp"):
            if not (ROOT / "include" / header.relative_to(PREFIX / "include")).exists():
                header.unlink()
        run("cmake", "--install", BUILD, "--prefix", PREFIX, "--component", "development")
    return PREFIX


def examples() -> Path:
    """The folder of the C++ examples, built against the installation."""
    installed, build = prefix(), ROOT / "build" / "examples"
    with one_at_a_time(build):
        run("cmake", "-S", ROOT / "examples/cpp", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={installed}")
        run("cmake", "--build", build)
    return build

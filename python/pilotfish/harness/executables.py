"""Finds Pilotfish's programs, whether it was installed or just built."""

from __future__ import annotations

import importlib.util
import os
import shutil
import sysconfig
from collections.abc import Iterator
from pathlib import Path

from pilotfish.errors import ExecutableNotFoundError

COORDINATOR = "pilotfish-coordinator"
BASE = "pilotfish-base"
SIM = "pilotfish-sim"


def find_executable(name: str) -> Path:
    """The program ``name``: in $PILOTFISH_BIN (and then only there), in the build tree this package was
    imported from, beside the running Python, on the PATH, or in the newest of the checkout's
    ``build/*/apps``."""
    looked: list[str] = []
    for folder in _folders():
        looked.append(str(folder))
        file = folder / name
        if file.is_file() and os.access(file, os.X_OK):
            return file
    if "PILOTFISH_BIN" not in os.environ:
        looked.append("$PATH")
        if found := shutil.which(name):
            return Path(found)
    raise ExecutableNotFoundError(
        f"the program '{name}' was not found in: {', '.join(looked)}. "
        "Build it (cmake --preset release && cmake --build --preset release), install the package "
        "(pip install .), or say where it is with PILOTFISH_BIN"
    )


def _folders() -> Iterator[Path]:
    if chosen := os.environ.get("PILOTFISH_BIN"):
        yield Path(chosen)
        return
    bindings = importlib.util.find_spec("pilotfish.core")
    if bindings and bindings.origin:
        yield Path(bindings.origin).absolute().parents[2] / "apps"
    yield Path(sysconfig.get_path("scripts"))
    checkout = Path(__file__).resolve().parents[3]
    if (checkout / "CMakeLists.txt").is_file():
        yield from sorted(checkout.glob("build/*/apps"), key=lambda folder: folder.stat().st_mtime, reverse=True)

"""An installation of the library, made once from the build tree that the tests run on."""

from __future__ import annotations

import fcntl
from pathlib import Path

from build_tree import ROOT, run
from pilotfish import core

BUILD = (
    Path(core.__file__).parents[2]
    if (Path(core.__file__).parents[2] / "build.ninja").exists()
    else ROOT / "build/release"
)
PREFIX = ROOT / "build" / "installed"


def prefix() -> Path:
    """Where the library of this build is installed. One test at a time: they run in several processes."""
    PREFIX.mkdir(parents=True, exist_ok=True)
    with (PREFIX / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        run("cmake", "--install", BUILD, "--prefix", PREFIX, "--component", "development")
    return PREFIX


def examples() -> Path:
    """The folder of the C++ examples, built against the installation."""
    installed, build = prefix(), ROOT / "build" / "examples"
    build.mkdir(parents=True, exist_ok=True)
    with (build / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        run("cmake", "-S", ROOT / "examples/cpp", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={installed}")
        run("cmake", "--build", build)
    return build

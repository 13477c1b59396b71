"""Where the programs and libraries are that only tests use: they are built, and never installed."""

from __future__ import annotations

import fcntl
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pilotfish import core

ROOT = Path(__file__).parents[1]
# The preset "asan" of CMakePresets.json with the tests' programs; -O1 takes no longer to build and a fifth of the time
# to run.
SANITIZED = ROOT / "build" / "asan-tests"
_SANITIZERS = [
    "-DCMAKE_BUILD_TYPE=Debug",
    "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1",
    "-DPILOTFISH_SANITIZE=ON",
    "-DPILOTFISH_PYTHON=OFF",
    "-DPILOTFISH_WERROR=ON",
    "-DPILOTFISH_TESTS=ON",
    "-DCMAKE_UNITY_BUILD=ON",
]


def built(name: str, folder: str = "probes") -> Path:
    """``tests/FOLDER/NAME`` of the build tree that the package was imported from, else of build/release. With
    ``scripts/test --sanitize`` that is the one with sanitizers."""
    beside = Path(core.__file__).parents[2] / "tests" / folder / name
    return beside if beside.exists() else ROOT / "build" / "release" / "tests" / folder / name


def run(*command: object) -> str:
    """What the command writes to its standard output. Fails, with the end of what it wrote, if it does."""
    done = subprocess.run(list(map(str, command)), check=False, capture_output=True, text=True)
    assert done.returncode == 0, f"{command} failed:\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    return done.stdout


@contextmanager
def one_at_a_time(folder: Path) -> Iterator[None]:
    """Makes the folder; tests run in several processes, and only one of them builds in it at a time."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def build_sanitized(*targets: str) -> Path:
    """The folder tests/ of a build with AddressSanitizer and UBSan, in which these targets are up to date.

    Some minutes of one core the first time, nothing after that.
    """
    with one_at_a_time(SANITIZED):
        if not (SANITIZED / "build.ninja").exists():
            run("cmake", "-S", ROOT, "-B", SANITIZED, "-G", "Ninja", *_SANITIZERS)
        run("cmake", "--build", SANITIZED, "--target", *targets)
    return SANITIZED / "tests"

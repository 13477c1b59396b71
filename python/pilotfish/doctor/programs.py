"""Pilotfish's own programs: found, able to start, of one version."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path

from pilotfish import __version__
from pilotfish.doctor.finding import Finding, note, ok, wrong
from pilotfish.doctor.host import Host
from pilotfish.errors import ExecutableNotFoundError
from pilotfish.harness.executables import find_executable

PROGRAMS = {  # name -> needed on a robot
    "pilotfish-coordinator": True,
    "pilotfish-base": False,
    "pilotfish-sim": False,
    "pilotfish-spy": False,
}


def check_program(
    host: Host, name: str, needed: bool, find: Callable[[str], Path] = find_executable, version: str = __version__
) -> Finding:
    """Whether the program is there, runs, and is of this version."""
    try:
        file = find(name)
    except ExecutableNotFoundError:
        advice = "install the package pilotfish, or build it: scripts/build"
        return wrong(name, "not found", advice) if needed else note(name, "not found")
    shown = host.run([file, "--version"])
    if shown is None and file.is_file():
        return note(name, f"{file} --version did not answer in time", "look again when the computer is less busy")
    if shown is None or shown.returncode != 0:
        said = (shown.stderr.strip().splitlines() or ["nothing"])[-1] if shown else "nothing"
        advice = f"an older version, or a library is missing ({shlex.join(['ldd', str(file)])})"
        return wrong(name, f"{file} --version fails: {said}", advice)
    found = shown.stdout.split()[-1] if shown.stdout.split() else "none"
    if found != version:
        return wrong(
            name, f"{file} is version {found}, this is {version}", "install programs and package of one version"
        )
    return ok(name, f"{found} ({file})")

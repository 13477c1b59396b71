"""Versions that matter when something is reported, and LCM's own tools with the Java that lcm-spy needs."""

from __future__ import annotations

import platform
import re
import shutil
from importlib.metadata import PackageNotFoundError, version

from pilotfish import __version__
from pilotfish.doctor.finding import Finding, note, ok
from pilotfish.doctor.host import Host

_PACKAGES = ("lcm", "numpy", "scipy", "typer", "rich")
_TOOLS = ("lcm-logger", "lcm-logplayer", "lcm-spy")


def check_versions(host: Host) -> Finding:
    """Of the system, of Python and of what the package runs on: the line to put into a report."""
    release = dict(line.partition("=")[::2] for line in (host.read("/etc/os-release") or "").splitlines())
    system = release.get("PRETTY_NAME", "").strip('"') or platform.system()
    packages = ", ".join(f"{name} {_version(name)}" for name in _PACKAGES)
    return ok(
        "versions",
        f"pilotfish {__version__}, Python {platform.python_version()}, {packages}, {system}, "
        f"Linux {platform.release()} ({platform.machine()})",
    )


def check_lcm_tools(host: Host) -> Finding:
    """Whether LCM's logger, player and spy can be started from here."""
    missing = [name for name in _TOOLS if not shutil.which(name)]
    if not missing:
        return ok("lcm tools", ", ".join(_TOOLS))
    return note(
        "lcm tools",
        f"{', '.join(missing)} not on the PATH: nothing drives worse for it, but the bus cannot be recorded or shown",
        "sudo apt-get install liblcm-bin (lcm-spy: liblcm-java), or: . .venv/bin/activate",
    )


def check_java(host: Host) -> Finding:
    """What lcm-spy and pilotfish-spy run on; `pilotfish top` needs none."""
    shown = host.run(["java", "-version"])
    advice = "sudo apt-get install default-jre (pilotfish top and pilotfish doctor --following need no Java)"
    if shown is None or shown.returncode != 0:
        return note("java", "not installed: lcm-spy and pilotfish-spy do not start", advice)
    match = re.search(r'version "([^"]+)"', shown.stderr + shown.stdout)
    return ok("java", match[1] if match else "installed, of unknown version")


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "missing"

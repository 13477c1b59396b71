"""systemd units for programs and files at any place, from the hardened ones of the Debian package.

Templates are in data/robot/systemd; a test compares them line by line with packaging/systemd.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pilotfish import data
from pilotfish.files import read_text

_HOMES = ("/home", "/root", "/run/user")


@dataclass(frozen=True)
class Service:
    """What is entered into a template."""

    name: str  # of the robot
    folder: Path  # absolute
    program: Path  # absolute
    config: Path  # absolute
    user: str
    group: str


def coordinator_unit(service: Service) -> str:
    """pilotfish-NAME-coordinator.service."""
    return _filled("coordinator", service)


def base_unit(service: Service) -> str:
    """pilotfish-NAME-base.service."""
    return _filled("base", service)


def route_unit(folder: Path) -> str:
    """pilotfish-lcm-route.service, for a machine without the Debian package."""
    return read_text(data.path("robot/systemd/lcm-route.service")).replace("@FOLDER@", quoted(folder))


def _filled(which: str, service: Service) -> str:
    text = read_text(data.path(f"robot/systemd/{which}.service"))
    paths = (service.folder, service.program, service.config)
    values = {
        "@NAME@": service.name,
        "@FOLDER@": quoted(service.folder),
        "@PROGRAM@": quoted(service.program),
        "@CONFIG@": quoted(service.config),
        "@USER@": service.user,
        "@GROUP@": service.group,
        "@PROTECT_HOME@": "read-only" if any(below(path, _HOMES) for path in paths) else "yes",
    }
    for word, value in values.items():
        text = text.replace(word, value)
    return text


def below(path: Path, folders: tuple[str, ...]) -> bool:
    """Whether the path lies in one of the folders, also by way of a link."""
    return any(path.resolve().is_relative_to(folder) or path.is_relative_to(folder) for folder in folders)


def quoted(path: Path) -> str:
    """As systemd reads it: % and space have a meaning of their own in units. See systemd.unit(5), systemd.syntax(7)."""
    return str(path).replace("\\", "\\\\").replace("%", "%%").replace(" ", "\\x20")

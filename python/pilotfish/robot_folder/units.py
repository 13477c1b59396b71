"""systemd units for programs and files at any place, from the hardened ones of the Debian package.

Templates are in data/robot/systemd; a test compares them line by line with packaging/systemd.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

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
    return read_text(data.path("robot/systemd/lcm-route.service")).replace(
        "file:@FOLDER@/README.md", document_url(folder / "README.md")
    )


def _filled(which: str, service: Service) -> str:
    text = read_text(data.path(f"robot/systemd/{which}.service"))
    paths = (service.folder, service.program, service.config)
    values = {
        "@NAME@": service.name,
        "file:@FOLDER@/README.md": document_url(service.folder / "README.md"),
        "@PROGRAM@": program_words(service.program),
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


def unusable(path: Path) -> str:
    """Why systemd can have no such path in a unit; empty: it can. Lines end at a newline, and units are UTF-8."""
    if any(ord(letter) < 0x20 or ord(letter) == 0x7F for letter in str(path)):
        return f"{str(path)!r} has a newline, a tab or another control character in it, which no systemd unit can name"
    try:
        str(path).encode("utf-8")
    except UnicodeEncodeError:
        return f"{os.fsencode(path)!r} is not UTF-8, which systemd units are"
    return ""


def quoted(path: Path) -> str:
    """A word of ExecStart=, as systemd reads it: % is a specifier and $ a variable (systemd.service(5), "Command
    lines"), and space, quotes, backslash and ; have a meaning of their own (systemd.syntax(7))."""
    return _escaped(path).replace("$", "$$")


def program_words(path: Path) -> str:
    """The same for the program itself: its path is taken without variables, and systemd refuses one with quotes or
    backslashes in it ("contains special characters"), which env then finds."""
    return f"/usr/bin/env {quoted(path)}" if any(letter in "\"'\\" for letter in str(path)) else _escaped(path)


def _escaped(path: Path) -> str:
    escaped = str(path).replace("\\", "\\\\").replace("%", "%%")
    return "".join(f"\\x{ord(letter):02x}" if letter in " \"';" else letter for letter in escaped)


def document_url(file: Path) -> str:
    """For Documentation=: a URI, in ASCII, whose % would be specifiers."""
    return "file:" + quote(os.fsencode(file)).replace("%", "%%")

"""What the coordinator is set to, from its configuration: what its messages do not say.

Without ``--config`` the file is looked for in the command line of the coordinator that runs on this host.
"""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pilotfish.config_message import in_file
from pilotfish.doctor.host import Host
from pilotfish.doctor.network import DEFAULT_URL, group_of
from pilotfish.errors import ConfigError

if TYPE_CHECKING:
    from pilotfish.core import CameraModel, CameraMounting, Setpoint


@dataclass(frozen=True)
class Setup:
    """The part of a coordinator's configuration that decides what it can see."""

    file: Path
    name: str
    source: str
    width: int  # of the calibration [px]
    height: int  # [px]
    family: str
    ids: tuple[int, ...]
    body: str  # the leader's name
    frame_rate_hz: float = 30.0
    run: bool = True  # setpoint.run: it drives as soon as it is started
    file_name: str = ""  # the robot's name as the file says it, whatever the command line says
    camera: CameraModel | None = None
    mounting: CameraMounting | None = None
    setpoint: Setpoint | None = None

    @property
    def written_name(self) -> str:
        """The robot that the file is of."""
        return self.file_name or self.name

    @property
    def image_channel(self) -> str | None:
        """Where it waits for images; None if they do not come over the bus."""
        kind, _, argument = self.source.partition(":")
        if kind != "lcm":
            return None
        return argument or f"{self.name.upper()}_IMAGE"


@dataclass(frozen=True)
class Process:
    """One of Pilotfish's programs that runs on this host."""

    pid: int
    words: tuple[str, ...]  # its command line
    folder: Path  # its working directory
    default_url: str = ""  # $LCM_DEFAULT_URL, as far as this user may read it

    def option(self, name: str) -> str | None:
        """The value of ``--name VALUE`` or ``--name=VALUE``."""
        for word, following in zip(self.words, (*self.words[1:], ""), strict=True):
            if word == name:
                return following
            if word.startswith(f"{name}="):
                return word.partition("=")[2]
        return None

    @property
    def lcm_url(self) -> str:
        """The bus it is on."""
        return self.option("--lcm-url") or self.default_url or DEFAULT_URL

    def __str__(self) -> str:
        return f"process {self.pid}: {shlex.join(self.words)}"


def load_setup(file: Path, name: str | None = None, source: str | None = None) -> Setup:
    """Reads a coordinator's configuration; ``name`` and ``source`` as its command line overrides them. ConfigError."""
    from pilotfish.coordinator import load_coordinator

    try:
        loaded = load_coordinator(str(file))
    except ConfigError as error:
        raise ConfigError(in_file(str(error), file)) from error
    part = loaded.coordinator
    return Setup(
        file=file,
        name=name or loaded.name,
        source=source or loaded.source,
        width=part.camera.width,
        height=part.camera.height,
        family=part.leader.family,
        ids=tuple(sorted(tag.id for tag in part.leader.tags)),
        body=part.leader.name,
        frame_rate_hz=loaded.frame_rate_hz,
        run=part.setpoint.run,
        file_name=loaded.name,
        camera=part.camera,
        mounting=part.mounting,
        setpoint=part.setpoint,
    )


def runs_here(robot: str, url: str, processes: list[Process]) -> bool:
    """Whether one of these is the coordinator that is heard on the bus at ``url``, as far as its command line says."""
    for process in processes:
        name = process.option("--name")
        if same_bus(process.lcm_url, url) and (name is None or name.lower() == robot.lower()):
            return True
    return False


def running_coordinators(host: Host) -> list[Process]:
    """Those whose command lines this user may read."""
    return running(host, "pilotfish-coordinator")


def running(host: Host, program: str) -> list[Process]:
    """Processes of a program whose command lines this user may read."""
    found = []
    for file in host.find("/proc", "[0-9]*/cmdline"):
        try:
            words = tuple(word.decode(errors="replace") for word in file.read_bytes().split(b"\0") if word)
            if words and Path(words[0]).name == program:
                folder = (file.parent / "cwd").resolve()
                found.append(Process(int(file.parent.name), words, folder, _default_url(file.parent / "environ")))
        except (OSError, ValueError):
            continue  # it has ended in between
    return sorted(found, key=lambda process: process.pid)


def _default_url(environment: Path) -> str:
    try:
        words = environment.read_bytes().split(b"\0")
    except OSError:
        return ""  # another user's
    return next((word[16:].decode(errors="replace") for word in words if word.startswith(b"LCM_DEFAULT_URL=")), "")


def same_bus(url: str, other: str) -> bool:
    """Whether messages go from one to the other: by group and port; options such as ttl do not separate."""
    group = group_of(url)
    return group == group_of(other) if group else url == other


def setups_here(url: str, processes: list[Process]) -> dict[str, Setup]:
    """Of every coordinator of this host on that bus, by its name in small letters; those whose files can be read."""
    found: dict[str, Setup] = {}
    for process in processes:
        config = process.option("--config")
        if config is None or not same_bus(process.lcm_url, url):
            continue
        try:
            setup = load_setup(process.folder / config, process.option("--name"), process.option("--source"))
        except (ConfigError, OSError, ValueError):
            continue
        found.setdefault(setup.name.lower(), setup)
    return found


def find_setup(robot: str, url: str, processes: list[Process]) -> Setup | None:
    """Of the running coordinator of that name on that bus; None if there is none, or its files cannot be read here."""
    return setups_here(url, processes).get(robot.lower())

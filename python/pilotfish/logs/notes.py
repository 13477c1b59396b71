"""What a recording says once, or over and over: settings, counters, times of stages, damage."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from pilotfish.logs.flipped_channels import flipped_channels
from pilotfish.logs.losses import Loss

STAGE_LIMITS_MS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)  # of stage_t


@dataclass(frozen=True)
class SettingsFile:
    """A file that the coordinator was configured with."""

    role: str  # which key names it: config, camera.calibration, leader, fuzzy, tuning
    name: str
    text: str


@dataclass(frozen=True)
class Settings:
    """What a coordinator was started with, as its black box has recorded it."""

    program: str
    command_line: str
    overrides: tuple[str, ...]
    files: tuple[SettingsFile, ...]


@dataclass
class Stage:
    """How long a stage of the control loop took: counts between STAGE_LIMITS_MS (11 numbers), the longest [ms]."""

    counts: list[int]
    max_ms: float


@dataclass
class RobotNotes:
    """Of one robot. Counters and stages are sums over all sessions in the recording."""

    name: str = ""
    settings: list[Settings] = field(default_factory=list)  # each once, in the order in which they came
    sessions: list[int] = field(default_factory=list)
    simulated: bool = False  # its commands say that time is a simulator's
    counters: dict[str, int] = field(default_factory=dict)
    stages: dict[str, Stage] = field(default_factory=dict)


@dataclass
class RunNotes:
    """Of a whole recording."""

    start_utime: int = 0  # wall clock at the first event [us]: t_s counts from here
    robots: dict[str, RobotNotes] = field(default_factory=dict)
    events: Counter[str] = field(default_factory=Counter)  # by channel
    channels_of: dict[str, set[str]] = field(default_factory=dict)  # by robot: where its messages came from
    cameras: Counter[str] = field(default_factory=Counter)  # events with images, by whose camera it is
    losses: list[Loss] = field(default_factory=list)  # damaged places, in the order of the files
    unreadable: int = 0  # events on our channels that are no messages of these types

    @property
    def loss_texts(self) -> list[str]:
        """What is lost, for people."""
        flipped = flipped_channels(self.events)
        of_names = []
        if flipped:
            shown = ", ".join(f"{channel!r} for {meant}" for channel, meant in list(flipped.items())[:3])
            more = f" and {len(flipped) - 3} more" if len(flipped) > 3 else ""
            of_names = [f"{len(flipped)} messages have a damaged channel's name, and are left out: {shown}{more}"]
        return [*(loss.text(self.start_utime) for loss in self.losses), *of_names]

    def nobodys(self) -> set[str]:
        """Robots that are known only by channels with a damaged name."""
        flipped = flipped_channels(self.events)
        return {robot for robot, channels in self.channels_of.items() if channels <= flipped.keys()}

    def of(self, robot: str) -> RobotNotes:
        """Made when it is asked for."""
        return self.robots.setdefault(robot, RobotNotes(robot))


def settings_of(message: Any) -> Settings:
    """What a box_start_t holds."""
    files = [SettingsFile(file.role, file.name, bytes(file.data).decode("utf-8", "replace")) for file in message.files]
    return Settings(message.program, message.command_line, tuple(message.overrides), tuple(files))

"""A whole recording as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pilotfish.black_box.log import Damage
from pilotfish.errors import RecordingError
from pilotfish.logs.columns import TABLES, Column
from pilotfish.logs.notes import Settings, Stage


@dataclass(frozen=True)
class Table:
    """Equally long columns. ``table["distance_m"]`` is an array (N,): float64 with NaN, int64 with -1 or bool; a column
    of words is int16 codes (``words`` spells them), one of text an object array."""

    columns: tuple[Column, ...]
    arrays: Mapping[str, NDArray[Any]]

    def __len__(self) -> int:
        return len(next(iter(self.arrays.values())))

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.arrays[name]

    def words(self, name: str) -> NDArray[np.str_]:
        """A column of words, spelled; shape (N,)."""
        column = next(column for column in self.columns if column.name == name)
        codes, places = np.unique(self.arrays[name], return_inverse=True)
        return np.array([column.word(int(code)) for code in codes], dtype=np.str_)[places]


@dataclass(frozen=True)
class RunEvent:
    """Something that happened; ``kind``: start, begin (of a recording, in the middle of a run), status, setpoint, stop,
    resume, gap, damage, counter, configuration."""

    t_s: float
    kind: str
    text: str


@dataclass(frozen=True)
class RobotRun:
    """What one robot did, as far as it was recorded. ``poses`` and ``intents`` may be all there is (a leader's)."""

    name: str
    frames: Table
    tags: Table
    commands: Table
    wheels: Table
    poses: Table
    odometry: Table
    intents: Table
    events: tuple[RunEvent, ...]
    settings: tuple[Settings, ...]  # of a black box; more than one if it was started with others in between
    sessions: tuple[int, ...]
    simulated: bool  # time was a simulator's
    counters: Mapping[str, int]
    stages: Mapping[str, Stage]

    @property
    def last_settings(self) -> Settings | None:
        """None unless a black box has recorded them."""
        return self.settings[-1] if self.settings else None


@dataclass(frozen=True)
class Run:
    """A recording. ``robots``: by name, those with frames first."""

    path: Path
    robots: Mapping[str, RobotRun]
    channels: Mapping[str, int]  # events by channel
    cameras: Mapping[str, int]  # events with images, by whose camera it is
    damage: tuple[Damage, ...]
    unreadable: int
    losses: tuple[str, ...] = ()  # what the damage has cost, for people

    @property
    def coordinators(self) -> list[RobotRun]:
        """The robots whose coordinators are in it, and had a picture at least."""
        return [robot for robot in self.robots.values() if (robot.frames["utime_us"] > 0).any()]

    def recorded_coordinators(self) -> list[RobotRun]:
        """The same; RecordingError, which says what there is instead, if there are none."""
        if not self.coordinators:
            channels = ", ".join(self.channels)
            raise RecordingError(f"{self.path}: no frame of a coordinator in it; channels in it: {channels}")
        return self.coordinators


TABLE_NAMES = tuple(TABLES)

"""Whether two recordings are of one run, and what one has that the other has not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from pilotfish.logs.run import RobotRun


@dataclass(frozen=True)
class SameRun:
    """Two recordings of the same start of a coordinator, by their names; how many frames are in which."""

    one: str
    other: str
    both: int
    only_one: int
    only_other: int

    @property
    def text(self) -> str:
        """For people."""
        head = f"{self.one} and {self.other} are recordings of the same run"
        if not (self.only_one or self.only_other):
            return f"{head}: both have all of its {self.both} frames."
        differ = f"{self.only_one} are only in {self.one}, {self.only_other} only in {self.other}"
        return (
            f"{head}: {self.both} frames are in both, {differ}. Figures differ by these: a recording that began later, "
            "ended earlier or lost messages has not seen them."
        )


def same_runs(robots: Mapping[str, RobotRun]) -> list[SameRun]:
    """Of every pair of which the robot and at least one session of its coordinator are the same; in the given order."""
    found = []
    for (one, first), (other, second) in combinations(robots.items(), 2):
        if first.name.lower() != second.name.lower() or not set(first.sessions) & set(second.sessions):
            continue
        mine, theirs = first.frames["utime_us"], second.frames["utime_us"]
        both = len(np.intersect1d(mine, theirs))
        found.append(SameRun(one, other, both, len(np.setdiff1d(mine, theirs)), len(np.setdiff1d(theirs, mine))))
    return found

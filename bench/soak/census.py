"""What a process has of the machine, over robot time, and whether that grows."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

SETTLED_S = 600.0  # memory may grow until then
MINUTE_S, HOUR_S = 60.0, 3600.0


@dataclass
class Census:
    """One process; a sample before every fault."""

    at_s: list[float] = field(default_factory=list)
    rss_kb: list[int] = field(default_factory=list)
    descriptors: list[int] = field(default_factory=list)
    threads: list[int] = field(default_factory=list)

    def sample(self, pid: int, robot_s: float) -> None:
        fields = dict(line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
        self.at_s.append(round(robot_s, 3))
        self.rss_kb.append(int(fields["VmRSS"].split()[0]))
        self.threads.append(int(fields["Threads"]))
        self.descriptors.append(len(list(Path(f"/proc/{pid}/fd").iterdir())))

    def minutes(self) -> Minutes:
        number = np.floor_divide(self.at_s, MINUTE_S)
        rss_mb = np.array(self.rss_kb) / 1024.0
        each = np.unique(number)
        low, high = (np.array([pick(rss_mb[number == one]) for one in each]) for pick in (np.min, np.max))
        return Minutes(each * MINUTE_S, low, high)

    def growth(self) -> Growth | None:
        """None if it ended before the memory had settled and some minutes had passed after that."""
        minutes = self.minutes()
        after = minutes.at_s >= SETTLED_S
        if np.count_nonzero(after) < 3:
            return None
        at_s, low_mb, high_mb = minutes.at_s[after], minutes.low_mb[after], minutes.high_mb[after]
        last = at_s > at_s[-1] - HOUR_S
        first = at_s < at_s[0] + HOUR_S
        return Growth(
            fitted_mb=float(np.polyfit(at_s, low_mb, 1)[0] * (at_s[-1] - at_s[0])),
            floor_mb=float(low_mb[last].max() - low_mb[0]),
            peak_mb=float(high_mb[last].max() - high_mb[first].max()),
            peak_above_floor_mb=float(high_mb[last].max() - low_mb[0]),
        )


@dataclass(frozen=True)
class Minutes:
    """The lowest and the highest sample of each minute: messages that are on their way, and those that never get whole,
    come and go; what leaks raises the lowest, too."""

    at_s: np.ndarray  # beginnings
    low_mb: np.ndarray
    high_mb: np.ndarray


@dataclass(frozen=True)
class Growth:
    """Of the resident memory, from the eleventh minute on."""

    fitted_mb: float  # of the straight line of least squares through the minutes' lowest samples
    floor_mb: float  # the last hour's highest of the minutes' lowest samples, above that of the eleventh minute
    peak_mb: float  # the last hour's highest sample, above the highest of the first hour
    peak_above_floor_mb: float  # the same, above the eleventh minute's lowest: what is held for a while

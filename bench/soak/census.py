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
        at_s, rss_mb = np.array(self.at_s), np.array(self.rss_kb) / 1024.0
        if len(at_s) == 0 or at_s[-1] < SETTLED_S + 3 * MINUTE_S:
            return None
        at_s, rss_mb = at_s[at_s >= SETTLED_S], rss_mb[at_s >= SETTLED_S]
        first, last = rss_mb[at_s < at_s[0] + HOUR_S], rss_mb[at_s > at_s[-1] - HOUR_S]
        return Growth(
            fitted_mb=float(np.polyfit(at_s, rss_mb, 1)[0] * (at_s[-1] - at_s[0])),
            lowest_mb=float(last.min() - first.min()),
            median_mb=float(np.median(last) - np.median(first)),
            high_mb=float(np.quantile(last, 0.95) - np.quantile(first, 0.95)),
            highest_mb=float(last.max() - rss_mb[0]),
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
    """Of the resident memory, from the eleventh minute on. What is held for a while makes single samples differ by
    some MB, so the last hour is compared with the first one."""

    fitted_mb: float  # of the straight line of least squares through all samples, from the first to the last of them
    lowest_mb: float  # the lowest sample of the last hour, above that of the first
    median_mb: float
    high_mb: float  # the same of the samples' 95th percentiles
    highest_mb: float  # the highest sample of the last hour above the very first one: growth and swing together

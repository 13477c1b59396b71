"""What robots cost: one, twenty, a hundred coordinators with rendered pictures in one process."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from pilotfish import coordinator, data, sim

RATE_HZ = 30.0
GAP_M = 1.1


@dataclass(frozen=True)
class Cost:
    """Of a world of so many robots that follow, over all its pictures."""

    robots: int
    workers: int
    frames: int  # a robot
    elapsed_s: float
    tracking_ratio: float

    @property
    def real_time_factor(self) -> float:
        """Simulated over real time; above 1: faster than real time."""
        return self.frames / RATE_HZ / self.elapsed_s

    @property
    def per_picture_ms(self) -> float:
        """Real time for one robot's one picture: rendered, seen, answered."""
        return 1e3 * self.elapsed_s / (self.frames * self.robots)

"""The steady gaps of a long chain: every robot's error relative to its leader behind a leader on a line, a circle and a
figure of eight.

A robot that keeps its leader straight ahead (theta_pd = 0) at the distance d drives on the tangent to its own circle,
so its radius is r_(i+1) = sqrt(r_i^2 - d^2): a chain of R robots needs a leader's circle of more than d sqrt(R - 1), or
its last robots would turn on the spot.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pilotfish.errors import UsageError
from pilotfish.formation.chain import chain_of
from pilotfish.formation.measures import Keeping, keeping, least_apart_m, positions
from pilotfish.formation.run import play
from pilotfish.harness.run import OnProgress

GOAL_M, GOAL_RAD = 0.005, math.radians(0.3)
PATHS = ("line", "circle", "figure_eight")


@dataclass(frozen=True)
class Gaps:
    """One path: how every robot kept its place over the last quarter of the run."""

    path: str
    law: str
    keeping: list[Keeping]
    least_apart_m: float
    nearest: tuple[str, str]

    @property
    def reached(self) -> bool:
        """Whether every robot stayed within the goal, 5 mm and 0.3 degrees, all the time."""
        return all(k.max_error_m <= GOAL_M and k.max_bearing_error_rad <= GOAL_RAD for k in self.keeping)


def path_of(path: str, robots: int, spacing_m: float, speed_mps: float) -> tuple[dict[str, Any], float]:
    """(trajectory as in a scenario, duration [s]) of one that such a chain can follow. The circle's last robot turns
    with a radius of 1.5 m or more. A lobe of the eight is 2.2 times as long as the chain: its end has to have left the
    crossing before the head is there again. The run ends after a round and a third; its last quarter is that third."""
    profile = {"speed_mps": speed_mps, "acceleration_mps2": 0.2}
    settle_s = 10.0 + 4.0 * robots
    length_m = (robots - 1) * spacing_m
    if path == "line":
        return {"kind": "line", **profile}, settle_s * 4 / 3
    if path == "circle":
        radius_m = math.ceil(10.0 * math.sqrt(length_m * spacing_m + 1.5**2)) / 10.0
        round_s = 2.0 * math.pi * radius_m / speed_mps
        return {"kind": "circle", "radius_m": radius_m, **profile}, max(settle_s, 2.0 * round_s)
    if path == "figure_eight":
        # A lap of Gerono's lemniscate with b = 0.75 a is 6.1 a long, a lobe half of that.
        half_length_m = round(max(2.0, 2.2 * length_m / 3.05), 1)
        lap_s = 6.1 * half_length_m / speed_mps
        shape = {"half_length_m": half_length_m, "half_width_m": round(0.75 * half_length_m, 3)}
        return {"kind": "figure_eight", **shape, **profile}, 4.0 / 3.0 * lap_s
    raise UsageError(f"path: '{path}' is not one of {', '.join(PATHS)}")


def steady_gaps(
    path: str,
    law: str = "anticipate",
    *,
    robots: int = 12,
    spacing_m: float = 1.0,
    speed_mps: float = 0.2,
    content: Mapping[str, Any] | None = None,
    on_progress: OnProgress | None = None,
) -> Gaps:
    """Drives the chain with drawn measurements; a leader that is outside the picture or behind another robot is not
    seen. ``content``: more keys of a formation file, such as ``coordinator`` or ``hardware``."""
    trajectory, duration_s = path_of(path, robots, spacing_m, speed_mps)
    said = {**(content or {}), "trajectory": trajectory, "duration_s": duration_s}
    run = play(chain_of(robots, spacing_m, said), law=law, on_progress=on_progress)
    apart_m, nearest = least_apart_m(positions(run), slice(None))
    return Gaps(path, law, keeping(run), apart_m, nearest)

"""Where a robot has driven, from its twists alone.

A twist (v, omega) that holds for dt turns the heading by a = omega dt and moves the base along an arc of length
s = v dt. Its chord has the length s sin(a/2) / (a/2), which is s where omega is 0, and the direction psi + a/2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

MAX_STEP_S = 0.2  # a twist holds no longer: commands come every 50 ms at least, and wheels stop 100 ms after the last
_MAX_MPS, _MAX_RADPS = 100.0, 100.0  # beyond, a message is no robot's


@dataclass(frozen=True)
class PlanarPose:
    """x, y [m] and heading [rad] in a frame that stands where the robot was first heard of."""

    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0

    def moved(self, linear_mps: float, angular_radps: float, dt_s: float) -> PlanarPose:
        """After ``dt_s`` (at most MAX_STEP_S) of this twist; unchanged by a twist that no robot can do."""
        if abs(linear_mps) > _MAX_MPS or abs(angular_radps) > _MAX_RADPS:
            return self
        dt_s = min(max(dt_s, 0.0), MAX_STEP_S)
        turn_rad = angular_radps * dt_s
        half = 0.5 * turn_rad
        chord_m = linear_mps * dt_s * (math.sin(half) / half if half else 1.0)
        along = self.heading_rad + half
        return PlanarPose(
            self.x_m + chord_m * math.cos(along), self.y_m + chord_m * math.sin(along), self.heading_rad + turn_rad
        )

    def point_at(self, distance_m: float, bearing_rad: float) -> tuple[float, float]:
        """What is seen there from here, in the frame of this pose [m]."""
        along = self.heading_rad + bearing_rad
        return self.x_m + distance_m * math.cos(along), self.y_m + distance_m * math.sin(along)

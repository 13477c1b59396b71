"""Which setpoints a robot can accept at all, said in the units of the page: metres and degrees."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pilotfish.view.setup import Setup

# Bounds of core.Setpoint (include/pilotfish/core/setpoint.hpp), which says them in radians.
LEAST_M, MOST_M, MOST_BEARING_DEG = 0.05, 20.0, 70.0
_ROUNDING_DEG = 1e-6  # of 70 degrees in radians and back


@dataclass(frozen=True)
class SetpointLimits:
    """``stop_distance_m``: the robot's safety.stop_distance_m, if its configuration is known: nearer is refused."""

    stop_distance_m: float | None = None

    @property
    def distance_m(self) -> tuple[float, float]:
        """Least and most."""
        return max(LEAST_M, self.stop_distance_m or 0.0), MOST_M

    @property
    def bearing_deg(self) -> tuple[float, float]:
        """Least (to the right) and most."""
        return -MOST_BEARING_DEG, MOST_BEARING_DEG

    def refusal(self, distance_m: float | None, bearing_rad: float | None) -> str:
        """Why the robot would refuse this; empty: it would not. None: unchanged."""
        least_m, most_m = self.distance_m
        if distance_m is not None and not least_m <= distance_m <= most_m:
            why = ""
            if self.stop_distance_m is not None and LEAST_M <= distance_m < least_m:
                why = f": {least_m:g} m is the robot's safety.stop_distance_m"
            return f"distance: {distance_m:g} m is not within {least_m:g} to {most_m:g} m{why}"
        if bearing_rad is not None and not abs(math.degrees(bearing_rad)) <= MOST_BEARING_DEG + _ROUNDING_DEG:
            asked = f"{math.degrees(bearing_rad):.4g}".replace("-", "\N{MINUS SIGN}")
            return f"bearing: {asked}° is not within \N{MINUS SIGN}{MOST_BEARING_DEG:g} to {MOST_BEARING_DEG:g}°"
        return ""


def limits_of(setup: Setup) -> SetpointLimits:
    """Of a robot."""
    return SetpointLimits(setup.stop_distance_m)

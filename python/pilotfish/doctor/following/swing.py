"""Whether a distance swings about what is to be kept: the turning points of a curve. Pure functions of numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

_LEAST_M, _LEAST_SHARE = 0.2, 0.15  # from one turning point to the next: more than any law of ours does once it follows
_BEYOND_M = 0.05  # past what is to be kept, on either side


@dataclass(frozen=True)
class Swing:
    """A distance error, wanted minus measured, positive: too close. Extremes are those of the deciding part [m].

    ``crossings``: how often it went past the wanted distance by a swing's size and by _BEYOND_M on both sides, in all
    of the watch. ``overshot_m``: how far it was too close after it had been too far, in the deciding part.
    """

    lowest_m: float = math.nan
    highest_m: float = math.nan
    crossings: int = 0
    overshot_m: float = 0.0

    @property
    def swings(self) -> bool:
        """To and fro: one way is an overshoot, and ends."""
        return self.crossings >= 2

    def overshoots(self, wanted_m: float) -> bool:
        """It came too close by more than a following robot does."""
        return self.overshot_m >= swing_size_m(wanted_m)


def swing_size_m(wanted_m: float) -> float:
    """From one turning point to the next: what is called a swing at this distance."""
    return max(_LEAST_M, _LEAST_SHARE * wanted_m) if math.isfinite(wanted_m) else _LEAST_M


def turning_points(values: Sequence[float], least: float) -> list[int]:
    """Indices of first value, turning points and last extreme: from each to the next it is ``least`` or more, so
    what is smaller is no turn. One index alone: nothing of that size happened."""
    if not values:
        return []
    low = high = 0
    points: list[int] = []
    rising: bool | None = None
    for k, value in enumerate(values):
        low, high = (k if value < values[low] else low), (k if value > values[high] else high)
        if rising is not True and value - values[low] >= least:
            points.append(low)
            rising, high = True, k
        elif rising is not False and values[high] - value >= least:
            points.append(high)
            rising, low = False, k
    if rising is None:
        return [0]
    return [*points, high if rising else low]


def swing(errors_m: Sequence[tuple[float, float]], wanted_m: float, deciding_since_s: float) -> Swing:
    """Of (time [s], error [m]) in the order of time. A swing that ended before the deciding part is none."""
    finite = [(time_s, error_m) for time_s, error_m in errors_m if math.isfinite(error_m)]
    late = [error_m for time_s, error_m in finite if time_s >= deciding_since_s]
    if not late:
        return Swing()
    values = [error_m for _, error_m in finite]
    points = turning_points(values, swing_size_m(wanted_m))
    legs = [(values[a], values[b], finite[b][0]) for a, b in zip(points, points[1:], strict=False)]
    across = [end_s for a, b, end_s in legs if min(a, b) <= -_BEYOND_M and max(a, b) >= _BEYOND_M]
    over = across and across[-1] < deciding_since_s
    overshot = [b for a, b, end_s in legs if a <= -_BEYOND_M and b >= _BEYOND_M and end_s >= deciding_since_s]
    return Swing(min(late), max(late), 0 if over else len(across), max(overshot, default=0.0))

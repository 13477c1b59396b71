"""Where the body's base frame is, seen from the reference tag: bMr.

Either it was measured where that tag sits (``KnownTag``), or the robot turned in place (``TurningCentre``): then the
turning axis is the base's z axis through its origin, which is what a follower steers by. A turn cannot determine
where forward is, and how high the ground: the reference tag's facing says the one, one measured height the other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.body.turning import TurningAxis, fit_turning_axis
from pilotfish.core import BodyTag
from pilotfish.errors import BodyLearningError

MIN_UPRIGHT = 0.2  # horizontal part of a tag's unit normal: a tag that looks up or down faces no direction


@dataclass(frozen=True)
class KnownTag:
    """The reference tag's pose on the body, as measured."""

    tag: BodyTag


@dataclass(frozen=True)
class TurningCentre:
    """The base is where the robot turned. ``facing_rad``: of the reference tag, 0 forward, +pi/2 left, pi to the rear.
    ``height_of``: the id of a tag and the height of its centre above the ground [m]; without it z = 0 is the height
    of the reference tag."""

    facing_rad: float = math.pi
    height_of: tuple[int, float] | None = None


Base = KnownTag | TurningCentre


def base_from_reference(
    base: Base, cMr: np.ndarray, rMt: np.ndarray, ids: np.ndarray, weights: np.ndarray | None = None
) -> tuple[np.ndarray, TurningAxis | None]:
    """bMr (4, 4), and the axis if there is one; ``cMr`` (N, 4, 4) count ``weights`` (N,) times; ``rMt`` (T, 4, 4)."""
    if isinstance(base, KnownTag):
        return base.tag.oMt, None
    axis = fit_turning_axis(cMr, weights)
    outward = np.array([0.0, 0.0, -1.0])  # the tag's z axis points into the wall
    level = outward - (outward @ axis.up) * axis.up
    if np.linalg.norm(level) < MIN_UPRIGHT:
        raise BodyLearningError(
            "the reference tag looks up or down, so it does not show where forward is: choose another with "
            "--reference-tag ID"
        )
    level /= np.linalg.norm(level)
    left_of_level = np.cross(axis.up, level)
    c, s = math.cos(base.facing_rad), math.sin(base.facing_rad)
    # The tag faces c forward + s left; turned back by its facing that is forward.
    forward, left = c * level - s * left_of_level, s * level + c * left_of_level
    bMr = np.eye(4)
    bMr[:3, :3] = np.stack([forward, left, axis.up])
    bMr[:3, 3] = -bMr[:3, :3] @ axis.origin_m
    if base.height_of is not None:
        tag_id, height_m = base.height_of
        if tag_id not in ids:
            raise BodyLearningError(f"--height-of {tag_id}: that tag was not seen; seen were {ids.tolist()}")
        bMr[2, 3] += height_m - (bMr @ rMt[int(np.searchsorted(ids, tag_id))])[2, 3]
    return bMr, axis

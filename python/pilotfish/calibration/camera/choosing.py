"""Which pictures of a film are worth calibrating from: those in which the board is still, and held as never before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

STILL_SHARE = 0.0025  # of the picture's width, from one picture to the next: 1.6 px of 640
NEW_SHARE = 0.06  # of it, from every view chosen so far
MOVED, KNOWN, CHOSEN, NOTHING = "moving", "like one before", "taken", "no board"


@dataclass(frozen=True)
class Corners:
    """ids (P,) and pixels (P, 2) of a board's corners in one picture."""

    ids: np.ndarray
    corners_px: np.ndarray


@dataclass(frozen=True)
class Chosen:
    """What was seen last, and the views that were taken."""

    last: Corners | None = None
    views: tuple[Corners, ...] = ()


def consider(chosen: Chosen, seen: Corners, width_px: int) -> tuple[Chosen, str]:
    """The state after one more picture of a film, and what came of it: CHOSEN, or why not.

    Two views differ by the mean distance their common corners have moved: shifting, turning, tilting and bringing the
    board nearer all move corners. Views without common corners differ.
    """
    if len(seen.ids) == 0:
        return Chosen(None, chosen.views), NOTHING
    still = chosen.last is not None and apart_px(chosen.last, seen) <= STILL_SHARE * width_px
    if not still:
        return Chosen(seen, chosen.views), MOVED
    if any(apart_px(view, seen) <= NEW_SHARE * width_px for view in chosen.views):
        return Chosen(seen, chosen.views), KNOWN
    return Chosen(seen, (*chosen.views, seen)), CHOSEN


def apart_px(a: Corners, b: Corners) -> float:
    """Mean distance of the corners that both have; infinite if there are none."""
    _, in_a, in_b = np.intersect1d(a.ids, b.ids, return_indices=True)
    if len(in_a) == 0:
        return np.inf
    return float(np.linalg.norm(a.corners_px[in_a] - b.corners_px[in_b], axis=1).mean())

"""Branch and bound: the greatest value of something over all inputs, between a proved upper bound and a value that is
reached."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pilotfish.fuzzy_proof.boxes import Boxes
from pilotfish.fuzzy_proof.enclosure import Bounds, Encloser
from pilotfish.fuzzy_proof.interval import FloatArray, Interval

OnShare = Callable[[float], None]  # share of all inputs that is settled, 0 to 1

MAX_BOXES = 400_000  # in one question: some 10 s; what is open then is bounded as it is


@dataclass(frozen=True)
class Optimum:
    """The supremum (of ``Range.low``: the infimum) lies between ``reached``, at the inputs (e, ec), and ``bound``,
    which is proved."""

    bound: float
    reached: float
    at: tuple[float, float]
    boxes: int  # that were looked at


Objective = Callable[[Boxes, Bounds], tuple[FloatArray, FloatArray]]
"""Of boxes (N,): upper bounds of the objective over each, and the values that it certainly has at the middles."""


def maximise(
    encloser: Encloser,
    objective: Objective,
    tolerance: float,
    *,
    reached: float = -np.inf,
    at: tuple[float, float] = (np.nan, np.nan),
    on_share: OnShare | None = None,
) -> Optimum:
    """Boxes whose bound is within ``tolerance`` of the best value reached so far are settled; the others are halved.

    ``reached``: a value known to be reached, at ``at``. A middle counts only if it certainly lies in its piece. Every
    box that is dropped has no point of its piece or a bound within the tolerance, so the bound returned holds for all
    inputs.
    """
    boxes = encloser.boxes
    total = _extent(boxes).sum()
    settled, seen = -np.inf, 0
    while len(boxes):
        bounds = encloser.bounds(boxes)
        seen += len(boxes)
        upper, values = objective(boxes, bounds)
        candidates = np.where(_middles_inside(encloser, boxes), values, -np.inf)
        best = int(np.argmax(candidates))
        if candidates[best] > reached:
            middle_e, middle_ec = boxes.middles
            reached, at = float(candidates[best]), (float(middle_e[best]), float(middle_ec[best]))
        open_ = (upper > reached + tolerance) & _divisible(boxes)
        if seen > MAX_BOXES:
            open_[:] = False
        if not open_.all():
            settled = max(settled, float(upper[~open_].max()))
        boxes = _halved(encloser, boxes[open_], _across_e(boxes, bounds)[open_])
        if on_share and total > 0.0:
            on_share(1.0 - float(_extent(boxes).sum() / total))
    return Optimum(max(settled, reached), reached, at, seen)


def _extent(boxes: Boxes) -> FloatArray:
    """Area, but a point or a segment counts as well."""
    return (boxes.e.hi - boxes.e.lo + 1e-6) * (boxes.ec.hi - boxes.ec.lo + 1e-6)


def _divisible(boxes: Boxes) -> np.ndarray:
    """A box of a few doubles has no halves; its bound stands."""
    return (boxes.e.hi - boxes.e.lo > 1e-12) | (boxes.ec.hi - boxes.ec.lo > 1e-12)


def _middles_inside(encloser: Encloser, boxes: Boxes) -> np.ndarray:
    middle_e, middle_ec = boxes.middles
    return encloser.holds(Boxes(boxes.piece, Interval.point(middle_e), Interval.point(middle_ec)))


def _across_e(boxes: Boxes, bounds: Bounds) -> np.ndarray:
    """Cut the side along which u can change more, but none that is a 256th of the other."""
    wide_e, wide_ec = boxes.e.hi - boxes.e.lo, boxes.ec.hi - boxes.ec.lo
    more_along_e = bounds.slope_e.magnitude() * wide_e >= bounds.slope_ec.magnitude() * wide_ec
    return (more_along_e | (wide_e > 256.0 * wide_ec)) & (wide_e * 256.0 >= wide_ec)


def _halved(encloser: Encloser, boxes: Boxes, across_e: np.ndarray) -> Boxes:
    halves = boxes.halves(across_e)
    return halves[encloser.touches(halves)]

"""What is proved of the surface u(e, ec) itself: its range, its steepness, its sign."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pilotfish.fuzzy_proof.boxes import Boxes
from pilotfish.fuzzy_proof.branch import OnShare, Optimum, maximise
from pilotfish.fuzzy_proof.enclosure import Bounds, Encloser
from pilotfish.fuzzy_proof.interval import FloatArray

NOTHING = 1e-6  # of the universe of u: a speed that counts as none (pilotfish.fuzzy_report calls it silent, too)


@dataclass(frozen=True)
class Range:
    """min u and max u: each between what is reached and what is proved. ``low.bound`` <= u <= ``high.bound``."""

    low: Optimum  # bound <= min u <= reached
    high: Optimum


def prove_range(encloser: Encloser, tolerance: float, on_share: OnShare | None = None) -> Range:
    """u* over all inputs, to ``tolerance`` [units of U]."""

    def high(boxes: Boxes, bounds: Bounds) -> tuple[FloatArray, FloatArray]:
        return bounds.u.hi, bounds.middle.lo

    def low(boxes: Boxes, bounds: Bounds) -> tuple[FloatArray, FloatArray]:
        return -bounds.u.lo, -bounds.middle.hi

    least = maximise(encloser, low, tolerance, on_share=_part(on_share, 0, 2))  # of -u
    return Range(
        replace(least, bound=-least.bound, reached=-least.reached),
        maximise(encloser, high, tolerance, on_share=_part(on_share, 1, 2)),
    )


def prove_steepness(
    encloser: Encloser, vertices: Boxes, relative: float, *, along_e: bool, on_share: OnShare | None = None
) -> Optimum:
    """The Lipschitz constant of u in e or in ec, away from jumps: sup |du/de| or sup |du/dec| over all pieces.

    u is continuous and on each piece has continuous slopes up to its edge. Along a line in e the pieces are crossed
    one after the other, so |u(e1, ec) - u(e2, ec)| <= sup |du/de| |e1 - e2|, and no smaller constant will do.
    ``vertices``: points, the corners of the pieces, where the steepest slope mostly is. ``relative``: share by which
    the bound may exceed what is reached.
    """
    at_vertices = encloser.bounds(vertices)
    steep = _least_magnitude(at_vertices, along_e)
    best = int(np.argmax(steep))

    def objective(boxes: Boxes, bounds: Bounds) -> tuple[FloatArray, FloatArray]:
        slope = bounds.slope_e if along_e else bounds.slope_ec
        return slope.magnitude(), np.full(len(boxes), -np.inf)

    reached = float(steep[best])
    at = (float(vertices.e.lo[best]), float(vertices.ec.lo[best]))
    return maximise(encloser, objective, relative * reached, reached=reached, at=at, on_share=on_share)


def _least_magnitude(bounds: Bounds, along_e: bool) -> FloatArray:
    slope = bounds.slope_e if along_e else bounds.slope_ec
    return np.maximum(np.maximum(slope.lo, -slope.hi), 0.0)


def prove_steepest_rise(
    encloser: Encloser, vertices: Boxes, tolerance: float, on_share: OnShare | None = None
) -> Optimum:
    """sup du/de: u falls (or rests) along e everywhere exactly if this is <= 0."""
    at_vertices = encloser.bounds(vertices).slope_e.lo
    best = int(np.argmax(at_vertices))

    def objective(boxes: Boxes, bounds: Bounds) -> tuple[FloatArray, FloatArray]:
        return bounds.slope_e.hi, np.full(len(boxes), -np.inf)

    reached, at = float(at_vertices[best]), (float(vertices.e.lo[best]), float(vertices.ec.lo[best]))
    return maximise(encloser, objective, tolerance, reached=reached, at=at, on_share=on_share)


def prove_sign(
    encloser: Encloser, vertices: Boxes, tolerance: float, *, too_close: bool, on_share: OnShare | None = None
) -> Optimum:
    """The smallest x so that u <= NOTHING for all e >= x and all ec (``too_close``): sup of the e where u > NOTHING.

    Not ``too_close``: the smallest x so that u >= -NOTHING for all e <= -x. Branch and bound finds it at once, where
    bisection over x would begin anew for every x. -inf: u has that sign everywhere; inf: for no x.

    The supremum may be attained (at the foot of a vertical side), so the x that is proved is the next double above it.
    An input beyond the universe counts as its end: if u may have the wrong sign there, it has it for all e beyond.
    """

    def objective(boxes: Boxes, bounds: Bounds) -> tuple[FloatArray, FloatArray]:
        middle_e, _ = boxes.middles
        if too_close:
            upper = np.where(bounds.u.hi > NOTHING, boxes.e.hi, -np.inf)
            return upper, np.where(bounds.middle.lo > NOTHING, middle_e, -np.inf)
        upper = np.where(bounds.u.lo < -NOTHING, -boxes.e.lo, -np.inf)
        return upper, np.where(bounds.middle.hi < -NOTHING, -middle_e, -np.inf)

    u = encloser.bounds(vertices).middle
    wrong = (u.lo > NOTHING if too_close else u.hi < -NOTHING) & encloser.holds(vertices)
    farthest = np.where(wrong, vertices.e.lo if too_close else -vertices.e.lo, -np.inf)
    best = int(np.argmax(farthest))
    reached, at = float(farthest[best]), (float(vertices.e.lo[best]), float(vertices.ec.lo[best]))
    if not wrong[best]:
        at = (float("nan"), float("nan"))
    found = maximise(encloser, objective, tolerance, reached=reached, at=at, on_share=on_share)
    low, high = encloser.universe_e
    if found.bound >= (high if too_close else -low):
        return replace(found, bound=np.inf)
    return replace(found, bound=float(np.nextafter(found.bound, np.inf))) if np.isfinite(found.bound) else found


def _part(on_share: OnShare | None, index: int, count: int) -> OnShare | None:
    if on_share is None:
        return None
    return lambda share: on_share((index + share) / count)

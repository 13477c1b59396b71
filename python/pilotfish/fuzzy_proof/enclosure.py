"""Enclosures of the fuzzy law and of its slopes over boxes of inputs, outward rounded, on whole arrays of boxes.

On a piece (pieces.py) u = f(e, ec) = sum_k M_k(h_k) / sum_k A_k(h_k), heights h_k straight lines in e or in ec. With w
= dA/dh, m = dM/dh (layers.py)

    df/de = sum over the heights that come from e of  h_k' (m_k - f w_k) / area,      df/dec likewise,

and since f has continuous slopes on the box, the mean value theorem gives from its middle x0

    f(x) in f(x0) + df/de(box) (e - e0) + df/dec(box) (ec - ec0).

The slopes need f over the box and f needs the slopes: the first f is the quotient of moments, held inside the
universe of U, in which every centroid lies; each round meets the enclosure it had with the new one, and every one of
them is sound.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from pilotfish.fuzzy_proof.boxes import Boxes
from pilotfish.fuzzy_proof.interval import FloatArray, Interval, enclose, enclose_all
from pilotfish.fuzzy_proof.pieces import E, Surface
from pilotfish.fuzzy_proof.strips import Degree

_ROUNDS = 2
_CHUNK = 20_000  # boxes at once: some 100 MB


@dataclass(frozen=True)
class Bounds:
    """Of every box (N,): u anywhere in it, du/de and du/dec anywhere in it, and u at its middle."""

    u: Interval
    slope_e: Interval
    slope_ec: Interval
    middle: Interval


class Encloser:
    """The tables of a surface as arrays of doubles that enclose its rationals."""

    def __init__(self, surface: Surface) -> None:
        pieces, profiles = surface.pieces, surface.layers.profiles
        slots = max(len(piece.heights) for piece in pieces)
        depth = max(len(profile) for profile in profiles)
        self.count = len(pieces)
        self.universe_e = (surface.controller.error.min, surface.controller.error.max)
        self._universe = (surface.controller.output.min, surface.controller.output.max)

        nothing = Degree(0, Fraction(0), Fraction(0), None)
        table = [
            [*((h.axis, h.degree, h.profile) for h in piece.heights), *[(E, nothing, 0)] * (slots - len(piece.heights))]
            for piece in pieces
        ]
        flat = [slot for row in table for slot in row]
        shape = (len(pieces), slots)
        self._from_e = np.array([axis == E for axis, _, _ in flat]).reshape(shape)
        self._profile = np.array([profile for _, _, profile in flat]).reshape(shape)
        self._line = _Lines([degree for _, degree, _ in flat], shape)

        padded = [[*profile, *[profile[-1]] * (depth - len(profile))] for profile in profiles]
        tops = [[layer.top for layer in profile] for profile in padded]
        bottoms = [[None, *row[:-1]] for row in tops]
        # The first layer goes on below and the last one above: f is a function beyond the piece, too.
        self._bottom = np.array([[-np.inf if b is None else enclose(b)[0] for b in row] for row in bottoms])
        self._top = np.array([[*(enclose(t)[1] for t in row[:-1]), np.inf] for row in tops])
        self._width, self._moment, self._area, self._first = (
            [_column([[getattr(layer, name)[i] for layer in profile] for profile in padded]) for i in range(degree + 1)]
            for name, degree in (("width", 1), ("moment", 2), ("area", 2), ("first", 3))
        )

        sides = max(1, *(len(piece.sides) for piece in pieces))
        listed = [[*piece.sides, *[None] * (sides - len(piece.sides))] for piece in pieces]
        flat_sides = [side for row in listed for side in row]
        shape = (len(pieces), sides)
        self._is_side = np.array([side is not None for side in flat_sides]).reshape(shape)
        self._sign = np.array([side[2] if side else 1 for side in flat_sides]).reshape(shape)
        self._side_e = _Lines([side[0] if side else nothing for side in flat_sides], shape)
        self._side_ec = _Lines([side[1] if side else nothing for side in flat_sides], shape)

        box = [[(min(v[i] for v in p.vertices), max(v[i] for v in p.vertices)) for i in (0, 1)] for p in pieces]
        ends = [Interval(*(_outward([b[i] for b in box]))) for i in (0, 1)]
        self.boxes = Boxes(np.arange(len(pieces)), ends[0], ends[1])
        self._inner = [Interval(*_inward([b[i] for b in box])) for i in (0, 1)]

    def touches(self, boxes: Boxes) -> NDArray[np.bool_]:
        """False where a box certainly has no point of its piece."""
        gap = self._gaps(boxes)
        return ~np.any(self._is_side[boxes.piece] & (gap.hi < 0.0), axis=1)

    def holds(self, boxes: Boxes) -> NDArray[np.bool_]:
        """True where a box certainly lies in its piece."""
        gap = self._gaps(boxes)
        between = np.all(~self._is_side[boxes.piece] | (gap.lo >= 0.0), axis=1)
        for x, ends in zip((boxes.e, boxes.ec), self._inner, strict=True):
            between &= (x.lo >= ends.lo[boxes.piece]) & (x.hi <= ends.hi[boxes.piece])
        return between

    def _gaps(self, boxes: Boxes) -> Interval:
        gap = self._side_e.at(boxes.piece, _as_column(boxes.e)) - self._side_ec.at(boxes.piece, _as_column(boxes.ec))
        positive = self._sign[boxes.piece] > 0
        return Interval(np.where(positive, gap.lo, -gap.hi), np.where(positive, gap.hi, -gap.lo))

    def bounds(self, boxes: Boxes) -> Bounds:
        """Of the parts of the boxes that lie in their pieces."""
        parts = [self._bounds(boxes[i : i + _CHUNK]) for i in range(0, max(len(boxes), 1), _CHUNK)]
        if len(parts) == 1:
            return parts[0]

        def joined(name: str) -> Interval:
            each = [getattr(part, name) for part in parts]
            return Interval(np.concatenate([i.lo for i in each]), np.concatenate([i.hi for i in each]))

        return Bounds(joined("u"), joined("slope_e"), joined("slope_ec"), joined("middle"))

    def at(self, piece: NDArray[np.int64], e: FloatArray, ec: FloatArray) -> Bounds:
        """Of single points, as formulas of their pieces."""
        return self.bounds(Boxes(piece, Interval.point(e), Interval.point(ec)))

    def _bounds(self, boxes: Boxes) -> Bounds:
        piece = boxes.piece
        middle_e, middle_ec = boxes.middles
        from_e, profile = self._from_e[piece], self._profile[piece]

        def heights(e: Interval, ec: Interval) -> Interval:
            x = Interval(
                np.where(from_e, e.lo[:, None], ec.lo[:, None]), np.where(from_e, e.hi[:, None], ec.hi[:, None])
            )
            return self._line.at(piece, x)

        at_middle = heights(Interval.point(middle_e), Interval.point(middle_ec))
        middle = _quotient(
            self._hull(self._first, profile, at_middle).total(),
            self._hull(self._area, profile, at_middle).total(),
            self._universe,
        )
        over_box = heights(boxes.e, boxes.ec)
        width, moment = self._hull(self._width, profile, over_box), self._hull(self._moment, profile, over_box)
        area = self._area_over(profile, over_box)
        slope = self._line.slope(piece)
        zero = Interval.point(np.zeros_like(slope.lo))
        slopes_e = Interval(np.where(from_e, slope.lo, zero.lo), np.where(from_e, slope.hi, zero.hi))
        slopes_ec = Interval(np.where(from_e, zero.lo, slope.lo), np.where(from_e, zero.hi, slope.hi))
        to_e = boxes.e - Interval.point(middle_e)
        to_ec = boxes.ec - Interval.point(middle_ec)

        u = _quotient(self._hull(self._first, profile, over_box).total(), area, self._universe)
        for _ in range(_ROUNDS):
            share = moment - Interval(u.lo[:, None], u.hi[:, None]) * width
            slope_e = _guarded((slopes_e * share).total(), area)
            slope_ec = _guarded((slopes_ec * share).total(), area)
            u = u.meet(middle + slope_e * to_e + slope_ec * to_ec)
        return Bounds(u, slope_e, slope_ec, middle)

    def _area_over(self, profile: NDArray[np.int64], heights: Interval) -> Interval:
        """A_k rises with its height, so its ends are enough."""
        low = self._hull(self._area, profile, Interval.point(heights.lo)).total()
        high = self._hull(self._area, profile, Interval.point(heights.hi)).total()
        return Interval(low.lo, high.hi)

    def _hull(self, coefficients: list[Interval], profile: NDArray[np.int64], heights: Interval) -> Interval:
        """A profile's polynomials over heights, by Horner's rule: the hull over all layers that they reach."""
        low, high = np.full(heights.lo.shape, np.inf), np.full(heights.lo.shape, -np.inf)
        for layer in range(self._top.shape[1]):
            h = Interval(
                np.maximum(heights.lo, self._bottom[profile, layer]), np.minimum(heights.hi, self._top[profile, layer])
            )
            reached = h.lo <= h.hi
            h = Interval(np.where(reached, h.lo, 0.0), np.where(reached, h.hi, 0.0))
            at = [Interval(c.lo[profile, layer], c.hi[profile, layer]) for c in coefficients]
            value = at[-1]
            for coefficient in reversed(at[:-1]):
                value = value * h + coefficient
            low = np.where(reached, np.minimum(low, value.lo), low)
            high = np.where(reached, np.maximum(high, value.hi), high)
        return Interval(low, high)


class _Lines:
    """Degrees as arrays: offset + (x - foot) / width. A constant has an infinite width, and slope 0."""

    def __init__(self, degrees: list[Degree], shape: tuple[int, int]) -> None:
        def shaped(numbers: list[Fraction]) -> Interval:
            every = enclose_all(numbers)
            return Interval(every.lo.reshape(shape), every.hi.reshape(shape))

        self._foot = shaped([degree.foot for degree in degrees])
        self._offset = shaped([degree.offset for degree in degrees])
        self._slope = shaped([degree.slope for degree in degrees])

    def at(self, rows: NDArray[np.int64], x: Interval) -> Interval:
        return self._offset[rows] + (x - self._foot[rows]) * self._slope[rows]

    def slope(self, rows: NDArray[np.int64]) -> Interval:
        return self._slope[rows]


def _quotient(first: Interval, area: Interval, universe: tuple[float, float]) -> Interval:
    """The centroid, which lies in the universe; all of it where the area may be zero."""
    value = _guarded(first, area)
    return Interval(np.clip(value.lo, *universe), np.clip(value.hi, *universe))


_BEYOND = 1e100  # stands for "unbounded", so that no product becomes NaN


def _guarded(numerator: Interval, area: Interval) -> Interval:
    positive = area.lo > 0.0
    safe = Interval(np.where(positive, area.lo, 1.0), np.where(positive, area.hi, 1.0))
    value = numerator / safe
    return Interval(np.where(positive, value.lo, -_BEYOND), np.where(positive, value.hi, _BEYOND))


def _as_column(x: Interval) -> Interval:
    return Interval(x.lo[:, None], x.hi[:, None])


def _column(table: list[list[Fraction]]) -> Interval:
    every = enclose_all([number for row in table for number in row])
    shape = (len(table), len(table[0]))
    return Interval(every.lo.reshape(shape), every.hi.reshape(shape))


def _outward(pairs: list[tuple[Fraction, Fraction]]) -> tuple[FloatArray, FloatArray]:
    return np.array([enclose(low)[0] for low, _ in pairs]), np.array([enclose(high)[1] for _, high in pairs])


def _inward(pairs: list[tuple[Fraction, Fraction]]) -> tuple[FloatArray, FloatArray]:
    return np.array([enclose(low)[1] for low, _ in pairs]), np.array([enclose(high)[0] for _, high in pairs])

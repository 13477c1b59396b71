"""The centroid layer by layer, as exact polynomials of the heights at which the terms of U are clipped.

By Cavalieri, with cut_k(y) the level cut of term k inside the universe and h_k its height, the union of the clipped
terms has at the level y the cuts of all terms with h_k >= y. Sort the terms by height, the highest first. A point
that lies in the cuts of several terms is counted once if each term counts what the terms before it (its set S of
higher ones) have not:

    area  = sum_k A_k(h_k),   A_k(h) = int_0^h |cut_k(y) minus the cuts of S| dy
    first = sum_k M_k(h_k),   M_k(h) = int_0^h (int of u over the same) dy

    centroid c = first / area,   dc/dh_k = (m_k(h_k) - c w_k(h_k)) / area   with w = dA/dh, m = dM/dh.

The ends of cuts are straight lines in y, held at the ends of the universe. Between the levels where two of these
lines cross, w is a straight line in y and m a parabola; so A has degree 2 and M degree 3. No order of the terms on
the axis is needed, and no breakpoint depends on a height: everything is known before the first box. This derives the
centroid anew and shares nothing with src/fuzzy/layers.cpp, which sums over pairs of neighbours.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from pilotfish import fuzzy
from pilotfish.fuzzy_proof.strips import corners_of

Line = tuple[Fraction, Fraction]  # p + q y
Polynomial = tuple[Fraction, ...]  # ascending powers of h


@dataclass(frozen=True)
class Layer:
    """One piece of a profile: the polynomials for heights up to ``top``."""

    top: Fraction
    width: Polynomial  # w, degree 1
    moment: Polynomial  # m, degree 2
    area: Polynomial  # A, degree 2
    first: Polynomial  # M, degree 3


class Layers:
    """The profiles of a variable U, made when they are first asked for. ConfigError for a Gaussian."""

    def __init__(self, output: fuzzy.LinguisticVariable) -> None:
        low, high = Fraction(output.min), Fraction(output.max)
        self._ends = (low, high)
        self._lines = [_sides(corners, low, high) for corners in corners_of(output)]
        self._known: dict[tuple[int, frozenset[int]], int] = {}
        self._sums: dict[tuple[int, ...], int] = {}
        self.profiles: list[list[Layer]] = [[Layer(Fraction(1), *(((Fraction(0),) * n) for n in (2, 3, 3, 4)))]]

    def profile(self, term: int, higher: frozenset[int]) -> int:
        """Index into ``profiles`` of what ``term`` adds to the terms of ``higher``. Profile 0 is nothing."""
        key = (term, frozenset(other for other in higher if self._overlap(term, other)))
        if key not in self._known:
            self._known[key] = len(self.profiles)
            self.profiles.append(self._make(*key))
        return self._known[key]

    def together(self, profiles: list[int]) -> int:
        """Index of the sum of profiles: of terms that are clipped at the same height."""
        key = tuple(sorted(profiles))
        if len(key) == 1:
            return key[0]
        if key not in self._sums:
            self._sums[key] = len(self.profiles)
            self.profiles.append(_sum_of([self.profiles[i] for i in key]))
        return self._sums[key]

    def _overlap(self, one: int, other: int) -> bool:
        """Cuts shrink with the level, so what they share at any level they share at level 0."""
        return self._lines[one][0][0] < self._lines[other][1][0] and self._lines[other][0][0] < self._lines[one][1][0]

    def _make(self, term: int, higher: frozenset[int]) -> list[Layer]:
        low, high = self._ends
        terms = [term, *sorted(higher)]
        lines = {line for k in terms for line in self._lines[k]} | {(low, Fraction(0)), (high, Fraction(0))}
        levels = sorted({Fraction(0), Fraction(1), *_meetings(lines)})
        layers: list[Layer] = []
        area_below = first_below = Fraction(0)
        for bottom, top in zip(levels[:-1], levels[1:], strict=True):
            parts = self._parts(term, sorted(higher), (bottom + top) / 2)
            width = _sum([(right[0] - left[0], right[1] - left[1]) for left, right in parts], 2)
            moment = _sum([_half_difference_of_squares(left, right) for left, right in parts], 3)
            area, first = _integral(width, bottom, area_below), _integral(moment, bottom, first_below)
            area_below, first_below = value(area, top), value(first, top)
            if layers and layers[-1].width == width and layers[-1].moment == moment:
                layers[-1] = Layer(top, width, moment, area, first)
            else:
                layers.append(Layer(top, width, moment, area, first))
        return layers

    def _parts(self, term: int, higher: list[int], level: Fraction) -> list[tuple[Line, Line]]:
        """cut_term minus the cuts of ``higher`` at a level: intervals between lines, which do not cross near there."""
        parts = [self._held(term, level)]
        for other in higher:
            left, right = self._held(other, level)
            remaining = []
            for begin, end in parts:
                remaining += [(begin, _least(end, left, level)), (_greatest(begin, right, level), end)]
            parts = [(begin, end) for begin, end in remaining if value(begin, level) < value(end, level)]
        return [(begin, end) for begin, end in parts if value(begin, level) < value(end, level)]

    def _held(self, term: int, level: Fraction) -> tuple[Line, Line]:
        """The ends of the cut inside the universe."""
        low, high = ((end, Fraction(0)) for end in self._ends)
        left, right = self._lines[term]
        return _greatest(left, low, level), _least(right, high, level)


def _sum_of(profiles: list[list[Layer]]) -> list[Layer]:
    layers: list[Layer] = []
    for top in sorted({layer.top for profile in profiles for layer in profile}):
        reached = [next(layer for layer in profile if top <= layer.top) for profile in profiles]
        sums = (
            _sum([getattr(layer, name) for layer in reached], length)
            for name, length in (("width", 2), ("moment", 3), ("area", 3), ("first", 4))
        )
        layers.append(Layer(top, *sums))
    return layers


def value(polynomial: Polynomial, at: Fraction) -> Fraction:
    """Horner's rule."""
    total = Fraction(0)
    for coefficient in reversed(polynomial):
        total = total * at + coefficient
    return total


def _sides(corners: tuple[float, float, float, float], low: Fraction, high: Fraction) -> tuple[Line, Line]:
    a, b, c, d = corners
    left = (low, Fraction(0)) if math.isinf(a) else (Fraction(a), Fraction(b) - Fraction(a))
    right = (high, Fraction(0)) if math.isinf(d) else (Fraction(d), Fraction(c) - Fraction(d))
    return left, right


def _meetings(lines: set[Line]) -> set[Fraction]:
    listed = sorted(lines)
    levels = ((q[0] - p[0]) / (p[1] - q[1]) for i, p in enumerate(listed) for q in listed[i + 1 :] if p[1] != q[1])
    return {level for level in levels if 0 < level < 1}


def _least(one: Line, other: Line, level: Fraction) -> Line:
    return one if value(one, level) <= value(other, level) else other


def _greatest(one: Line, other: Line, level: Fraction) -> Line:
    return one if value(one, level) >= value(other, level) else other


def _half_difference_of_squares(left: Line, right: Line) -> Polynomial:
    """int_left^right u du = (right^2 - left^2) / 2."""
    (p, q), (s, t) = left, right
    return ((s * s - p * p) / 2, s * t - p * q, (t * t - q * q) / 2)


def _sum(polynomials: list[Polynomial], length: int) -> Polynomial:
    return tuple(sum((p[i] for p in polynomials), Fraction(0)) for i in range(length))


def _integral(polynomial: Polynomial, begin: Fraction, start: Fraction) -> Polynomial:
    """The antiderivative that is ``start`` at ``begin``."""
    raised = (Fraction(0), *(c / (i + 1) for i, c in enumerate(polynomial)))
    return (start - value(raised, begin), *raised[1:])

"""The universe of an input, cut where the degrees of its sets change their formula or their order. Exact, in rationals.

A set of trapezoids and triangles has straight sides. Its corners, and the points where two sides cross, cut the
universe into strips. On each strip every degree is one straight line

    mu(x) = offset + (x - foot) / width

(a rising side: foot a, width b - a; a falling one: foot d, width c - d; the core: offset 1, width infinite), and the
order of the degrees is the same all over it. Where a set has a vertical side its degree belongs to the set there and
is gone beyond: such a point is a strip of its own, of width zero. The doubles of a file are rationals, so nothing here
is rounded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from pilotfish import fuzzy
from pilotfish.errors import ConfigError


@dataclass(frozen=True)
class Degree:
    """The degree of one term on a strip: ``offset + (x - foot) / width``; ``width`` None: constant."""

    term: int
    offset: Fraction
    foot: Fraction
    width: Fraction | None

    def at(self, x: Fraction) -> Fraction:
        """The degree at x."""
        return self.offset if self.width is None else self.offset + (x - self.foot) / self.width

    @property
    def slope(self) -> Fraction:
        """d mu / dx."""
        return Fraction(0) if self.width is None else 1 / self.width


@dataclass(frozen=True)
class Strip:
    """A closed part [begin, end] of a universe and the terms that are not zero inside."""

    begin: Fraction
    end: Fraction
    degrees: tuple[Degree, ...]

    @property
    def is_point(self) -> bool:
        """A vertical side stands here."""
        return self.begin == self.end


Corners = tuple[float, float, float, float]


def corners_of(variable: fuzzy.LinguisticVariable) -> list[Corners]:
    """(a, b, c, d) of every term. ConfigError for a Gaussian."""
    found = []
    for term in variable.terms:
        shape = term.set
        if isinstance(shape, fuzzy.Gaussian):
            raise ConfigError(
                f"{variable.name}.terms.{term.label}: a Gaussian cannot be proved about: its sides are no rational "
                "functions, and no standard bounds the rounding of exp; write a triangle or trapezoid of its width"
            )
        if isinstance(shape, fuzzy.Triangle):
            found.append((shape.a, shape.b, shape.b, shape.c))
        else:
            found.append((shape.a, shape.b, shape.c, shape.d))
    return found


def strips_of(variable: fuzzy.LinguisticVariable) -> list[Strip]:
    """From the left end of the universe to the right; together they cover it. ConfigError for a Gaussian."""
    corners = corners_of(variable)
    low, high = Fraction(variable.min), Fraction(variable.max)
    inside = {Fraction(x) for set_ in corners for x in set_ if math.isfinite(x)}
    cuts = sorted({low, high, *(x for x in inside if low < x < high)})
    strips: list[Strip] = []
    for begin, end in zip(cuts[:-1], cuts[1:], strict=True):
        degrees = _degrees_between(corners, begin, end)
        edges = [begin, *_crossings(degrees, begin, end), end]
        strips += [Strip(left, right, degrees) for left, right in zip(edges[:-1], edges[1:], strict=True)]
    strips += [_point(corners, x) for x in sorted(_vertical_sides(corners)) if low <= x <= high]
    return sorted(strips, key=lambda strip: (strip.begin, strip.end))


def _degrees_between(corners: list[Corners], begin: Fraction, end: Fraction) -> tuple[Degree, ...]:
    found = []
    for term, (a, b, c, d) in enumerate(corners):
        if b <= begin and end <= c:
            found.append(Degree(term, Fraction(1), Fraction(0), None))
        elif a <= begin and end <= b:
            found.append(Degree(term, Fraction(0), Fraction(a), Fraction(b) - Fraction(a)))
        elif c <= begin and end <= d:
            found.append(Degree(term, Fraction(0), Fraction(d), Fraction(c) - Fraction(d)))
    return tuple(found)


def _crossings(degrees: tuple[Degree, ...], begin: Fraction, end: Fraction) -> list[Fraction]:
    found = set()
    for i, one in enumerate(degrees):
        for other in degrees[i + 1 :]:
            if one.slope == other.slope:
                continue
            x = begin + (other.at(begin) - one.at(begin)) / (one.slope - other.slope)
            if begin < x < end:
                found.add(x)
    return sorted(found)


def _vertical_sides(corners: list[Corners]) -> set[Fraction]:
    left = {Fraction(a) for a, b, _, _ in corners if a == b and math.isfinite(a)}
    return left | {Fraction(d) for _, _, c, d in corners if c == d and math.isfinite(d)}


def _point(corners: list[Corners], x: Fraction) -> Strip:
    """The degrees at x itself: a side belongs to its set."""
    found = []
    for term, (a, b, c, d) in enumerate(corners):
        if x < a or x > d:
            continue
        if x < b:
            degree = (x - Fraction(a)) / (Fraction(b) - Fraction(a))
        elif x > c:
            degree = (Fraction(d) - x) / (Fraction(d) - Fraction(c))
        else:
            degree = Fraction(1)
        if degree > 0:
            found.append(Degree(term, degree, Fraction(0), None))
    return Strip(x, x, tuple(found))

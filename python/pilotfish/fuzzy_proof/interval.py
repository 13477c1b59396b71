"""Interval arithmetic with outward rounding, on whole NumPy arrays.

Why one ``nextafter`` outward is sound: IEEE 754 rounds +, -, *, / to the nearest double, and NumPy uses these
operations as the processor has them. So the exact result lies at most half a unit in the last place from the rounded
one, and the next double below (above) bounds it from below (above). Where the result overflows, the bound is
infinite, which is sound too; where it underflows, the next double is the smallest subnormal away, which is more than
the error. Nothing here uses exp, log or a root, whose rounding no standard bounds.

Negation, minimum, maximum and comparison are exact and are not widened.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def down(x: FloatArray) -> FloatArray:
    """The next double below, of each."""
    return np.nextafter(x, -np.inf)


def up(x: FloatArray) -> FloatArray:
    """The next double above, of each."""
    return np.nextafter(x, np.inf)


@dataclass(frozen=True)
class Interval:
    """The sets [lo, hi] of real numbers, one for each element. Every operation encloses all results of its operands."""

    lo: FloatArray
    hi: FloatArray

    @classmethod
    def point(cls, x: FloatArray | float) -> Interval:
        """Of doubles, which are exact."""
        x = np.asarray(x, dtype=float)
        return cls(x, x)

    def __add__(self, other: Interval) -> Interval:
        return Interval(down(self.lo + other.lo), up(self.hi + other.hi))

    def __sub__(self, other: Interval) -> Interval:
        return Interval(down(self.lo - other.hi), up(self.hi - other.lo))

    def __neg__(self) -> Interval:
        return Interval(-self.hi, -self.lo)

    def __mul__(self, other: Interval) -> Interval:
        products = (self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi)
        return Interval(
            down(np.minimum(np.minimum(products[0], products[1]), np.minimum(products[2], products[3]))),
            up(np.maximum(np.maximum(products[0], products[1]), np.maximum(products[2], products[3]))),
        )

    def __truediv__(self, other: Interval) -> Interval:
        """Only by intervals that do not contain zero; the caller sees to it."""
        quotients = (self.lo / other.lo, self.lo / other.hi, self.hi / other.lo, self.hi / other.hi)
        return Interval(
            down(np.minimum(np.minimum(quotients[0], quotients[1]), np.minimum(quotients[2], quotients[3]))),
            up(np.maximum(np.maximum(quotients[0], quotients[1]), np.maximum(quotients[2], quotients[3]))),
        )

    def __getitem__(self, which: object) -> Interval:
        return Interval(self.lo[which], self.hi[which])  # type: ignore[index]

    def meet(self, other: Interval) -> Interval:
        """What both enclose: the intersection, of two enclosures of the same value."""
        return Interval(np.maximum(self.lo, other.lo), np.minimum(self.hi, other.hi))

    def absolute(self) -> Interval:
        """|x| over each."""
        least = np.where((self.lo <= 0.0) & (self.hi >= 0.0), 0.0, np.minimum(np.abs(self.lo), np.abs(self.hi)))
        return Interval(least, self.magnitude())

    def magnitude(self) -> FloatArray:
        """The greatest absolute value in each."""
        return np.maximum(np.abs(self.lo), np.abs(self.hi))

    def total(self) -> Interval:
        """The sum along the last axis, term by term, so that every addition is rounded outward."""
        sum_ = self[..., 0]
        for k in range(1, self.lo.shape[-1]):
            sum_ = sum_ + self[..., k]
        return sum_


def enclose(number: Fraction) -> tuple[float, float]:
    """The two doubles nearest to a rational number, below and above; twice the same if it is a double.

    ``float`` of a Fraction is rounded correctly (Python's own big-integer division), so one step outward encloses it.
    """
    nearest = float(number)
    if Fraction(nearest) == number:
        return nearest, nearest
    return float(down(np.float64(nearest))), float(up(np.float64(nearest)))


def enclose_all(numbers: list[Fraction]) -> Interval:
    """The same for a list."""
    pairs = np.array([enclose(number) for number in numbers], dtype=float).reshape(-1, 2)
    return Interval(pairs[:, 0], pairs[:, 1])

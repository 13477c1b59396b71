"""Interval arithmetic against exact rationals: every operation encloses, and none is much wider than it must be."""

import operator
from fractions import Fraction

import numpy as np
import pytest

from pilotfish.fuzzy_proof.interval import Interval, enclose

OPERATIONS = {"add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv}
N = 400


def operands(seed, *, positive=False):
    """Intervals of all sizes: points, narrow ones, ones around zero."""
    random = np.random.default_rng(seed)
    middle = random.normal(size=N) * 10.0 ** random.integers(-6, 6, N)
    radius = np.abs(middle) * random.choice([0.0, 1e-15, 1e-3, 2.0], N)
    if positive:
        return Interval(np.abs(middle), np.abs(middle) + radius)
    return Interval(middle - radius, middle + radius)


def misses(one, other, operation, result):
    """How many of the exact results of the ends of the operands lie outside."""
    count = 0
    for i in range(N):
        for x in (one.lo[i], one.hi[i]):
            for y in (other.lo[i], other.hi[i]):
                exact = operation(Fraction(float(x)), Fraction(float(y)))
                count += not Fraction(float(result.lo[i])) <= exact <= Fraction(float(result.hi[i]))
    return count


@pytest.mark.parametrize("name", OPERATIONS)
def test_an_operation_encloses_the_exact_results_of_the_ends(name):
    # + - * / are monotone in either operand between the ends (the divisor has one sign), so the ends are the extremes.
    one, other = operands(1), operands(2, positive=name == "div")
    assert misses(one, other, OPERATIONS[name], OPERATIONS[name](one, other)) == 0


@pytest.mark.parametrize("name", OPERATIONS)
def test_an_operation_that_is_not_rounded_outward_would_be_found(name):
    one, other = operands(1), operands(2, positive=name == "div")
    right = OPERATIONS[name](one, other)
    # One double inward again: the rounded result itself, which is wrong about every other time.
    nearest = Interval(np.nextafter(right.lo, np.inf), np.nextafter(right.hi, -np.inf))
    assert misses(one, other, OPERATIONS[name], nearest) > N / 4


def test_an_operation_on_points_is_two_steps_wide():
    one, other = Interval.point(operands(3).lo), Interval.point(operands(4).lo)
    product = one * other
    np.testing.assert_array_equal(np.nextafter(np.nextafter(product.lo, np.inf), np.inf), product.hi)


def test_the_doubles_around_a_rational_enclose_it_and_are_neighbours_but_one():
    for number in (Fraction(1, 3), Fraction(-7, 10), Fraction(1, 10**320)):
        low, high = enclose(number)
        assert Fraction(low) < number < Fraction(high)
        assert np.nextafter(np.nextafter(low, np.inf), np.inf) == high
    assert enclose(Fraction(0.1)) == (0.1, 0.1)  # a double is itself


def test_the_absolute_value_of_an_interval_around_zero_begins_at_zero():
    x = Interval(np.array([-2.0, 1.0, -3.0]), np.array([1.0, 2.0, -1.0])).absolute()
    assert x.lo.tolist() == [0.0, 1.0, 1.0]
    assert x.hi.tolist() == [2.0, 2.0, 3.0]

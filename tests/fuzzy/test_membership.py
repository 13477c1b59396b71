"""Membership functions: one property tester for all shapes, then each shape's own formula."""

import math

import fuzzy_reference
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import fuzzy

INF = math.inf
SHAPES = {
    "triangle": (fuzzy.Triangle(-0.5, 0.1, 0.4), {"triangle": [-0.5, 0.1, 0.4]}, 0.1),
    "triangle with a vertical left side": (fuzzy.Triangle(0.1, 0.1, 0.4), {"triangle": [0.1, 0.1, 0.4]}, 0.1),
    "triangle with a vertical right side": (
        fuzzy.Triangle(-0.5, 0.4, 0.4),
        {"triangle": [-0.5, 0.4, 0.4]},
        0.4,
    ),
    "trapezoid": (fuzzy.Trapezoid(-0.8, -0.2, 0.3, 0.5), {"trapezoid": [-0.8, -0.2, 0.3, 0.5]}, 0.0),
    "rectangle": (fuzzy.Trapezoid(-0.2, -0.2, 0.3, 0.3), {"trapezoid": [-0.2, -0.2, 0.3, 0.3]}, 0.0),
    "open left shoulder": (fuzzy.Trapezoid(-INF, -INF, 0, 1), {"trapezoid": [-INF, -INF, 0, 1]}, -7.0),
    "open right shoulder": (fuzzy.Trapezoid(0, 1, INF, INF), {"trapezoid": [0, 1, INF, INF]}, 7.0),
    "gaussian": (fuzzy.Gaussian(0.2, 0.3), {"gaussian": {"mean": 0.2, "sigma": 0.3}}, 0.2),
}
every_shape = pytest.mark.parametrize(("shape", "spec", "peak"), SHAPES.values(), ids=SHAPES.keys())
points = np.linspace(-3, 3, 6001)


@every_shape
def test_degrees_are_in_the_unit_interval_and_one_at_the_peak(shape, spec, peak):
    degrees = fuzzy.membership(shape, points)
    assert degrees.shape == points.shape
    assert np.all((degrees >= 0) & (degrees <= 1))
    assert fuzzy.membership(shape, peak) == 1.0


@every_shape
def test_degrees_agree_with_the_formula(shape, spec, peak):
    inside = points[(points > fuzzy.support(shape)[0]) & (points < fuzzy.support(shape)[1])]
    np.testing.assert_allclose(fuzzy.membership(shape, inside), fuzzy_reference.degree(spec, inside), atol=1e-15)


@every_shape
def test_degrees_are_zero_outside_the_support_and_only_there(shape, spec, peak):
    left, right = fuzzy.support(shape)
    degrees = fuzzy.membership(shape, points)
    assert np.all(degrees[(points < left) | (points > right)] == 0)
    assert np.all(degrees[(points > left) & (points < right)] > 0)


@every_shape
def test_sets_are_convex_they_rise_to_the_peak_and_fall_behind_it(shape, spec, peak):
    degrees = fuzzy.membership(shape, points)
    assert np.all(np.diff(degrees[points <= peak]) >= 0)
    assert np.all(np.diff(degrees[points >= peak]) <= 0)


@every_shape
@pytest.mark.parametrize("level", [0.01, 0.3, 0.99, 1.0])
def test_a_level_cut_is_where_the_degree_is_at_least_the_level(shape, spec, peak, level):
    left, right = fuzzy.level_cut(shape, level)
    degrees = fuzzy.membership(shape, points)
    well_inside, well_outside = (
        (points > left + 1e-9) & (points < right - 1e-9),
        (points < left - 1e-9) | (points > right + 1e-9),
    )
    assert np.all(degrees[well_inside] >= level - 1e-12)
    assert np.all(degrees[well_outside] < level)


@every_shape
def test_nan_gives_nan(shape, spec, peak):
    assert math.isnan(fuzzy.membership(shape, math.nan))


def test_an_open_shoulder_contains_infinity():
    assert fuzzy.membership(fuzzy.Trapezoid(-INF, -INF, 0, 1), -INF) == 1.0
    assert fuzzy.membership(fuzzy.Trapezoid(-INF, -INF, 0, 1), INF) == 0.0


def test_a_number_gives_a_number_and_an_array_its_own_shape():
    triangle = fuzzy.Triangle(0, 1, 2)
    assert isinstance(fuzzy.membership(triangle, 0.25), float)
    assert fuzzy.membership(triangle, np.zeros((2, 3, 4))).shape == (2, 3, 4)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fuzzy.Triangle(1, 0, 2), "a <= b <= c is violated: 1, 0, 2"),
        (lambda: fuzzy.Triangle(0, 2, 1), "a <= b <= c is violated: 0, 2, 1"),
        (lambda: fuzzy.Triangle(1, 1, 1), "a < c is violated: 1, 1, 1"),
        (lambda: fuzzy.Triangle(math.nan, 0, 1), "a <= b <= c is violated: nan, 0, 1"),
        (lambda: fuzzy.Triangle(-INF, 0, 1), "a and c are finite is violated: -inf, 0, 1"),
        (lambda: fuzzy.Trapezoid(0, 1, 0.5, 2), "a <= b <= c <= d is violated: 0, 1, 0.5, 2"),
        (lambda: fuzzy.Trapezoid(0, 0, 0, 0), "a < d is violated: 0, 0, 0, 0"),
        (lambda: fuzzy.Trapezoid(0, 1, 2, math.nan), "a <= b <= c <= d is violated: 0, 1, 2, nan"),
        (lambda: fuzzy.Trapezoid(-INF, 0, 1, 2), "a == b == -inf for an open left shoulder is violated"),
        (lambda: fuzzy.Trapezoid(0, 1, 2, INF), "c == d == +inf for an open right shoulder is violated"),
        (lambda: fuzzy.Trapezoid(-INF, -INF, -INF, 0), "b < +inf and c > -inf is violated"),
        (lambda: fuzzy.Gaussian(0, 0), "0 < sigma < inf is violated: 0"),
        (lambda: fuzzy.Gaussian(0, -1), "0 < sigma < inf is violated: -1"),
        (lambda: fuzzy.Gaussian(0, math.nan), "0 < sigma < inf is violated: nan"),
        (lambda: fuzzy.Gaussian(math.nan, 1), "mean is finite is violated: nan"),
    ],
)
def test_an_ill_formed_set_is_refused_in_the_words_of_its_formula(make, words):
    with pytest.raises(ValueError, match=words.replace("+", r"\+")):
        make()


@settings(derandomize=True, deadline=None)
@given(
    corners=st.lists(st.floats(-2, 2), min_size=4, max_size=4).map(sorted).filter(lambda c: c[3] - c[0] > 1e-3),
    x=st.floats(-2, 2),
)
def test_a_mirrored_trapezoid_has_the_mirrored_degree(corners, x):
    a, b, c, d = corners
    degree = fuzzy.membership(fuzzy.Trapezoid(a, b, c, d), x)
    assert degree == fuzzy.membership(fuzzy.Trapezoid(-d, -c, -b, -a), -x)

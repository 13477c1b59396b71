"""Equation (6) as it is written: inputs A' and B' of a width, and the limit in which they have none."""

import math

import fuzzy_reference
import numpy as np
import pytest
from fuzzy_builders import make_controller, make_set
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import fuzzy

pytestmark = pytest.mark.builds

TRIANGLE, GAUSSIAN = fuzzy.WidthShape.triangle, fuzzy.WidthShape.gaussian
shapes = st.sampled_from([TRIANGLE, GAUSSIAN])
corner = st.floats(-1.4, 1.4).map(lambda x: round(x, 2))
specs = st.one_of(
    st.lists(corner, min_size=3, max_size=3).map(sorted).filter(lambda c: c[0] < c[2]).map(lambda c: {"triangle": c}),
    st.lists(corner, min_size=4, max_size=4).map(sorted).filter(lambda c: c[0] < c[3]).map(lambda c: {"trapezoid": c}),
    st.lists(corner, min_size=2, max_size=2)
    .map(sorted)
    .filter(lambda c: c[0] < c[1])
    .map(lambda c: {"trapezoid": [-math.inf, -math.inf, *c]}),
    st.builds(lambda m, s: {"gaussian": {"mean": m, "sigma": s}}, corner, st.floats(0.05, 0.8)),
)
values = st.floats(-1.0, 1.0)
widths = st.floats(1e-3, 1.5)


def spread(t, x, width, shape):
    """mu_A'(t) by its formula."""
    if shape == TRIANGLE:
        return np.maximum(0.0, 1.0 - np.abs(t - x) / width)
    return np.exp(-0.5 * ((t - x) / width) ** 2)


def variable_with(spec):
    return fuzzy.LinguisticVariable("E", [fuzzy.Term("A", make_set(spec))])


def best_match(spec, x, width, shape):
    """sup min(A', A) over [-1, 1] by search: both sets are convex, so what they share rises to one peak and falls. A
    grid with the corners, finer where A' is, finds the peak's neighbourhood, ternary search the peak."""

    def match(t):
        return np.minimum(spread(t, x, width, shape), fuzzy_reference.degree(spec, t))

    near = x + width * np.linspace(-1, 1, 101)
    corners = np.sort([x - width, x, x + width, *fuzzy_reference.knees(spec, 1.0)])
    between = (corners[1:] + corners[:-1]) / 2  # however little the two sets overlap
    grid = np.unique(np.clip([*np.linspace(-1, 1, 2001), *near, *corners, *between], -1, 1))
    top = grid[np.argmax(match(grid))]
    best = float(match(top))
    for left, right in ((grid[grid < top - 1e-9][-1:], [top]), ([top], grid[grid > top + 1e-9][:1])):
        if len(left) == 0 or len(right) == 0:  # the end of the universe
            continue
        towards_right = right[0] == top  # where both are zero
        a, d = left[0], right[0]
        for _ in range(90):
            b, c = a + (d - a) / 3, d - (d - a) / 3
            at_b, at_c = float(match(b)), float(match(c))
            best = max(best, at_b, at_c)
            a, d = (b, d) if at_b < at_c or (at_b == at_c and towards_right) else (a, c)
    return best


@settings(derandomize=True, deadline=None, max_examples=400)
@given(spec=specs, x=values, width=widths, shape=shapes)
def test_the_possibility_is_the_best_match_over_the_universe(spec, x, width, shape):
    ours = fuzzy.possibility(variable_with(spec), "A", x, width, shape)
    searched = best_match(spec, x, width, shape)
    assert ours == pytest.approx(searched, abs=1e-12)


def test_a_triangle_beside_a_triangle_by_hand():
    # A' = (-0.2, 0, 0.2) falls as 1 - 5t; A = (0.1, 0.5, 0.9) rises as (t - 0.1)/0.4 = 2.5t - 0.25: they meet at
    # t = 1/6 with the degree 1/6.
    variable = variable_with({"triangle": [0.1, 0.5, 0.9]})
    assert fuzzy.possibility(variable, "A", 0.0, 0.2) == pytest.approx(1 / 6, abs=1e-15)
    assert fuzzy.possibility(variable, "A", 0.0, 0.1) == 0.0  # they only touch
    # Two Gaussians of sigma 0.1 and 0.3, means 0.4 apart, meet one sigma from both.
    gaussian = variable_with({"gaussian": {"mean": 0.4, "sigma": 0.3}})
    assert fuzzy.possibility(gaussian, "A", 0.0, 0.1, GAUSSIAN) == pytest.approx(math.exp(-0.5), abs=1e-15)


def test_beyond_the_end_of_the_universe_nothing_counts():
    # The peak is at 1.2, outside. From 0.8, A' of width 0.6 meets the rising side at t = 1.04; inside, the best point
    # is the end, where A has the degree (1 - 0.8)/0.4 = 1/2.
    assert fuzzy.possibility(variable_with({"triangle": [0.8, 1.2, 1.6]}), "A", 0.8, 0.6) == pytest.approx(0.5)


@settings(derandomize=True, deadline=None, max_examples=200)
@given(spec=specs, x=values, width=widths, more=st.floats(1.0, 3.0), shape=shapes)
def test_a_wider_input_is_possibly_in_no_set_less(spec, x, width, more, shape):
    variable = variable_with(spec)
    singleton = fuzzy.membership(make_set(spec), x)
    narrow = fuzzy.possibility(variable, "A", x, width, shape)
    wide = fuzzy.possibility(variable, "A", x, more * width, shape)
    assert singleton - 1e-13 <= narrow <= wide + 1e-13 <= 1 + 1e-13


@settings(derandomize=True, deadline=None, max_examples=100)
@given(e=st.floats(-1.1, 1.1), ec=st.floats(-1.1, 1.1), shape=shapes)
def test_as_the_widths_vanish_the_output_tends_to_that_of_singletons(controller, e, ec, shape):
    singleton = fuzzy.infer(controller, e, ec)
    # In the limit itself they are the same bits ...
    none = fuzzy.infer(controller, e, ec, fuzzy.InputWidths(0.0, 0.0, shape))
    assert none.output == singleton.output
    np.testing.assert_array_equal(none.strengths, singleton.strengths)
    # ... and on the way there the distance shrinks with the width. A triangle adds at most width * slope to a degree
    # (slope <= 1/0.12), a Gaussian sqrt(2 ln(1/(width slope))) times as much; u follows with a slope of about 9.
    for width in (1e-3, 1e-5, 1e-7):
        wide = fuzzy.infer(controller, e, ec, fuzzy.InputWidths(width, width, shape))
        assert np.abs(wide.strengths - singleton.strengths).max() < 9 * width * (1 if shape == TRIANGLE else 6)
        assert abs(wide.output - singleton.output) < 50 * width * (1 if shape == TRIANGLE else 6)


def assert_equation_6(data, controller, e, ec, widths):
    """Against the search for the best match; an input without a width has the degree of its value."""

    def degrees(name, x, width):
        specs = data[name]["terms"].values()
        if width == 0.0:
            return [fuzzy_reference.degree(spec, x) for spec in specs]
        return [best_match(spec, x, width, widths.shape) for spec in specs]

    table = controller.rules.consequents
    strengths = np.minimum.outer(degrees("E", e, widths.error), degrees("EC", ec, widths.error_change))
    term_strengths = [strengths[table == k].max() for k in range(7)]
    area, first = fuzzy_reference.moments(list(data["U"]["terms"].values()), term_strengths)
    inference = fuzzy.infer(controller, e, ec, widths)
    np.testing.assert_allclose(inference.strengths, strengths.ravel(), rtol=0, atol=1e-12)
    assert inference.output == pytest.approx(first / area, abs=1e-10)


@pytest.mark.parametrize("shape", [TRIANGLE, GAUSSIAN])
def test_inference_with_widths_is_equation_6(data, shape):
    controller = make_controller(data)
    rng = np.random.default_rng(12)
    for e, ec, we, wec in zip(*rng.uniform(-1, 1, (2, 6)), *rng.uniform(0.02, 0.6, (2, 6)), strict=True):
        assert_equation_6(data, controller, e, ec, fuzzy.InputWidths(we, wec, shape))


@pytest.mark.parametrize(("we", "wec"), [(0.5, 0.0), (0.0, 0.5)])
def test_one_wide_input_beside_a_singleton_is_equation_6(data, we, wec):
    # The wide one fires terms that no stretch of the singleton knows of, so every term of the output may count; at the
    # ends of the universe, where a stretch is a single point, as well.
    controller = make_controller(data)
    inside = np.random.default_rng(13).uniform(-1, 1, (6, 2))
    for e, ec in [*inside, (-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]:
        assert_equation_6(data, controller, e, ec, fuzzy.InputWidths(we, wec, TRIANGLE))


def test_a_batch_with_widths_gives_the_same_bits_as_one_at_a_time(controller):
    e, ec = np.random.default_rng(4).uniform(-1.2, 1.2, (2, 50))
    wide = fuzzy.InputWidths(0.1, 0.4, GAUSSIAN)
    outputs, strengths = fuzzy.infer_batch(controller, e, ec, wide)
    np.testing.assert_array_equal(outputs, fuzzy.infer_outputs(controller, e, ec, wide))
    for i in range(50):
        one = fuzzy.infer(controller, e[i], ec[i], wide)
        np.testing.assert_array_equal([outputs[i], *strengths[i]], [one.output, *one.strengths])


@pytest.mark.parametrize("width", [-0.1, math.nan, math.inf])
def test_a_width_that_is_none_is_refused(width):
    with pytest.raises(ValueError, match="width"):
        fuzzy.InputWidths(width, 0.0)
    with pytest.raises(ValueError, match="width"):
        fuzzy.InputWidths(0.0, width)

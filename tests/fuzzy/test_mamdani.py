"""Inference with the shipped controller and with random ones."""

import math

import fuzzy_reference
import numpy as np
import pytest
from fuzzy_builders import make_controller
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import fuzzy

pytestmark = pytest.mark.builds

GRID = np.linspace(-1, 1, 201)
E, EC = (x.ravel() for x in np.meshgrid(GRID, GRID, indexing="ij"))


def test_the_output_agrees_with_adaptive_quadrature(controller, data):
    rng = np.random.default_rng(7)
    for e, ec in rng.uniform(-1.1, 1.1, (30, 2)):
        assert fuzzy.infer(controller, e, ec).output == pytest.approx(fuzzy_reference.output(data, e, ec), abs=1e-12)


def test_the_output_at_the_corners_of_the_sets_agrees_with_adaptive_quadrature(controller, data):
    # Where a set begins, peaks or ends, inference changes from one stretch of the universe to the next.
    def corners(name):
        numbers = {x for spec in data[name]["terms"].values() for p in spec.values() for x in p}
        return sorted(x for x in numbers if -1 <= x <= 1)

    for e in corners("E"):
        for ec in corners("EC"):
            ours = fuzzy.infer(controller, e, ec).output
            assert ours == pytest.approx(fuzzy_reference.output(data, e, ec), abs=1e-12)


def test_gaussian_sets_agree_with_adaptive_quadrature(gaussian_data):
    controller = make_controller(gaussian_data)
    rng = np.random.default_rng(8)
    for e, ec in rng.uniform(-1.1, 1.1, (60, 2)):
        expected = fuzzy_reference.output(gaussian_data, e, ec)
        assert fuzzy.infer(controller, e, ec).output == pytest.approx(expected, abs=1e-9)


def test_the_strength_of_a_rule_is_the_lesser_of_its_two_degrees(controller):
    # Equation (4), for all 56 rules and the whole grid at once.
    _, strengths = fuzzy.infer_batch(controller, E, EC)
    rows = np.array([fuzzy.membership(term.set, E) for term in controller.error.terms])
    columns = np.array([fuzzy.membership(term.set, EC) for term in controller.error_change.terms])
    expected = np.minimum(rows[:, None, :], columns[None, :, :]).reshape(56, -1).T
    np.testing.assert_array_equal(strengths, expected)


def test_every_one_of_the_56_rules_is_reached(controller):
    # Not only touched: at the peaks of its two sets each rule fires fully (the grid has the peaks to 1e-16).
    _, strengths = fuzzy.infer_batch(controller, E, EC)
    assert np.all(strengths.max(axis=0) > 1 - 1e-12)


def test_some_rule_fires_for_every_input(controller):
    _, strengths = fuzzy.infer_batch(controller, E, EC)
    assert strengths.max(axis=1).min() >= 0.4  # EC's neighbours cross at 1/2, E's near 0.47


def test_inputs_outside_the_universes_saturate(controller):
    for outside, edge in [(1.0001, 1), (7, 1), (math.inf, 1), (-1.0001, -1), (-1e300, -1), (-math.inf, -1)]:
        for other in (-1.0, -0.3, 0.0, 0.45, 1.0):
            a, b = fuzzy.infer(controller, outside, other), fuzzy.infer(controller, edge, other)
            assert a.output == b.output
            np.testing.assert_array_equal(a.strengths, b.strengths)
            assert fuzzy.infer(controller, other, outside).output == fuzzy.infer(controller, other, edge).output


def test_nan_in_gives_nan_out_and_no_rule_fires(controller):
    for e, ec in [(math.nan, 0), (0, math.nan), (math.nan, math.nan)]:
        inference = fuzzy.infer(controller, e, ec)
        assert math.isnan(inference.output)
        assert np.all(inference.strengths == 0)


def test_a_batch_gives_the_same_bits_as_one_at_a_time(controller):
    e, ec = np.random.default_rng(3).uniform(-1.2, 1.2, (2, 200))
    e[17] = np.nan
    outputs, strengths = fuzzy.infer_batch(controller, e, ec)
    assert outputs.shape == (200,)
    assert strengths.shape == (200, 56)
    for i in range(200):
        one = fuzzy.infer(controller, e[i], ec[i])
        np.testing.assert_array_equal([outputs[i], *strengths[i]], [one.output, *one.strengths])


@pytest.mark.parametrize(("a", "b"), [((3,), (4,)), ((2, 2), (2, 2)), ((), ())])
def test_a_batch_of_another_shape_is_refused(controller, a, b):
    with pytest.raises(ValueError, match=r"error_change: has not the shape \(N,\) of error"):
        fuzzy.infer_batch(controller, np.zeros(a), np.zeros(b))


def test_an_empty_batch_is_empty(controller):
    outputs, strengths = fuzzy.infer_batch(controller, np.zeros(0), np.zeros(0))
    assert outputs.shape == (0,)
    assert strengths.shape == (0, 56)


@st.composite
def partitions(draw, count):
    """Terms on [-1, 1] whose neighbours cross at one half: shoulders outside, triangles or Gaussians between."""
    gaps = draw(st.lists(st.floats(0.2, 1.0), min_size=count - 1, max_size=count - 1))
    peaks = -1 + 2 * np.concatenate([[0], np.cumsum(gaps)]) / np.sum(gaps)
    Gaussians = draw(st.booleans())
    terms = {"T0": {"trapezoid": [-math.inf, -math.inf, peaks[0], peaks[1]]}}
    for k in range(1, count - 1):
        a, b, c = (float(x) for x in peaks[k - 1 : k + 2])
        terms[f"T{k}"] = {"gaussian": {"mean": b, "sigma": (c - a) / 4}} if Gaussians else {"triangle": [a, b, c]}
    terms[f"T{count - 1}"] = {"trapezoid": [peaks[-2], peaks[-1], math.inf, math.inf]}
    return {"universe": [-1.0, 1.0], "terms": terms}


@st.composite
def controllers(draw):
    data = {"name": "random", "E": draw(partitions(8)), "EC": draw(partitions(7)), "U": draw(partitions(7))}
    row = st.lists(st.integers(0, 6).map("T{}".format), min_size=7, max_size=7)
    data["rules"] = {"columns": [f"T{j}" for j in range(7)], **{f"T{i}": draw(row) for i in range(8)}}
    return data


unit = st.floats(-1.2, 1.2)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(data=controllers(), e=unit, ec=unit)
def test_random_partitions_are_proved_and_agree_with_adaptive_quadrature(data, e, ec):
    controller = make_controller(data)
    expected = fuzzy_reference.output(data, e, ec)
    assert fuzzy.infer(controller, e, ec).output == pytest.approx(expected, abs=1e-9)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(data=controllers())
def test_the_output_of_random_partitions_is_finite_and_inside_the_universe(data):
    outputs, _ = fuzzy.infer_batch(make_controller(data), E[::41], EC[::41])
    assert np.all(np.abs(outputs) <= 1)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(data=controllers(), e=unit, ec=unit)
def test_a_mirrored_controller_gives_the_mirrored_output(data, e, ec):
    # All axes turned round, and with them the table: u(-e, -ec) of the mirror is -u(e, ec).
    def mirrored(variable):
        terms = {}
        for label, spec in reversed(variable["terms"].items()):
            ((shape, p),) = spec.items()
            flipped = {"mean": -p["mean"], "sigma": p["sigma"]} if shape == "gaussian" else [-x for x in reversed(p)]
            terms[label] = {shape: flipped}
        return {"universe": variable["universe"], "terms": terms}

    mirror = {"name": "mirror"} | {name: mirrored(data[name]) for name in ("E", "EC", "U")}
    rules = {row: cells[::-1] for row, cells in data["rules"].items()}
    mirror["rules"] = rules
    ours, theirs = (fuzzy.infer(make_controller(d), s * e, s * ec).output for d, s in ((data, 1), (mirror, -1)))
    assert theirs == pytest.approx(-ours, abs=1e-12)

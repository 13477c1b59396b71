"""Enclosures of the law over boxes against the compiled law, on the shipped file and on random ones.

The compiled law is the exact one but for its rounding: some 1e-15, for which ROUNDING allows.
"""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from random_laws import controllers

from pilotfish import data, fuzzy
from pilotfish.fuzzy_proof.boxes import Boxes
from pilotfish.fuzzy_proof.enclosure import Encloser
from pilotfish.fuzzy_proof.interval import Interval
from pilotfish.fuzzy_proof.layers import value
from pilotfish.fuzzy_proof.pieces import surface_of

ROUNDING = 1e-12


@pytest.fixture(scope="module")
def shipped():
    return fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))


@pytest.fixture(scope="module")
def encloser(shipped):
    return Encloser(surface_of(shipped))


def points_in(encloser, boxes, random):
    """One point in each box, and whether it certainly lies in the box's piece, clear of its ends, where u may jump."""
    x, y = (
        np.clip(i.lo + (i.hi - i.lo) * random.uniform(0.01, 0.99, len(boxes)), i.lo, i.hi) for i in (boxes.e, boxes.ec)
    )
    inside = encloser.holds(Boxes(boxes.piece, Interval.point(x), Interval.point(y)))
    wide = (boxes.e.hi - boxes.e.lo > 1e-9) & (boxes.ec.hi - boxes.ec.lo > 1e-9)
    return x, y, inside & wide


def outside(controller, encloser, boxes, random):
    """How many outputs of the compiled law, at points in boxes, lie outside of the boxes' bounds; and of how many."""
    x, y, inside = points_in(encloser, boxes, random)
    bounds, u = encloser.bounds(boxes).u, fuzzy.infer_outputs(controller, x, y)
    wrong = (u < bounds.lo - ROUNDING) | (u > bounds.hi + ROUNDING)
    return int((wrong & inside).sum()), int(inside.sum())


def halved(encloser, times):
    boxes = encloser.boxes
    for k in range(times):
        boxes = boxes.halves(np.full(len(boxes), k % 2 == 0))
        boxes = boxes[encloser.touches(boxes)]
    return boxes


def test_the_exact_formula_of_a_piece_is_the_compiled_law(shipped):
    # sum M / sum A in rationals at the mean of a piece's vertices: no interval, no box.
    surface = surface_of(shipped)
    for piece in surface.pieces[::7]:
        at = [sum(v[i] for v in piece.vertices) / len(piece.vertices) for i in (0, 1)]
        area = first = Fraction(0)
        for height in piece.heights:
            h = height.degree.at(at[height.axis])
            layer = next(layer for layer in surface.layers.profiles[height.profile] if h <= layer.top)
            area, first = area + value(layer.area, h), first + value(layer.first, h)
        assert float(first / area) == pytest.approx(fuzzy.infer(shipped, *map(float, at)).output, abs=1e-14)


@pytest.mark.parametrize("times", [0, 3])
def test_the_law_lies_inside_its_bounds_over_boxes_of_any_size(shipped, encloser, times):
    wrong, of = outside(shipped, encloser, halved(encloser, times), np.random.default_rng(times))
    assert of > 200
    assert wrong == 0


def test_bounds_that_were_a_tenth_too_narrow_would_be_found(shipped, encloser, monkeypatch):
    """The same check, with a multiplication that forgets a tenth at either end."""
    right = Interval.__mul__

    def narrow(self, other):
        product = right(self, other)
        lost = 0.1 * (product.hi - product.lo)
        return Interval(product.lo + lost, product.hi - lost)

    monkeypatch.setattr(Interval, "__mul__", narrow)
    assert outside(shipped, encloser, halved(encloser, 2), np.random.default_rng(0))[0] > 0


def test_the_slopes_of_the_law_lie_inside_their_bounds(shipped, encloser):
    boxes = halved(encloser, 3)
    random, step = np.random.default_rng(5), 1e-7
    bounds = encloser.bounds(boxes)
    x, y, inside = points_in(encloser, boxes, random)
    for slope, dx, dy in ((bounds.slope_e, step, 0.0), (bounds.slope_ec, 0.0, step)):
        there = Boxes(boxes.piece, Interval.point(x + dx), Interval.point(y + dy))
        both = inside & encloser.holds(there) & (x + dx <= boxes.e.hi) & (y + dy <= boxes.ec.hi)
        rise = fuzzy.infer_outputs(shipped, x + dx, y + dy) - fuzzy.infer_outputs(shipped, x, y)
        assert both.sum() > 500
        # A difference quotient of values that are right to 1e-15 is right to 1e-8.
        assert np.all((slope.lo - 1e-7 <= rise / step) | ~both)
        assert np.all((rise / step <= slope.hi + 1e-7) | ~both)


@settings(derandomize=True, deadline=None, max_examples=2, phases=[Phase.generate])
@given(controller=controllers(), seed=st.integers(0, 2**32 - 1))
def test_any_law_of_triangles_and_trapezoids_lies_inside_its_bounds(controller, seed):
    encloser = Encloser(surface_of(controller))
    random = np.random.default_rng(seed)
    for times in (0, 2):
        assert outside(controller, encloser, halved(encloser, times), random)[0] == 0


@settings(derandomize=True, deadline=None, max_examples=2, phases=[Phase.generate])
@given(controller=controllers(), seed=st.integers(0, 2**32 - 1))
def test_every_input_is_covered_by_a_box_that_bounds_the_law_there(controller, seed):
    # Corners of sets are drawn often: there, a vertical side belongs to its set, and only a piece of no width says so.
    encloser = Encloser(surface_of(controller))
    boxes, random = encloser.boxes, np.random.default_rng(seed)
    bounds = encloser.bounds(boxes).u
    corners = [x for v in (controller.error, controller.error_change) for t in v.terms for x in (t.set.a, t.set.d)]
    corners = [x for x in corners if -1 <= x <= 1]
    for _ in range(60):
        x, y = (random.choice(corners) if random.random() < 0.4 else random.uniform(-1, 1) for _ in range(2))
        there = (boxes.e.lo <= x) & (x <= boxes.e.hi) & (boxes.ec.lo <= y) & (y <= boxes.ec.hi)
        u = fuzzy.infer(controller, x, y).output
        assert np.any(there & (bounds.lo - ROUNDING <= u) & (u <= bounds.hi + ROUNDING))


def test_a_vertical_side_needs_its_piece_of_no_width():
    """Two boxes that meet at 0 in e: at 0 both are 1, beside it only one is, so u(0) lies on neither side's surface."""
    tent = [fuzzy.Triangle(-1.5 + 0.3 * k, -1.2 + 0.3 * k, -0.9 + 0.3 * k) for k in range(2)]
    rows = [
        fuzzy.Trapezoid(-np.inf, -np.inf, -1.0, 0.0),
        *tent,
        fuzzy.Trapezoid(-1.0, -1.0, 0.0, 0.0),
        fuzzy.Trapezoid(0.0, 0.0, 1.0, 1.0),
        *(fuzzy.Triangle(0.5, 0.7, 0.9) for _ in range(2)),
        fuzzy.Trapezoid(0.5, 1.0, np.inf, np.inf),
    ]
    columns = [fuzzy.Trapezoid(-np.inf, -np.inf, np.inf, np.inf) for _ in range(7)]
    output = [fuzzy.Triangle(-1.0, -0.5, 0.0), fuzzy.Triangle(0.0, 0.5, 1.0)]

    def variable(name, sets):
        return fuzzy.LinguisticVariable(name, [fuzzy.Term(f"T{k}", set_) for k, set_ in enumerate(sets)])

    rules = [[0] * 7 if row < 4 else [1] * 7 for row in range(8)]
    controller = fuzzy.Controller(
        error=variable("E", rows),
        error_change=variable("EC", columns),
        output=variable("U", output),
        rules=fuzzy.RuleBase(rules),
        name="boxes",
    )
    # At 0 both terms of U are full and mirror images: 0. Left of it only the left one: -0.5.
    assert fuzzy.infer(controller, 0.0, 0.0).output == pytest.approx(0.0, abs=1e-15)
    assert fuzzy.infer(controller, -1e-9, 0.0).output == pytest.approx(-0.5, abs=1e-6)
    encloser = Encloser(surface_of(controller))
    boxes = encloser.boxes
    bounds = encloser.bounds(boxes).u
    at_side = (boxes.e.lo == 0.0) & (boxes.e.hi == 0.0)
    assert np.any(at_side & (bounds.lo <= 0.0) & (bounds.hi >= 0.0))
    beside = (boxes.e.lo <= 0.0) & (boxes.e.hi >= 0.0) & ~at_side
    assert not np.any(beside & (bounds.lo <= 0.0) & (bounds.hi >= 0.0))

"""The clipped union from polynomials in the firing strengths, as in inference: against quadrature and the envelope."""

import fuzzy_reference
import numpy as np
import pytest
from fuzzy_builders import make_set
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import fuzzy

corner = st.floats(-1.6, 1.6).map(lambda x: round(x, 2))  # shared corners and vertical sides must be frequent
height = st.one_of(st.just(0.0), st.just(1.0), st.floats(1e-3, 1.0))


def make_variable(specs):
    return fuzzy.LinguisticVariable("U", [fuzzy.Term(f"T{i}", make_set(s)) for i, s in enumerate(specs)])


@st.composite
def ordered_families(draw):
    """Trapezoids (and triangles: b == c) whose corners never fall from one to the next: each corner is sorted over the
    terms, which keeps a <= b <= c <= d in every term. Shoulders may open at either end."""
    count = draw(st.integers(1, 6))
    corners = np.array([sorted(draw(st.lists(corner, min_size=4, max_size=4))) for _ in range(count)])
    corners = np.sort(corners, axis=0)
    if draw(st.booleans()):
        corners[:, 2] = corners[:, 1]
    if draw(st.booleans()):
        corners[0, :2] = -np.inf
    if draw(st.booleans()):
        corners[-1, 2:] = np.inf
    family = [c.tolist() for c in corners if c[0] < c[3] - 1e-3]
    term_strengths = draw(st.lists(height, min_size=len(family), max_size=len(family)))
    return [{"trapezoid": c} for c in family], term_strengths


@settings(derandomize=True, deadline=None, max_examples=150)
@given(family=ordered_families().filter(lambda f: f[0]))
def test_every_ordered_family_agrees_with_adaptive_quadrature(family):
    specs, term_strengths = family
    moments = fuzzy.ordered_union_moments(make_variable(specs), term_strengths)
    np.testing.assert_allclose(
        [moments.area, moments.first], fuzzy_reference.moments(specs, term_strengths), rtol=0, atol=1e-12
    )


@settings(derandomize=True, deadline=None, max_examples=300)
@given(term_strengths=st.lists(height, min_size=7, max_size=7))
def test_the_shipped_output_sets_agree_with_the_envelope_at_any_heights(controller, term_strengths):
    # They are ordered, and NM and ZE overlap beside NS: pairs that are no neighbours count, too.
    ours = fuzzy.ordered_union_moments(controller.output, term_strengths)
    envelope = fuzzy.clipped_union_moments(controller.output, term_strengths)
    np.testing.assert_allclose([ours.area, ours.first], [envelope.area, envelope.first], rtol=0, atol=1e-14)


def test_a_term_that_hides_behind_the_one_between_by_hand():
    # Three unit boxes over [0, 2], [1, 3] and [1, 4] tenths, strengths 1/2, 1, 1/4. The union: 1/2 over [0, 1], 1 over
    # [1, 3], 1/4 over [3, 4]: area 0.05 + 0.2 + 0.025. The first and the third overlap over [1, 2], but below the level
    # 1/4 the second lies between them: that pair must not count.
    boxes = [{"trapezoid": [a, a, b, b]} for a, b in ((0.0, 0.2), (0.1, 0.3), (0.1, 0.4))]
    moments = fuzzy.ordered_union_moments(make_variable(boxes), [0.5, 1.0, 0.25])
    assert moments.area == pytest.approx(0.275, abs=1e-15)
    # First moment: 0.05 * 0.05 + 0.2 * 0.2 + 0.025 * 0.35.
    assert moments.first == pytest.approx(0.05125, abs=1e-15)


@pytest.mark.parametrize(
    "specs",
    [
        [{"triangle": [-0.8, 0, 0.8]}, {"triangle": [-0.1, 0.05, 0.2]}],  # one inside the other
        [{"triangle": [0, 0.3, 0.6]}, {"triangle": [-0.6, -0.3, 0]}],  # from right to left
        [{"gaussian": {"mean": 0, "sigma": 0.2}}],
    ],
    ids=["nested", "reversed", "gaussian"],
)
def test_sets_out_of_order_are_left_to_the_envelope(specs):
    assert fuzzy.ordered_union_moments(make_variable(specs), [1.0] * len(specs)) is None

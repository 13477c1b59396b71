"""Which terms fire where is known at load; that must change no bit of what membership() says."""

import math

import numpy as np
import pytest
from fuzzy_builders import make_controller, make_set
from hypothesis import given, settings
from hypothesis import strategies as st
from test_ordered_union import corner

from pilotfish import fuzzy

sets = st.one_of(
    st.lists(corner, min_size=3, max_size=3).map(sorted).map(lambda c: {"triangle": c}),
    st.lists(corner, min_size=4, max_size=4).map(sorted).map(lambda c: {"trapezoid": c}),
    st.lists(corner, min_size=2, max_size=2).map(sorted).map(lambda c: {"trapezoid": [-math.inf, -math.inf, *c]}),
    st.lists(corner, min_size=2, max_size=2).map(sorted).map(lambda c: {"trapezoid": [*c, math.inf, math.inf]}),
    st.builds(lambda m, s: {"gaussian": {"mean": m, "sigma": s}}, corner, st.floats(0.05, 0.8)),
)


def has_area_inside(spec):
    """Within the universe [-1, 1], and more than validation requires."""
    ((shape, p),) = spec.items()
    if shape == "gaussian":
        return abs(p["mean"]) <= 1  # the tail of a narrow gaussian outside would be too little
    return min(p[-1], 1) - max(p[0], -1) > 0.02


@settings(derandomize=True, deadline=None, max_examples=100)
@given(family=st.lists(sets.filter(has_area_inside), min_size=7, max_size=7), data_seed=st.integers(0, 1000))
def test_strengths_have_the_bits_of_membership_at_every_corner_and_beside_it(controller, family, data_seed):
    # One set of E covers everything, so that any seven are a universe that is covered.
    everywhere = fuzzy.Term("ALL", fuzzy.Trapezoid(-math.inf, -math.inf, math.inf, math.inf))
    terms = [everywhere, *(fuzzy.Term(f"T{i}", make_set(spec)) for i, spec in enumerate(family))]
    law = fuzzy.Controller(
        error=fuzzy.LinguisticVariable("E", terms),
        error_change=controller.error_change, output=controller.output, rules=controller.rules,
    )  # fmt: skip
    corners = {x for spec in family for p in spec.values() if not isinstance(p, dict) for x in p}
    corners = {x for x in corners if -1 <= x <= 1} | {-1.0, 1.0}
    beside = [np.nextafter(x, to) for x in corners for to in (-2, 2) if -1 < x < 1]
    e = np.array([*corners, *beside, *np.random.default_rng(data_seed).uniform(-1, 1, 20)])
    # ec = 0 makes ZE one and everything else zero: the strengths of the column ZE are the degrees of E.
    _, strengths = fuzzy.infer_batch(law, e, np.zeros(len(e)))
    degrees = np.array([fuzzy.membership(term.set, e) for term in terms]).T
    np.testing.assert_array_equal(strengths.reshape(-1, 8, 7)[:, :, 3], degrees)


@pytest.mark.parametrize(("low", "high"), [(3.0, 47.0), (-1e-3, 2e-3), (1e6, 1e6 + 1)])
def test_a_universe_may_be_anywhere_and_of_any_size(controller, data, low, high):
    def moved(x):
        return low + (x + 1) / 2 * (high - low)

    for spec in data["E"]["terms"].values():
        for shape, p in spec.items():
            spec[shape] = [moved(x) for x in p]
    data["E"]["universe"] = [low, high]
    twin = make_controller(data)
    e, ec = np.random.default_rng(9).uniform(-1.1, 1.1, (2, 2000))
    # The corners are rounded where they have moved to, which moves them by up to an ulp of 1e6 on a universe of 1.
    np.testing.assert_allclose(
        fuzzy.infer_outputs(twin, moved(e), ec), fuzzy.infer_outputs(controller, e, ec), rtol=0, atol=1e-8
    )

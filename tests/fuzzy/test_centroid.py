"""Area and first moment of clipped unions: by hand, against adaptive quadrature, and as properties."""

import fuzzy_reference
import numpy as np
import pytest
from fuzzy_builders import make_set
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import fuzzy


def make_variable(specs, lo=-1.0, hi=1.0):
    terms = [fuzzy.Term(f"T{i}", make_set(spec)) for i, spec in enumerate(specs)]
    return fuzzy.LinguisticVariable("U", terms, min=lo, max=hi)


def moments(specs, term_strengths, lo=-1.0, hi=1.0):
    result = fuzzy.clipped_union_moments(make_variable(specs, lo, hi), term_strengths)
    return result.area, result.first


def triangle(a, b, c):
    return {"triangle": [a, b, c]}


def trapezoid(a, b, c, d):
    return {"trapezoid": [a, b, c, d]}


def gaussian(mean, sigma):
    return {"gaussian": {"mean": mean, "sigma": sigma}}


def test_a_clipped_triangle_by_hand():
    # (-0.4, 0, 0.4) clipped at 1/2 is a trapezoid with bases 0.8 and 0.4: area 0.5 (0.8 + 0.4)/2 = 0.3.
    area, first = moments([triangle(-0.4, 0, 0.4)], [0.5])
    assert area == pytest.approx(0.3, abs=1e-15)
    assert first == pytest.approx(0, abs=1e-15)


def test_the_reach_of_a_triangle_about_the_end_of_the_universe_is_two_thirds_into_its_inner_half():
    # Of (0.75, 1, 1.25) only the rising side [0.75, 1] is inside: a right triangle of centroid
    # 0.75 + 2/3 0.25 = 11/12.
    area, first = moments([triangle(0.75, 1, 1.25)], [1.0])
    assert area == pytest.approx(0.125, abs=1e-15)
    assert first / area == pytest.approx(11 / 12, abs=1e-15)


def test_two_crossing_triangles_by_hand():
    # (-1, 0, 1) and (0, 1, 2) inside [-1, 1] cross at (1/2, 1/2). Area: the left half has 1/2, over [0, 1]
    # the greater of 1 - u and u has 3/4: together 5/4.
    # First moment: left half -1/6; int_0^1/2 u (1 - u) = 1/8 - 1/24 = 1/12; int_1/2^1 u^2 = 7/24. Sum 5/24.
    area, first = moments([triangle(-1, 0, 1), triangle(0, 1, 2)], [1.0, 1.0])
    assert area == pytest.approx(5 / 4, abs=1e-15)
    assert first == pytest.approx(5 / 24, abs=1e-15)


def test_a_set_inside_another_adds_nothing_and_a_set_that_does_not_fire_neither():
    wide, narrow = trapezoid(-0.8, -0.4, 0.2, 0.6), triangle(-0.3, 0, 0.1)
    alone = moments([wide], [0.7])
    assert moments([wide, narrow], [0.7, 0.6]) == pytest.approx(alone, abs=1e-15)
    assert moments([wide, narrow], [0.7, 0.0]) == alone


def test_twice_the_same_set_is_the_set():
    for spec in (triangle(-0.5, 0.2, 0.9), trapezoid(-0.5, -0.2, 0.1, 0.3), gaussian(0.1, 0.2)):
        assert moments([spec, spec], [0.6, 0.6]) == pytest.approx(moments([spec], [0.6]), abs=1e-15)


@pytest.mark.parametrize("sigma", [0.02, 0.1, 0.5])
def test_a_whole_gaussian_has_the_area_of_the_normal_distribution(sigma):
    # Universe of +-10 sigma: sqrt(2 pi) sigma but for 1e-23, centroid at the mean.
    area, first = moments([gaussian(0.3, sigma)], [1.0], 0.3 - 10 * sigma, 0.3 + 10 * sigma)
    assert area == pytest.approx(np.sqrt(2 * np.pi) * sigma, rel=1e-14)
    assert first / area == pytest.approx(0.3, abs=1e-14)


def test_the_far_tail_of_a_gaussian_keeps_its_digits():
    # Beyond 8 sigma, erf is 1 to all digits; the area is still known: sigma sqrt(pi/2) erfc(8/sqrt 2) and
    # erfc(8/sqrt 2) = 1.244192114854357e-15 (Abramowitz and Stegun's continued fraction, and any table).
    area, _ = moments([gaussian(0, 0.1)], [1.0], 0.8, 8.0)
    assert area == pytest.approx(0.1 * np.sqrt(np.pi / 2) * 1.244192114854357e-15, rel=1e-12)


@pytest.mark.parametrize("height", [0.05, 0.3, 1.0])
def test_the_centroid_of_a_symmetric_set_is_its_centre(height):
    for spec in (triangle(0.1, 0.3, 0.5), trapezoid(0.0, 0.2, 0.4, 0.6), gaussian(0.3, 0.05)):
        area, first = moments([spec], [height], -0.4, 1.0)
        assert first / area == pytest.approx(0.3, abs=1e-14)


def test_no_height_means_no_area():
    assert moments([triangle(-1, 0, 1), gaussian(0, 1)], [0.0, 0.0]) == (0.0, 0.0)


corner = st.floats(-1.5, 1.5).map(lambda x: round(x, 3))  # vertical sides and shared knees must be frequent
triangles = (
    st.lists(corner, min_size=3, max_size=3).map(sorted).filter(lambda c: c[0] < c[2]).map(lambda c: triangle(*c))
)
trapezoids = (
    st.lists(corner, min_size=4, max_size=4).map(sorted).filter(lambda c: c[0] < c[3]).map(lambda c: trapezoid(*c))
)
shoulders = (
    st.lists(corner, min_size=2, max_size=2)
    .map(sorted)
    .filter(lambda c: c[0] < c[1])
    .flatmap(lambda c: st.sampled_from([trapezoid(-np.inf, -np.inf, *c), trapezoid(*c, np.inf, np.inf)]))
)
gaussians = st.builds(gaussian, corner, st.floats(0.02, 1.0))
height = st.one_of(st.just(0.0), st.just(1.0), st.floats(1e-3, 1.0))


def families(shapes):
    return st.lists(st.tuples(shapes, height), min_size=1, max_size=7)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(family=families(st.one_of(triangles, trapezoids, shoulders)))
def test_triangles_and_trapezoids_agree_with_adaptive_quadrature(family):
    specs, term_strengths = [list(part) for part in zip(*family, strict=True)]
    np.testing.assert_allclose(
        moments(specs, term_strengths), fuzzy_reference.moments(specs, term_strengths), atol=1e-12
    )


@settings(derandomize=True, deadline=None, max_examples=100)
@given(family=families(st.one_of(gaussians, triangles, shoulders)))
def test_gaussians_among_other_sets_agree_with_adaptive_quadrature(family):
    specs, term_strengths = [list(part) for part in zip(*family, strict=True)]
    np.testing.assert_allclose(
        moments(specs, term_strengths), fuzzy_reference.moments(specs, term_strengths), atol=1e-9
    )


@settings(derandomize=True, deadline=None, max_examples=100)
@given(family=families(st.one_of(triangles, trapezoids, shoulders, gaussians)), shift=corner)
def test_a_shifted_picture_has_the_shifted_centroid(family, shift):
    def shifted(spec):
        ((shape, p),) = spec.items()
        if shape == "gaussian":
            return gaussian(p["mean"] + shift, p["sigma"])
        return {shape: [x + shift for x in p]}

    specs, term_strengths = [list(part) for part in zip(*family, strict=True)]
    area, first = moments(specs, term_strengths)
    moved_area, moved_first = moments([shifted(s) for s in specs], term_strengths, -1 + shift, 1 + shift)
    assert moved_area == pytest.approx(area, abs=1e-12)
    assert moved_first == pytest.approx(first + shift * area, abs=1e-12)


@settings(derandomize=True, deadline=None, max_examples=100)
@given(
    family=families(st.one_of(triangles, trapezoids, shoulders, gaussians)),
    extra=st.tuples(gaussians, height),
)
def test_one_more_set_never_takes_area_away_nor_adds_more_than_its_own(family, extra):
    specs, term_strengths = [list(part) for part in zip(*family, strict=True)]
    before, _ = moments(specs, term_strengths)
    own, _ = moments([extra[0]], [extra[1]])
    after, _ = moments([*specs, extra[0]], [*term_strengths, extra[1]])
    assert max(before, own) - 1e-13 <= after <= before + own + 1e-13


def test_heights_of_the_wrong_number_or_size_are_refused():
    variable = make_variable([triangle(-1, 0, 1), triangle(0, 1, 2)])
    with pytest.raises(ValueError, match="term_strengths: one for each of the 2 terms, not 1"):
        fuzzy.clipped_union_moments(variable, [1.0])
    for wrong in (-0.1, 1.1, np.nan):
        with pytest.raises(ValueError, match=r"outside \[0, 1\]"):
            fuzzy.clipped_union_moments(variable, [0.5, wrong])

"""The shipped surface u(e, ec): the shape the law relies on, measured."""

import numpy as np
import pytest

from pilotfish import fuzzy

STEP = 0.005
AXIS = np.linspace(-1, 1, 401)
ZERO = 200
LABELS = ["NB", "NM", "NS", "ZE", "PS", "PM", "PB"]


@pytest.fixture(scope="module")
def surface(controller):
    """u[i, j] = u(AXIS[i], AXIS[j])."""
    e, ec = np.meshgrid(AXIS, AXIS, indexing="ij")
    return fuzzy.infer_batch(controller, e.ravel(), ec.ravel())[0].reshape(e.shape)


def degrees(variable, x):
    return np.array([fuzzy.membership(term.set, x) for term in variable.terms])


def test_the_sets_of_ec_are_a_partition_of_unity(controller):
    np.testing.assert_allclose(degrees(controller.error_change, AXIS).sum(axis=0), 1.0, atol=1e-12)


def test_the_sets_of_e_are_a_partition_of_unity_beyond_the_peaks_of_ns_and_ps_and_more_within(controller):
    # Within +-0.3 NS and PS reach to zero and NZ and PZ overlap on purpose (see the file).
    total = degrees(controller.error, AXIS).sum(axis=0)
    outer = np.abs(AXIS) > 0.3 - 1e-9
    np.testing.assert_allclose(total[outer], 1.0, atol=1e-12)
    assert np.all(total[~outer] > 1.0)


def test_every_set_has_its_mirror_image(controller):
    for variable in (controller.error, controller.error_change, controller.output):
        values = degrees(variable, AXIS)
        np.testing.assert_allclose(values, values[::-1, ::-1], atol=1e-12)


# Table I is antisymmetric, cell(-E, -EC) = -cell(E, EC), but for five pairs of cells, each off by one term.
# These are the cells on the side of too far; their mirror images on the side of too close complete the pairs.
EXCEPTIONS = {("NB", "PS"), ("NB", "PM"), ("NM", "NM"), ("NM", "PB"), ("NS", "PM")}


def test_the_table_is_antisymmetric_but_for_five_pairs_of_cells(controller):
    table = controller.rules.consequents
    mirrored = 6 - table[::-1, ::-1]
    differing = np.argwhere(table != mirrored)
    rows, columns = controller.error.labels, LABELS
    assert {(rows[i], columns[j]) for i, j in differing if i < 4} == EXCEPTIONS
    assert len(differing) == 2 * len(EXCEPTIONS)
    assert np.abs(table - mirrored).max() == 1


def test_the_surface_is_antisymmetric_wherever_no_exception_fires(controller, surface):
    _, strengths = fuzzy.infer_batch(controller, *(x.ravel() for x in np.meshgrid(AXIS, AXIS, indexing="ij")))
    fires = strengths.reshape(401, 401, 8, 7) > 0
    exceptional = np.zeros((401, 401), dtype=bool)
    for row, column in EXCEPTIONS:
        i, j = controller.error.labels.index(row), LABELS.index(column)
        exceptional |= fires[:, :, i, j] | fires[:, :, 7 - i, 6 - j]
    exceptional |= exceptional[::-1, ::-1]
    assert 0.3 < (~exceptional).mean() < 0.9  # the statement below is about a good part of the surface, not all of it
    np.testing.assert_allclose((surface + surface[::-1, ::-1])[~exceptional], 0.0, atol=1e-12)
    assert np.abs(surface + surface[::-1, ::-1])[exceptional].max() > 0.1


def test_at_a_constant_distance_the_law_is_odd(surface):
    np.testing.assert_allclose(surface[:, ZERO], -surface[::-1, ZERO], atol=1e-12)


def test_there_is_no_dead_zone(controller):
    # Just above zero PS has the degree t = e/0.3 and clips NM there, ZE is clipped at PZ(0) = 0.1/0.12 = 5/6.
    # ZE has the area 0.8 (h - h^2/2) = 0.8 (5/6 - 25/72) = 7/18 and no first moment; NM adds t over what ZE
    # leaves of its support, [-0.9, -0.4]: -t (0.9^2 - 0.4^2)/2 = -0.325 t. So u = -0.325 t/(7/18), the
    # slope is -0.325/(7/18)/0.3. From zero to the peak of PS, where NM alone says -0.6, the mean slope is -2.
    e = np.array([1e-6, 1e-3, 0.01, 0.3])
    slope = -fuzzy.infer_batch(controller, e, np.zeros(4))[0] / e
    assert np.all(slope > 1.9)
    assert slope[0] == pytest.approx(0.325 * 18 / 7 / 0.3, rel=1e-4)  # 2.786
    assert slope[3] == pytest.approx(0.6 / 0.3, abs=1e-9)


def test_through_zero_the_curve_is_almost_straight(surface):
    inner = np.abs(AXIS) <= 0.3
    assert np.abs(surface[inner, ZERO] + 2.0 * AXIS[inner]).max() < 0.09


def test_the_reach_of_the_law_is_eleven_twelfths(surface):
    # PB alone, fully: the right triangle over [0.75, 1] has its centroid at 0.75 + 2/3 0.25.
    assert surface[0, ZERO] == pytest.approx(11 / 12, abs=1e-12)
    assert surface[-1, ZERO] == pytest.approx(-11 / 12, abs=1e-12)
    assert np.abs(surface).max() == pytest.approx(11 / 12, abs=1e-12)


def test_at_a_constant_distance_the_output_never_rises_with_the_error(surface):
    assert np.diff(surface[:, ZERO]).max() <= 1e-12


def ripple(surface, axis):
    """The most that u rises again above a value it had already fallen to, along an axis."""
    return (surface - np.minimum.accumulate(surface, axis=axis)).max()


def test_the_output_falls_with_the_error_up_to_a_ripple_of_0_031(surface):
    # Centroids of clipped sets are not monotone: while one set gives way, the skirts of both neighbours pull.
    assert ripple(surface, axis=0) == pytest.approx(0.0308, abs=0.001)


def test_the_output_falls_with_the_change_of_the_error_up_to_a_ripple_of_0_036(surface):
    assert ripple(surface, axis=1) == pytest.approx(0.0355, abs=0.001)


def test_the_surface_is_continuous_its_slopes_are_bounded(controller, surface):
    # Measured: 8.5 in e, 5.8 in ec. At a jump the quotient would grow without bound as the steps shrink.
    assert np.abs(np.diff(surface, axis=0)).max() / STEP < 9
    assert np.abs(np.diff(surface, axis=1)).max() / STEP < 6.5
    rng = np.random.default_rng(11)
    e, ec = rng.uniform(-1, 1, (2, 20_000))
    tiny = 1e-7
    here = fuzzy.infer_batch(controller, e, ec)[0]
    assert np.abs(fuzzy.infer_batch(controller, e + tiny, ec)[0] - here).max() / tiny < 9
    assert np.abs(fuzzy.infer_batch(controller, e, ec + tiny)[0] - here).max() / tiny < 6.5

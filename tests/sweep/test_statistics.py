"""Designs, intervals and sensitivities, against closed forms and SciPy."""

import numpy as np
import pytest
from scipy import stats

from pilotfish.errors import ConfigError
from pilotfish.sweep import design
from pilotfish.sweep.design import Sampling
from pilotfish.sweep.factors import Distributed, read_factor
from pilotfish.sweep.intervals import bootstrap_interval, curves, t_interval
from pilotfish.sweep.results import factor_label, metric_label
from pilotfish.sweep.sensitivity import sensitivities
from sweep.campaigns import made_up

FORMS = {
    "uniform": ({"uniform": [0.1, 0.3]}, stats.uniform(0.1, 0.2)),
    "log_uniform": ({"log_uniform": [0.1, 10.0]}, stats.loguniform(0.1, 10.0)),
    "normal": ({"normal": [1.0, 0.1]}, stats.truncnorm(-4, 4, 1.0, 0.1)),
    "normal within": ({"normal": [1.0, 0.1], "within": [0.9, 1.3]}, stats.truncnorm(-1, 3, 1.0, 0.1)),
}


@pytest.mark.parametrize(("said", "oracle"), FORMS.values(), ids=FORMS)
def test_a_quantile_s_value_is_scipy_s(said, oracle):
    quantiles = np.linspace(0.0, 1.0, 101)
    assert read_factor("x", said).at(quantiles) == pytest.approx(oracle.ppf(quantiles), rel=1e-9)


def test_listed_values_are_crossed_with_each_other_and_with_every_sample():
    listed = [read_factor("a", [1, 2, 3]), read_factor("b", ["x", "y"])]
    sampled = [read_factor("u", {"uniform": [0.0, 1.0]})]
    points = design.points([*listed, *sampled], Sampling("random", 5), seed=1)
    assert len(points) == 3 * 2 * 5
    assert {(point["a"], point["b"]) for point in points} == {(a, b) for a in (1, 2, 3) for b in "xy"}
    assert [point["u"] for point in points[:5]] == [point["u"] for point in points[25:]]
    assert points == design.points([*listed, *sampled], Sampling("random", 5), seed=1)
    assert points != design.points([*listed, *sampled], Sampling("random", 5), seed=2)


def test_a_latin_hypercube_has_one_point_in_each_part_of_each_range():
    factors = [read_factor(name, {"uniform": [0.0, 1.0]}) for name in "abc"]
    quantiles = design.samples(factors, Sampling("latin_hypercube", 40), seed=3)
    assert np.sort(np.floor(40 * quantiles), axis=0) == pytest.approx(np.tile(np.arange(40)[:, None], 3))


def test_steps_are_the_numbers_a_person_would_write():
    assert read_factor("x", {"from": 0.1, "to": 0.4, "steps": 7}).values == (0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4)
    assert read_factor("x", {"from": 0.01, "to": 1.0, "steps": 3, "scale": "log"}).values == (0.01, 0.1, 1.0)


def test_a_t_interval_is_scipy_s_and_holds_the_mean_19_times_of_20():
    """Of 1000 intervals 950 +- sqrt(1000 0.95 0.05) = 6.9 hold it; four of those are allowed."""
    random = np.random.default_rng(1)
    held = 0
    for _ in range(1000):
        values = random.normal(3.0, 2.0, 6)
        found = t_interval(values)
        held += found.low <= 3.0 <= found.high
    oracle = stats.t.interval(0.95, 5, values.mean(), stats.sem(values))
    assert (found.low, found.high) == pytest.approx(oracle, rel=1e-12)
    assert abs(held - 950) <= 28
    assert np.isnan(t_interval(np.array([1.0])).low) and t_interval(np.array([1.0])).mean == 1.0


def test_a_bootstrap_interval_of_many_runs_is_the_normal_one():
    """Of 400 exponential numbers the mean's standard error is nearly s / 20, and the interval 1.96 of it either way;
    its ends scatter by some 3 % with 2000 resamples."""
    values = np.random.default_rng(2).exponential(1.0, 400)
    found = bootstrap_interval(values)
    half = 1.96 * values.std(ddof=1) / 20.0
    assert (found.low, found.high) == pytest.approx((values.mean() - half, values.mean() + half), abs=0.15 * half)


def test_curves_are_means_by_value_and_many_values_are_put_together():
    """y = 2 x for a, 3 x for b. 240 different x make twelve groups of twenty."""
    x = np.tile(np.arange(240) / 240.0, 2)
    law = np.repeat(["a", "b"], 240)
    columns = {"run": np.arange(480), "x": x, "law": law, "rms_distance_mm": np.where(law == "a", 2.0, 3.0) * x}
    results = made_up({"x": {}, "law": {}}, columns, {})
    first, second = curves(results, "rms_distance_mm", "x", "law")
    assert (first.name, second.name) == ("a", "b")
    assert [each.count for each in first.intervals] == [20] * 12
    assert [each.mean for each in second.intervals] == pytest.approx(3.0 * second.x)
    assert all(each.low < each.mean < each.high for each in first.intervals)


def ishigami(x: np.ndarray) -> np.ndarray:
    """sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, of x in [-pi, pi] (Ishigami and Homma 1990)."""
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def sampled(method: str, points: int, function=ishigami):
    """Results of a function of three factors."""
    factors = [read_factor(name, {"uniform": [-np.pi, np.pi]}) for name in ("x1", "x2", "x3")]
    at = design.points(factors, Sampling(method, points), seed=1)
    x = np.array([list(point.values()) for point in at])
    said = {factor.name: {"form": Distributed.__name__} for factor in factors}
    columns = {"run": np.arange(len(x)), "point": np.arange(len(x)), "rms_distance_mm": function(x)}
    columns |= {"outcome": np.full(len(x), "ok"), "x1": x[:, 0], "x2": x[:, 1], "x3": x[:, 2]}
    return made_up(said, columns, {"method": method, "points": points})


def test_sobol_indices_of_ishigami_s_function_are_its_closed_form():
    """With a = 7, b = 0.1: V = a^2/8 + b pi^4/5 + b^2 pi^8/18 + 1/2 = 13.84; S1 = 0.3139, 0.4424, 0; ST = 0.5576,
    0.4424, 0.2437 (Sudret 2008). 1024 base samples are right within some hundredths."""
    (found,) = sensitivities(sampled("sobol", 1024), "rms_distance_mm")
    assert [found.first[name].value for name in ("x1", "x2", "x3")] == pytest.approx([0.3139, 0.4424, 0.0], abs=0.05)
    assert [found.total[name].value for name in ("x1", "x2", "x3")] == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.05)
    assert all(0.0 < index.half_width < 0.15 for index in found.total.values())
    assert (found.method, found.used, found.left_out) == ("sobol", 1024 * 5, 0)


def test_a_missing_figure_takes_its_base_sample_with_it_and_no_other():
    results = sampled("sobol", 64)
    results.columns["rms_distance_mm"][7] = np.nan  # of the second base sample, 5 to 9
    (found,) = sensitivities(results, "rms_distance_mm")
    assert (found.used, found.left_out) == (63 * 5, 5)


def test_other_samples_get_pawn_s_index_which_is_low_for_what_has_no_effect():
    """y = x1 + 0.2 x2, of x uniform in [-pi, pi]. In a slice of a tenth of x1's range y is there alone (but for x2's
    small part), so its distribution differs from that of all runs by nearly a half in the middle slice and by more in
    the others. Slices of 30 of 300 points differ by chance: the 5 % point of Kolmogorov's D of 30 is 0.24."""
    (found,) = sensitivities(sampled("latin_hypercube", 300, lambda x: x[:, 0] + 0.2 * x[:, 1]), "rms_distance_mm")
    index = {name: each.value for name, each in found.total.items()}
    assert (found.method, found.first) == ("pawn", {})
    assert index["x1"] > 0.5 and index["x3"] < 0.24
    assert all(0.0 < each.half_width < 0.2 for each in found.total.values())


def test_what_cannot_be_measured_is_said():
    with pytest.raises(ConfigError, match="it depends on nothing that was varied"):
        sensitivities(sampled("sobol", 32, lambda x: np.ones(len(x))), "rms_distance_mm")
    with pytest.raises(ConfigError, match="at least 16 are needed"):
        sensitivities(sampled("sobol", 8), "rms_distance_mm")
    with pytest.raises(ConfigError, match="no factor of this campaign is sampled"):
        sensitivities(made_up({"law": {"form": "Listed"}}, {"run": np.arange(2)}, {"points": 0}), "rms_distance_mm")


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("robots.leader.trajectory.speed_mps", "leader trajectory speed [m/s]"),
        ("config.control.heading.gain_per_s", "heading gain [1/s]"),
        ("robots.robot1.camera.vibration_deg", "robot1 camera vibration [°]"),
        ("law", "law [-]"),
    ],
)
def test_a_factor_s_label_has_its_words_and_its_unit(name, label):
    assert factor_label(name) == label
    assert metric_label("rms_distance_mm") == "RMS distance error [mm]"

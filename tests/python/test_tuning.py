"""The search for a law's parameters: seeded, fair, and its result is a file that the coordinator reads."""

import sys

import numpy as np
import pytest
from synthetic_run import synthetic_run
from typer.testing import CliRunner

from pilotfish import coordinator, tuning
from pilotfish import data as shipped
from pilotfish.cli import app
from pilotfish.harness.driving import BASELINES, PROFILES


def config():
    return coordinator.load_coordinator(shipped.path("config/line.yaml")).coordinator


def test_the_cost_is_the_sum_of_its_units():
    """A steady run 20 mm too far and 1 degree off: 20/10 + 1/0.5 = 4; nothing jerks, overshoots or is blind."""
    time_s = np.arange(300) / 30.0
    run = synthetic_run(time_s, np.full(300, -0.020), np.full(300, np.radians(1.0)))
    assert tuning.cost(run, 2.0) == pytest.approx(4.0)


def test_what_happens_before_the_start_is_over_is_no_error_but_overshoot_counts_all_along():
    time_s = np.arange(300) / 30.0
    error_m = np.where(time_s < 2.0, 0.040, 0.0)
    assert tuning.cost(synthetic_run(time_s, error_m), 2.0) == pytest.approx(0.040 / 0.020)


@pytest.mark.parametrize("name", PROFILES + BASELINES)
def test_every_searched_parameter_is_one_of_the_coordinator_s_and_starts_inside_its_range(name):
    found = tuning.current_parameters(name)
    assert set(found) == set(tuning.search_ranges(name))
    for key, value in found.items():
        assert tuning.search_ranges(name)[key].low <= value <= tuning.search_ranges(name)[key].high, key


def test_a_search_repeats_with_its_seed_improves_on_the_start_and_is_read_back(tmp_path, monkeypatch):
    pytest.importorskip("optuna")
    monkeypatch.setattr(tuning, "PLAYED", {"line": (4.0, 2.0)})
    first, second = (tuning.tune("pbvs", trials=6, seed=3) for _ in range(2))
    assert first == second
    assert first.cost <= first.cost_before
    file = first.write(tmp_path / "pbvs.yaml")
    control = coordinator.apply_overrides(config().control, law="pbvs", tuning=file)
    for key, value in first.parameters.items():
        assert control.law_parameters("pbvs")[key.split(".")[1]] == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize("name", BASELINES)
def test_the_shipped_tunings_are_read_and_were_all_searched_alike(name):
    file = shipped.path(f"tuned/{name}.yaml")
    coordinator.apply_overrides(config().control, law=name, tuning=file)
    assert file.read_text().startswith(f"# Made by: pilotfish tune {name} --trials 250 --seed 1\n")


def test_a_tuning_says_where_it_comes_from_and_its_numbers_with_six_digits(tmp_path):
    found = tuning.Tuned(tuning.Driving("pid"), {"pid.bearing_kp": 1 / 3, "limits.max_linear_mps": 2.0}, 1.5, 2.5, 7, 3)
    assert found.write(tmp_path / "new" / "pid.yaml").read_text() == (
        "# Made by: pilotfish tune pid --trials 7 --seed 3\n"
        "# Cost 1.500, before 2.500 (see pilotfish.tuning).\n"
        "limits:\n  max_linear_mps: 2.0\npid:\n  bearing_kp: 0.333333\n"
    )


def test_a_tuning_of_something_else_is_refused_by_its_key(tmp_path):
    (tmp_path / "odd.yaml").write_text("pid: {distance_kp: 1.0}\nwings: {span_m: 2.0}\n")
    with pytest.raises(ValueError, match="wings"):
        coordinator.apply_overrides(config().control, law="pid", tuning=tmp_path / "odd.yaml")


def test_without_the_search_s_package_it_ends_with_69_and_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "optuna", None)  # as if it were not installed
    result = CliRunner().invoke(app, ["tune", "pid", "--trials", "1"])
    assert result.exit_code == 69
    assert "pip install" in result.output


def test_a_search_that_is_stopped_is_the_one_with_so_many_trials(monkeypatch):
    pytest.importorskip("optuna")
    monkeypatch.setattr(tuning, "PLAYED", {"line": (1.0, 0.5)})
    found = tuning.searching("pid", trials=100, seed=5)
    assert [next(found) for _ in range(3)][-1] == tuning.tune("pid", trials=3, seed=5)


@pytest.mark.parametrize("out", [True, False])
def test_ctrl_c_keeps_the_best_so_far_and_says_where(tmp_path, monkeypatch, out):
    pytest.importorskip("optuna")
    monkeypatch.setattr(tuning, "PLAYED", {"line": (1.0, 0.5)})
    costs = iter([5.0, 3.0, 4.0])

    def cost(self, parameters):
        if (value := next(costs, None)) is None:
            raise KeyboardInterrupt  # where Ctrl-C comes: in the middle of a trial
        return value

    monkeypatch.setattr(tuning.Trial, "__call__", cost)
    file = tmp_path / "pid.yaml"
    result = CliRunner().invoke(app, ["tune", "pid", "--trials", "9", *(["--out", str(file)] if out else [])])
    assert result.exit_code == 130
    assert "stopped after 3 of 9 trials" in result.output
    assert "cost 5.000 -> 3.000" in result.output
    assert "Trial" not in result.output  # Optuna has no say
    if out:
        assert f"wrote {file}: the best of 3" in result.output
        assert file.read_text().startswith(
            "# Made by: pilotfish tune pid --trials 3 --seed 1\n# Cost 3.000, before 5.000"
        )
    else:
        assert "nothing is written: there is no --out" in result.output


@pytest.mark.parametrize("costs", [[5.0, 6.0, 7.0], [5.0]])
def test_a_search_that_found_nothing_better_says_so(tmp_path, monkeypatch, costs):
    pytest.importorskip("optuna")
    monkeypatch.setattr(tuning, "PLAYED", {"line": (1.0, 0.5)})
    left, count = iter(costs), len(costs)
    monkeypatch.setattr(tuning.Trial, "__call__", lambda self, parameters: next(left))
    file = tmp_path / "pid.yaml"
    result = CliRunner().invoke(app, ["tune", "pid", "--trials", str(count), "--out", str(file)])
    assert result.exit_code == 0
    assert f"cost 5.000, with the values it began with: none of {count} was better" in result.output
    assert "->" not in result.output and "the best" not in result.output
    assert f"wrote {file}: none of {count} was better; the file has the values it began with" in result.output


def test_ctrl_c_before_the_first_trial_has_ended_writes_nothing(tmp_path, monkeypatch):
    pytest.importorskip("optuna")
    monkeypatch.setattr(tuning, "searching", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    result = CliRunner().invoke(app, ["tune", "pid", "--out", str(tmp_path / "pid.yaml")])
    assert result.exit_code == 130
    assert "stopped after 0 of 200 trials; nothing is written" in result.output
    assert list(tmp_path.iterdir()) == []

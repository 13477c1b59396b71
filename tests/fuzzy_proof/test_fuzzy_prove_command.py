"""``pilotfish fuzzy prove``: the shipped file proved, broken ones refuted, a counterexample replayed."""

import json
import re

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from pilotfish import data, fuzzy
from pilotfish.cli import app
from pilotfish.fuzzy_proof.enclosure import Encloser
from pilotfish.fuzzy_proof.facts import prove_sign
from pilotfish.fuzzy_proof.jumps import prove_continuity
from pilotfish.fuzzy_proof.pieces import surface_of
from pilotfish.fuzzy_proof.proof import corners_of_pieces, prove
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.scenario import Scenario

SHIPPED = data.path("fuzzy/coordination.yaml")


def run(*arguments):
    """Exit code, what is printed with one space for all white, and standard output alone."""
    result = CliRunner().invoke(app, ["fuzzy", "prove", *(str(argument) for argument in arguments)])
    plain = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    return result.exit_code, re.sub(r"[\s│┃]+", " ", plain), result.stdout


@pytest.fixture(scope="module")
def controller():
    return fuzzy.load_controller(SHIPPED)


@pytest.fixture(scope="module")
def proof(controller):
    return prove(controller)


@pytest.fixture(scope="module")
def samples(controller):
    """u over a dense grid that has the corners of all sets on it: (e, ec, u[e, ec])."""
    e, ec = np.linspace(-1, 1, 1001), np.linspace(-1, 1, 501)
    grid = np.meshgrid(e, ec, indexing="ij")
    return e, ec, fuzzy.infer_outputs(controller, *(x.ravel() for x in grid)).reshape(grid[0].shape)


def broken(folder, change):
    content = yaml.safe_load(SHIPPED.read_text())
    change(content)
    file = folder / "broken.yaml"
    file.write_text(yaml.safe_dump(content, sort_keys=False))
    return file


def test_the_shipped_file_is_proved(proof):
    assert proof.statements == dict.fromkeys(proof.statements, True)
    assert proof.holds
    assert json.loads(json.dumps(proof.as_dict(), allow_nan=False))["invariant"]["holds"] is True


def test_no_sample_is_beyond_the_proved_range_and_the_range_is_tight(proof, samples):
    u = samples[2]
    assert proof.range.low.bound <= proof.range.low.reached
    assert proof.range.low.bound <= u.min()
    assert proof.range.low.bound == pytest.approx(-0.75 - 0.5 / 3, abs=2e-4)  # NB alone
    assert u.max() <= proof.range.high.bound
    # 0.75 + 2/3 of 0.25: the centroid of PB alone (see the file)
    assert proof.range.high.bound == pytest.approx(0.75 + 0.5 / 3, abs=2e-4)


def test_no_difference_quotient_of_samples_is_beyond_the_lipschitz_constants(proof, samples):
    e, ec, u = samples
    for axis, values, steepest in ((0, e, proof.steepest_e), (1, ec, proof.steepest_ec)):
        quotient = np.abs(np.diff(u, axis=axis)).max() / np.diff(values)[0]
        assert quotient <= steepest.bound
        assert quotient > 0.8 * steepest.bound
        assert steepest.reached <= steepest.bound <= 1.02 * steepest.reached


def test_beyond_the_proved_x_no_sample_has_the_wrong_sign_and_just_before_it_one_has(proof, samples):
    # In row PZ, NB says PS where PS says NS: they balance where mu_PZ = mu_PS, (0.3 - e)/0.28 = e/0.3, e = 0.15517.
    balance = 0.09 / 0.58
    e, _, u = samples
    for x, wrong in ((proof.too_close, u > 1e-6), (proof.too_far, (u < -1e-6)[::-1])):
        assert x.bound == pytest.approx(balance, abs=2e-4)
        assert not wrong[e >= x.bound].any()
        assert wrong[(e > balance - 0.01) & (e < balance)].any()


def signs_of(law):
    """What is proved of the signs alone: (too close, too far)."""
    surface = surface_of(law)
    encloser, vertices = Encloser(surface), corners_of_pieces(surface)
    return [prove_sign(encloser, vertices, 1e-4, too_close=close) for close in (True, False)]


def forward_at_the_end(law):
    law["rules"].update(PB=["PB"] * 7)


def forward_at_the_end_of_a_small_universe(law):
    """All of E is 0.4 times as large: it ends before the 0.5 of --sign-within."""
    forward_at_the_end(law)
    law["E"]["universe"] = [-0.4, 0.4]
    for shape in law["E"]["terms"].values():
        for kind, corners in shape.items():
            shape[kind] = [0.4 * corner for corner in corners]


@pytest.mark.parametrize("change", [forward_at_the_end, forward_at_the_end_of_a_small_universe])
def test_a_law_that_drives_towards_the_leader_at_the_end_of_its_universe_has_no_x(tmp_path, change):
    """Inputs beyond the universe count as its end, so u is wrong for every e from there on: nothing can be proved,
    whatever --sign-within says."""
    law = fuzzy.load_controller(broken(tmp_path, change))
    assert fuzzy.infer(law, 2.0, 0.0).output > 0.5
    too_close, too_far = signs_of(law)
    assert too_close.bound == np.inf
    assert too_far.bound < 0.2  # the other side is as ever


def test_at_the_proved_x_itself_the_sign_is_right_where_the_last_wrong_one_is_at_a_vertical_side(tmp_path):
    """PM ends with a vertical side at 0.5, which belongs to it and where u is positive; beyond, PB alone holds."""

    def change(law):
        inf = float("inf")
        law["E"]["terms"].update(PM={"trapezoid": [0.3, 0.4, 0.5, 0.5]}, PB={"trapezoid": [0.45, 0.8, inf, inf]})
        law["rules"].update(PM=["PB"] * 7)

    law = fuzzy.load_controller(broken(tmp_path, change))
    too_close, _ = signs_of(law)
    ec = np.linspace(-1, 1, 201)
    assert fuzzy.infer_outputs(law, np.full_like(ec, 0.5), ec).max() > 1e-6
    assert 0.5 < too_close.bound < 0.501
    assert fuzzy.infer_outputs(law, np.full_like(ec, too_close.bound), ec).max() <= 1e-6


def test_no_sampled_rise_along_e_is_beyond_the_proved_one(proof, samples):
    u = samples[2]
    rise = (u - np.minimum.accumulate(u, axis=0)).max()
    assert 0.03 < rise <= proof.greatest_rise.bound < 1.5 * rise


def test_a_broken_rule_is_not_proved_and_its_counterexample_replays_in_the_simulator(tmp_path):
    file = broken(tmp_path, lambda law: law["rules"].update(PB=["PB"] * 7))
    scenario = tmp_path / "out" / "crash.yaml"
    code, said, _ = run(file, "--counterexample", scenario)
    assert code == 1
    assert "not proved never towards a leader that is too close" in said
    assert "not proved the distance never falls below 0.4 m" in said
    begins_m = float(re.search(r"counterexample: from rest at ([\d.]+) m behind a leader that stands", said)[1])
    assert "--profile paper" in said
    # Rendered pictures, real detection, the real coordinator with its guard as low as the camera sees.
    recording = run_in_process(Scenario.load(scenario), profile="paper").recordings["robot1"]
    assert recording.true_distance_m[0] == pytest.approx(begins_m, abs=0.005)
    assert begins_m > 0.41
    assert recording.true_distance_m.min() < 0.35
    assert set(recording.status[3:]) == {"tracking"}


def test_a_vertical_side_is_shown_by_a_pair_of_neighbouring_inputs(tmp_path):
    sets = {"NM": {"triangle": [-0.8, -0.5, -0.5]}, "NS": {"trapezoid": [-0.5, -0.5, -0.3, 0.0]}}
    file = broken(tmp_path, lambda law: law["E"]["terms"].update(sets))
    law = fuzzy.load_controller(file)
    continuity = prove_continuity(law)
    assert not continuity.proved
    (jump,) = continuity.jumps
    one, other = (fuzzy.infer(law, *inputs).output for inputs in (jump.one, jump.other))
    assert abs(jump.one[0] - jump.other[0]) < 1e-15
    assert other - one == pytest.approx(jump.change)
    assert abs(jump.change) > 0.05


def test_a_gaussian_is_refused_with_its_place(tmp_path):
    file = broken(tmp_path, lambda law: law["U"]["terms"].update(ZE={"gaussian": {"mean": 0.0, "sigma": 0.2}}))
    code, said, _ = run(file)
    assert code == 78
    assert "U.terms.ZE: a Gaussian cannot be proved about" in said


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--help"], 0, "pilotfish fuzzy prove data/fuzzy/coordination.yaml"),
        (["nowhere.yaml"], 66, "nowhere.yaml"),
        ([SHIPPED, "--noise-m", "nan"], 64, "nan is not a number from 0 to 1 m"),
        ([SHIPPED, "--lag-s", "-1"], 64, "-1.0 is not a number from 0 to 1 s"),
        ([SHIPPED, "--setpoint-m", "0.3"], 64, "setpoint_m: 0.3 is below stop_distance_m (0.4)"),
        ([SHIPPED, "--counterexample", "crash.txt"], 64, "does not end in .yaml"),
        ([SHIPPED, "--counterexample", SHIPPED], 74, "is what is read"),
        ([SHIPPED, "--config", SHIPPED], 78, "coordination.yaml"),
    ],
)
def test_a_wrong_command_line_ends_at_once_and_says_why(arguments, code, words):
    ended, said, _ = run(*arguments)
    assert ended == code
    assert words in said
    assert "Traceback" not in said


def test_a_configuration_gives_the_numbers_and_an_option_wins():
    from pilotfish.cli.fuzzy_prove import _model

    model = _model(data.path("config/circle.yaml"), {"noise_m": 0.001})
    assert (model.setpoint_m, model.noise_m) == (0.65, 0.001)
    assert model.period_s == pytest.approx(1 / 30)
    assert model.error_change_scale_m == pytest.approx(0.05)


def test_a_configuration_with_a_headway_is_refused(tmp_path):
    """Its setpoint changes with the leader's speed, so the proof would be of another law."""
    text = data.path("config/circle.yaml").read_text().replace("../", f"{data.root()}/")
    assert "control:\n" in text
    config = tmp_path / "robot.yaml"
    config.write_text(text.replace("control:\n", "control:\n  spacing: {headway_s: 0.3}\n", 1))
    code, said, _ = run(SHIPPED, "--config", config)
    assert code == 78
    assert "control.spacing.headway_s is 0.3; the proof is of a setpoint that does not change" in said

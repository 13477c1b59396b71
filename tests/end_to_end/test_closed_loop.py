"""Both experiments of the source paper, closed over the real programs in lock-step."""

import math
import subprocess

import numpy as np
import pytest

from pilotfish import coordinator, fuzzy
from pilotfish import data as shipped
from pilotfish.experiments import CIRCLE, LINE, run_experiment
from pilotfish.harness.executables import SIM, find_executable
from pilotfish.harness.over_lcm import run_over_lcm
from pilotfish.harness.scenario import Scenario

LEADER_SPEED_MPS = 0.2
CIRCLE_RADIUS_M = 1.0


def steady_state(config_name, leader_turn_rate):
    """(error_m, bearing_rad) at which the paper's law holds still relative to the leader.

    In a steady state the coordinator turns with the leader, w = gain (theta - theta_pd), so theta = theta_pd + w/gain,
    and drives v = V u(e/E, 0). On a line w = 0 and v is the leader's speed. On a circle both run round one centre,
    which lies r = v/w to the left of the coordinator, at (0, r) in its base frame, and the leader at (d cos, d sin):

        R^2 = (d cos theta)^2 + (r - d sin theta)^2   =>   r = d sin theta + sqrt(R^2 - (d cos theta)^2)
    """
    config = coordinator.load_coordinator(str(shipped.path(f"config/{config_name}.yaml"))).coordinator
    velocity, setpoint = config.control.velocity, config.setpoint
    bearing = setpoint.bearing_rad + leader_turn_rate / config.control.heading.gain_per_s

    def surplus(error_m):
        """How much faster the law drives than it would have to."""
        u = fuzzy.infer(config.control.law, error_m / velocity.error_scale_m, 0.0).output
        if leader_turn_rate == 0.0:
            needed = LEADER_SPEED_MPS
        else:
            d = setpoint.distance_m - error_m
            r = d * math.sin(bearing) + math.sqrt(CIRCLE_RADIUS_M**2 - (d * math.cos(bearing)) ** 2)
            needed = leader_turn_rate * r
        return velocity.velocity_scale_mps * u - needed

    # Too far: faster than needed; too close: slower. On the circle no chord is longer than R / cos theta.
    low, high = -0.6 * setpoint.distance_m, 0.0
    if leader_turn_rate != 0.0:
        low = max(low, setpoint.distance_m - 0.999 * CIRCLE_RADIUS_M / math.cos(bearing))
    assert surplus(low) > 0 > surplus(high)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if surplus(middle) > 0 else (low, middle)
    return (low + high) / 2, bearing


@pytest.fixture(scope="module")
def line():
    return run_experiment(LINE, "paper", "lcm")


@pytest.fixture(scope="module")
def circle():
    return run_experiment(CIRCLE, "paper", "lcm")


def last_quarter(values):
    return np.asarray(values)[-len(values) // 4 :]


def test_on_the_line_the_distance_settles_where_the_law_says(line):
    expected_m, _ = steady_state("line", 0.0)
    assert expected_m < -0.02, "the paper's law has a steady-state error behind a moving leader, or this tests nothing"
    error_m = line.recording.meta.distance_setpoint_m - last_quarter(line.recording.true_distance_m)
    assert np.abs(error_m - expected_m).max() < 0.05


def test_on_the_line_the_bearing_is_held_within_one_degree(line):
    error_deg = np.degrees(last_quarter(line.recording.true_bearing_rad)) - (-10.0)
    assert np.abs(error_deg).max() < 1.0


def test_on_the_circle_distance_and_bearing_settle_where_the_law_says(circle):
    expected_m, expected_bearing = steady_state("circle", LEADER_SPEED_MPS / CIRCLE_RADIUS_M)
    error_m = circle.recording.meta.distance_setpoint_m - last_quarter(circle.recording.true_distance_m)
    assert np.abs(error_m - expected_m).max() < 0.05
    bearing_deg = np.degrees(last_quarter(circle.recording.true_bearing_rad))
    assert np.abs(bearing_deg - math.degrees(expected_bearing)).max() < 1.0


@pytest.mark.parametrize(("name", "initial_m"), [("line", 2.44), ("circle", 1.96)])
def test_it_starts_where_the_paper_starts_and_never_loses_the_leader(name, initial_m, request):
    recording = request.getfixturevalue(name).recording
    assert recording.true_distance_m[0] == pytest.approx(initial_m, abs=0.005)
    assert np.mean(np.isfinite(recording.measured_distance_m)) > 0.99


def test_a_run_in_lock_step_repeats_bit_for_bit(line):
    again = run_over_lcm(Scenario.load(shipped.path("scenarios/line.yaml")), profile="paper", duration_s=3.0)
    recording = again.recordings[line.recording.meta.robot]
    count = len(recording.time_s)
    assert count == 90
    for column in (
        "x_m",
        "y_m",
        "heading_rad",
        "command_linear_mps",
        "command_angular_radps",
        "true_distance_m",
    ):
        assert np.array_equal(getattr(recording, column), getattr(line.recording, column)[:count]), column


def test_the_programs_and_the_same_code_in_one_process_give_the_same_run(line):
    inside = run_experiment(LINE, "paper", "in-process", duration_s=3.0).recording
    count = len(inside.time_s)
    assert np.array_equal(inside.command_linear_mps, line.recording.command_linear_mps[:count])
    assert np.array_equal(inside.true_distance_m, line.recording.true_distance_m[:count])


@pytest.mark.parametrize("name", ["star", "chain"])
def test_several_coordinators_follow_at_once(name):
    run = run_over_lcm(Scenario.load(shipped.path(f"scenarios/{name}.yaml")), profile="paper", duration_s=6.0)
    assert len(run.recordings) == 2
    for recording in run.recordings.values():
        assert np.mean(np.isfinite(recording.measured_distance_m)) > 0.9
        assert recording.linear_mps[-1] > 0.05


def test_the_simulator_gives_up_with_a_reason_when_nobody_answers(tmp_path):
    from pilotfish.harness.ports import private_lcm_url

    command = [
        str(find_executable(SIM)),
        "--scenario",
        str(shipped.path("scenarios/line.yaml")),
        "--lockstep",
    ]
    done = subprocess.run(
        [*command, "--lcm-url", private_lcm_url(), "--wait-s", "0.5"],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 70
    assert "robot1" in done.stderr

"""Profile `anticipate` in closed loop. Most runs draw their measurements (a second each instead of a minute), with ten
times the noise that rendered pictures were measured to have; one run renders."""

import numpy as np
import pytest

from pilotfish import core
from pilotfish import data as shipped
from pilotfish.experiments import CIRCLE, LINE, run_experiment
from pilotfish.harness.drawn_observations import DrawnObservations, ObservationNoise
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.scenario import Scenario
from pilotfish.metrics import evaluate
from scenes import scenario_with

# v (latency + lag) + v^2 / 2a for 0.2 m/s, one frame, 0.1 s and 1 m/s2: what no law can help.
PHYSICAL_LIMIT_M = 0.2 * (1 / 30 + 0.1) + 0.2**2 / 2

# What libapriltag's own corners gave before the whole print was fitted; a real camera and print are no better.
COARSE = ObservationNoise(distance_sigma_per_m=0.25e-3, bearing_sigma_rad=1.0e-4, heading_sigma_rad_per_m=0.7e-3)


def played(which, profile="anticipate", seed=1, duration_s=None, spec=None, configure=None, feed=None):
    scenario = Scenario.load(shipped.path(f"scenarios/{which}.yaml"))
    drawn = DrawnObservations(seed, COARSE)
    run = run_in_process(
        scenario, profile=profile, spec=spec, configure=configure, drawn=drawn, feed=feed, duration_s=duration_s
    )
    return run.recordings["robot1"]


@pytest.mark.parametrize("seed", range(1, 6))
@pytest.mark.parametrize(("which", "bearing_deg"), [("line", 0.1), ("circle", 0.2)])
def test_behind_a_steady_leader_it_stands_within_two_millimetres_and_settles_in_four_seconds(which, bearing_deg, seed):
    figures = evaluate(played(which, seed=seed))
    assert abs(figures.steady_state_error_m) < 0.002
    assert figures.rms_error_m < 0.005
    assert figures.rms_bearing_error_deg < bearing_deg
    assert figures.settling_time_s < 4.0
    assert figures.overshoot_m < 0.020


@pytest.mark.parametrize("experiment", [LINE, CIRCLE], ids=["line", "circle"])
def test_on_rendered_pictures_the_error_is_far_below_the_published_law_s_and_so_is_the_jerk(experiment):
    """Eight seconds that begin at the paper's distance: anticipation ends at zero where the law as published still
    stands a tenth of a metre off, and is kinder to the wheels: the top speed is approached without a jolt, which leaves
    braking at the limit of 1 m/s^2, one frame of 30 m/s^3."""
    published, anticipated = (
        run_experiment(experiment, profile, "in-process", duration_s=8.0) for profile in ("paper", "anticipate")
    )
    assert abs(published.metrics.steady_state_error_m) > 0.05
    assert abs(anticipated.metrics.steady_state_error_m) < 0.005
    assert anticipated.metrics.overshoot_m < 0.020
    assert anticipated.metrics.rms_jerk_mps3 < published.metrics.rms_jerk_mps3


@pytest.mark.parametrize("seed", range(1, 6))
def test_when_the_leader_stops_dead_it_comes_no_closer_than_physics_and_a_tenth_and_returns_without_overshooting(seed):
    run = played("stop_dead", seed=seed)
    error_m = run.distance_error_m[run.time_s >= 10.0]
    assert error_m.max() < 1.1 * PHYSICAL_LIMIT_M
    assert error_m[np.argmax(error_m) :].min() > -0.020
    assert abs(error_m[-1]) < 0.002


@pytest.mark.parametrize("which", ["start", "reverse", "figure_eight", "square"])
def test_whatever_the_leader_does_it_never_leaves_the_picture(which):
    run = played(which)
    assert np.all(run.status == "tracking")
    assert np.abs(run.distance_error_m[run.time_s >= 3.0]).max() < 0.05


def test_while_the_leader_is_hidden_it_stands_still_after_100_ms_and_then_catches_up_within_three_seconds():
    run = played("occlusion")
    hidden = (run.time_s > 15.1) & (run.time_s < 15.99)
    assert hidden.sum() > 20
    assert np.all(run.command_linear_mps[hidden] == 0.0) and np.all(run.command_angular_radps[hidden] == 0.0)
    assert np.all(run.status[run.time_s > 16.01] == "tracking")
    assert np.abs(run.distance_error_m[run.time_s > 19.0]).max() < 0.05


def wrong_drive_model(config):
    config.control.drive.actuator_lag_s = 0.15  # the robot's is 0.1 s
    config.control.drive.latency_s = 0.0


@pytest.mark.parametrize("which", ["line", "circle"])
def test_a_wrong_model_of_the_own_drive_leaves_no_steady_state_error(which):
    """In the steady state commands do not change, so neither latency nor lag counts; on the way it
    costs some overshoot."""
    figures = evaluate(played(which, configure=wrong_drive_model))
    assert abs(figures.steady_state_error_m) < 0.002
    assert figures.overshoot_m < 0.05


def slow_wheels(which):
    """A robot whose wheels do 0.35 m/s at most."""
    return scenario_with(which, "drive", max_linear_mps=0.35)


def test_wheels_that_cannot_do_what_is_commanded_only_cost_time():
    """Commanded 0.6 m/s they reach 0.35 m/s: dead reckoning is wrong all the way, and right at the leader's speed."""
    figures = evaluate(played("line", spec=slow_wheels("line")))
    assert abs(figures.steady_state_error_m) < 0.002


def feed_odometry(world, robot, driver):
    driver.set_ego_motion(world.utime, world.state(robot).twist)


@pytest.mark.parametrize("which", ["line", "circle"])
def test_odometry_tells_a_coordinator_with_the_right_model_of_its_drive_nothing_new(which):
    """What remains is that the wheels' curve between two twists is taken for the model's plus a straight line."""
    run, without = played(which, feed=feed_odometry), played(which)
    assert np.abs(run.true_distance_m - without.true_distance_m).max() < 1e-4


def test_with_odometry_wheels_that_cannot_do_what_is_commanded_do_not_make_it_overshoot():
    """Commanded 0.6 m/s they reach 0.35: by its commands alone the robot overestimates its speed and the leader's."""
    without, run = (played("line", spec=slow_wheels("line"), feed=feed) for feed in (None, feed_odometry))
    assert without.distance_error_m.max() > 0.02
    assert run.distance_error_m.max() < 0.002


def test_with_odometry_a_drive_that_brakes_at_less_than_half_the_rate_it_is_thought_to_does_not_make_it_swing():
    """At 0.4 instead of 1 m/s2, commands alone lead to a swing that never ends; with odometry the stop is over after
    the one braking distance that is not configured: v^2 / 2a = 0.2^2 / 0.8 = 50 mm and v times the delay of 0.13 s,
    27 mm.
    """
    spec = {"max_linear_acceleration_mps2": 0.4}
    runs = [scenario_with("stop_dead", "drive", **spec) for _ in range(2)]
    without, run = (played("stop_dead", spec=s, feed=t) for s, t in zip(runs, (None, feed_odometry), strict=True))
    last_second = run.time_s > run.time_s[-1] - 1.0
    assert np.abs(without.distance_error_m).max() > 0.2
    assert np.abs(without.distance_error_m[last_second]).max() > 0.02
    assert run.distance_error_m.max() < 1.1 * (0.05 + 0.2 * (1 / 30 + 0.1))
    assert np.abs(run.distance_error_m[last_second]).max() < 0.002


def test_odometry_that_falls_silent_leaves_it_as_good_as_it_is_without():
    def until_three_seconds(world, robot, driver):
        if world.time_s < 3.0:
            feed_odometry(world, robot, driver)

    figures = evaluate(played("line", feed=until_three_seconds))
    assert abs(figures.steady_state_error_m) < 0.002
    assert figures.overshoot_m < 0.020


def test_odometry_that_measures_two_percent_too_much_costs_a_millimetre():
    """The robot thinks that it drives at 1.02 v, and that so does the leader: the law must ask for the difference of
    4 mm/s, and its slope about zero is some 4 (mm/s)/mm."""

    def two_percent_too_much(world, robot, driver):
        twist = world.state(robot).twist
        driver.set_ego_motion(
            world.utime, core.Twist(linear_mps=1.02 * twist.linear_mps, angular_radps=1.02 * twist.angular_radps)
        )

    assert 0.0005 < evaluate(played("line", feed=two_percent_too_much)).steady_state_error_m < 0.0015


def test_the_same_seed_gives_the_same_run_bit_for_bit():
    first, second = played("circle", duration_s=5.0), played("circle", duration_s=5.0)
    assert np.array_equal(first.command_linear_mps, second.command_linear_mps)
    assert np.array_equal(first.true_distance_m, second.true_distance_m)
    assert not np.array_equal(first.true_distance_m, played("circle", duration_s=5.0, seed=2).true_distance_m)

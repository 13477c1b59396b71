"""The distance that no law goes below: a leader that stops dead, or drives towards the robot."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import control, core, sim
from pilotfish.harness.driving import BASELINES
from pilotfish.harness.timed import Timing, run_timed

GUARD, LIMITS = control.GuardConfig(), control.LimitsConfig()
REACTION = control.Reaction(limits=LIMITS, delay_s=0.13)
LAWS = ("anticipate", "paper", *BASELINES)


def leader(distance_m, sigma_m=0.0, radial_mps=0.0):
    motion = control.LeaderMotion()
    motion.distance_m, motion.distance_sigma_m, motion.radial_mps = distance_m, sigma_m, radial_mps
    return motion


@settings(derandomize=True)
@given(st.floats(0.6, 4.0), st.floats(0.0, 0.05), st.floats(-0.5, 0.5))
def test_from_the_guarded_speed_the_gap_stops_shrinking_at_d_min(distance_m, sigma_m, radial_mps):
    """With c the speed at which the leader comes, the robot goes on at v for the delay and then slows down to -c: the
    gap shrinks by (v + c) T + (v + c)^2 / 2a, which is the room there is."""
    speed_mps = control.guarded_speed(GUARD, REACTION, leader(distance_m, sigma_m, radial_mps))
    room_m = distance_m - GUARD.safety_sigmas * sigma_m - GUARD.minimum_distance_m
    shrinks_mps = speed_mps + max(-radial_mps, 0.0)
    lost_m = shrinks_mps * 0.13 + shrinks_mps**2 / (2 * LIMITS.max_linear_acceleration_mps2)
    assert lost_m == pytest.approx(room_m, abs=1e-12)


@settings(derandomize=True)
@given(st.floats(0.0, 0.4), st.floats(-0.5, 0.5))
def test_below_d_min_it_recedes_and_faster_the_less_there_is(distance_m, radial_mps):
    speed_mps = control.guarded_speed(GUARD, REACTION, leader(distance_m, radial_mps=radial_mps))
    assert speed_mps <= min(0.0, radial_mps)
    assert speed_mps <= control.guarded_speed(GUARD, REACTION, leader(distance_m + 0.01, radial_mps=radial_mps))


def test_the_guard_has_no_step_at_d_min():
    for radial_mps in (-0.3, 0.0, 0.3):
        below, above = (
            control.guarded_speed(GUARD, REACTION, leader(GUARD.minimum_distance_m + d, radial_mps=radial_mps))
            for d in (-1e-9, 1e-9)
        )
        assert below == pytest.approx(above, abs=1e-6)


def reversing(speed_mps):
    def change(spec):
        robots = spec.robots
        for robot in robots:
            if robot.name == "leader":
                profile = robot.trajectory.profile
                profile.speed_mps = -speed_mps
                robot.trajectory = sim.Line(profile)
        spec.robots = robots

    return change


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("speed_mps", [0.1, 0.2, 0.29])
def test_no_law_is_hit_by_a_leader_that_reverses_slower_than_the_robot_can(law, speed_mps):
    # It comes from 2.4 m at once, while the robot drives towards it at 0.6 m/s to keep 0.5 m, and may reverse at 0.3.
    # Without the guard, at 0.29 m/s: paper 0.35, pbvs 0.33, pid 0.17 m; the two robots are 0.4 m long together.
    def near(config):
        config.setpoint = core.Setpoint(distance_m=0.5)

    run = run_timed("line", law=law, change=reversing(speed_mps), configure=near)
    assert run.distance_m.min() > GUARD.minimum_distance_m - 0.005


@pytest.mark.parametrize("law", LAWS)
def test_no_law_goes_below_d_min_behind_a_leader_that_stops_dead_before_a_late_camera(law):
    run = run_timed("stop_dead", law=law, timing=Timing(latency_s=0.1))
    assert run.distance_m.min() > GUARD.minimum_distance_m

"""The drive against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import sim
from pilotfish.core import Twist

PROMPT = sim.DriveConfig(
    max_linear_acceleration_mps2=1000.0, max_angular_acceleration_radps2=10000.0, actuator_lag_s=0.0
)


def driven(drive, twist, duration_s, start=None):
    robot = sim.Unicycle(drive, start or sim.Pose2())
    robot.advance(twist, duration_s)
    return robot.state


def test_driving_straight_covers_speed_times_time():
    pose = sim.move_along_arc(sim.Pose2(x_m=1.0, y_m=2.0, heading_rad=math.pi / 6), Twist(linear_mps=0.5), 4.0)
    # 2 m at 30 degrees: (1 + 2 cos 30, 2 + 2 sin 30) = (1 + sqrt(3), 3)
    assert (pose.x_m, pose.y_m) == pytest.approx((1 + math.sqrt(3), 3.0))
    assert pose.heading_rad == pytest.approx(math.pi / 6)


def test_spinning_stays_in_place_and_wraps_the_heading():
    pose = sim.move_along_arc(sim.Pose2(), Twist(angular_radps=1.0), 4.0)
    assert (pose.x_m, pose.y_m) == (0.0, 0.0)
    assert pose.heading_rad == pytest.approx(4.0 - 2 * math.pi)


def test_a_quarter_of_a_circle_ends_a_radius_ahead_and_a_radius_to_the_left():
    # v / w = 2 m; w t = pi / 2
    pose = sim.move_along_arc(sim.Pose2(), Twist(linear_mps=1.0, angular_radps=0.5), math.pi)
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((2.0, 2.0, math.pi / 2))


@settings(derandomize=True, max_examples=200)
@given(st.floats(-2, 2), st.floats(-3, 3), st.floats(0, 3), st.floats(0, 3))
def test_an_arc_in_two_pieces_is_the_same_arc(v, w, first_s, second_s):
    twist = Twist(linear_mps=v, angular_radps=w)
    whole = sim.move_along_arc(sim.Pose2(), twist, first_s + second_s)
    halves = sim.move_along_arc(sim.move_along_arc(sim.Pose2(), twist, first_s), twist, second_s)
    assert (halves.x_m, halves.y_m) == pytest.approx((whole.x_m, whole.y_m), abs=1e-9)
    assert math.remainder(halves.heading_rad - whole.heading_rad, 2 * math.pi) == pytest.approx(0, abs=1e-9)


@settings(derandomize=True, max_examples=200)
@given(st.floats(-2, 2), st.floats(-1e-3, 1e-3))
def test_an_almost_straight_arc_is_no_worse_than_a_straight_one(v, w):
    # Taylor in w t: x = v t (1 - (w t)^2 / 6 + ...), y = v t (w t / 2 - (w t)^3 / 24 + ...)
    pose = sim.move_along_arc(sim.Pose2(), Twist(linear_mps=v, angular_radps=w), 1.0)
    assert pose.x_m == pytest.approx(v * (1 - w * w / 6), abs=1e-12)
    assert pose.y_m == pytest.approx(v * (w / 2 - w**3 / 24), abs=1e-12)


def test_the_speed_rises_with_the_acceleration_limit():
    drive = sim.DriveConfig(max_linear_acceleration_mps2=0.5, actuator_lag_s=0.0)
    # 0.4 m/s after 0.8 s and 0.16 m; then another 0.2 s at 0.4 m/s.
    state = driven(drive, Twist(linear_mps=0.4), 1.0)
    assert state.twist.linear_mps == pytest.approx(0.4)
    assert state.pose.x_m == pytest.approx(0.16 + 0.08, abs=1e-12)
    half_way = driven(drive, Twist(linear_mps=0.4), 0.4)
    assert half_way.twist.linear_mps == pytest.approx(0.2)
    assert half_way.pose.x_m == pytest.approx(0.04, abs=1e-12)


@pytest.mark.parametrize("time_s", [0.05, 0.1, 0.3, 1.0])
def test_behind_a_step_the_wheels_lag_exponentially(time_s):
    # A step of 0.4 m/s through tau = 0.1 s: v = 0.4 (1 - exp(-t / tau)), x = 0.4 (t - tau (1 - exp(-t / tau))).
    # The ramp to 0.4 m/s takes 0.4 ms at 1000 m/s2 and shifts that by half of it.
    drive = sim.DriveConfig(max_linear_acceleration_mps2=1000.0, actuator_lag_s=0.1)
    state = driven(drive, Twist(linear_mps=0.4), time_s)
    late_s = time_s - 0.0002
    assert state.twist.linear_mps == pytest.approx(0.4 * (1 - math.exp(-late_s / 0.1)), abs=1e-6)
    assert state.pose.x_m == pytest.approx(0.4 * (late_s - 0.1 * (1 - math.exp(-late_s / 0.1))), abs=1e-6)


def test_behind_a_ramp_the_wheels_lag_by_the_time_constant():
    # r = a t, so v = a (t - tau (1 - exp(-t / tau))) and x = a (t^2 / 2 - tau t + tau^2 (1 - exp(-t / tau))).
    a, tau, t = 0.3, 0.2, 1.5
    drive = sim.DriveConfig(max_linear_acceleration_mps2=a, actuator_lag_s=tau)
    state = driven(drive, Twist(linear_mps=0.6), t)
    settled = 1 - math.exp(-t / tau)
    assert state.twist.linear_mps == pytest.approx(a * (t - tau * settled), abs=1e-12)
    assert state.pose.x_m == pytest.approx(a * (t * t / 2 - tau * t + tau * tau * settled), abs=1e-12)


def test_commands_beyond_the_top_speeds_are_clamped():
    state = driven(PROMPT, Twist(linear_mps=-5.0, angular_radps=9.0), 1.0)
    assert state.twist.linear_mps == -0.6
    assert state.twist.angular_radps == 2.0


def test_a_turn_with_lag_agrees_with_a_fine_numerical_integration():
    drive = sim.DriveConfig(max_linear_acceleration_mps2=1.0, max_angular_acceleration_radps2=4.0, actuator_lag_s=0.1)
    state = driven(drive, Twist(linear_mps=0.5, angular_radps=1.5), 2.0)
    # Midpoint rule with a step of 10 us on the plain equations.
    dt = 1e-5
    t = (np.arange(200_000) + 0.5) * dt

    def lagged(top, a):
        rise, tau = top / a, 0.1
        ramp = a * (t - tau * (1 - np.exp(-t / tau)))
        at_top = a * (rise - tau * (1 - math.exp(-rise / tau)))
        return np.where(t < rise, ramp, top + (at_top - top) * np.exp(-(t - rise) / tau))

    v, w = lagged(0.5, 1.0), lagged(1.5, 4.0)
    heading = np.cumsum(w) * dt - w * dt / 2
    x, y = np.sum(v * np.cos(heading)) * dt, np.sum(v * np.sin(heading)) * dt
    assert (state.pose.x_m, state.pose.y_m) == pytest.approx((x, y), abs=1e-6)


@settings(derandomize=True, max_examples=50)
@given(st.floats(-1, 1), st.floats(-3, 3), st.floats(0.01, 0.5), st.floats(0.01, 0.5))
def test_the_speed_does_not_depend_on_how_the_time_is_cut(v, w, first_s, second_s):
    twist = Twist(linear_mps=v, angular_radps=w)
    whole, pieces = sim.Unicycle(sim.DriveConfig()), sim.Unicycle(sim.DriveConfig())
    whole.advance(twist, first_s + second_s)
    pieces.advance(twist, first_s)
    pieces.advance(twist, second_s)
    assert pieces.state.twist.linear_mps == pytest.approx(whole.state.twist.linear_mps, abs=1e-12)
    assert pieces.state.twist.angular_radps == pytest.approx(whole.state.twist.angular_radps, abs=1e-12)
    assert pieces.state.pose.x_m == pytest.approx(whole.state.pose.x_m, abs=1e-7)

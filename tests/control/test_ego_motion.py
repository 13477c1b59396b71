"""Where the robot has got to: by its own commands through the model of the drive, and by odometry if there is any."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import control, core, sim

PERIOD_US = 10_000
AS_MEASURED = control.DriveModelConfig(odometry_filter_s=0.0)
commanded, odometry = control.EgoMotionSource.commanded, control.EgoMotionSource.odometry


def twist(linear_mps=0.0, angular_radps=0.0):
    return core.Twist(linear_mps=linear_mps, angular_radps=angular_radps)


def moved(config=AS_MEASURED, at_utime=0):
    own = control.EgoMotion(config)
    own.advance_to(at_utime)
    return own


def test_between_two_measured_twists_the_robot_moved_with_their_mean():
    """Commanded to stand still, and 0.2 then 0.4 m/s were measured 0.1 s apart: 0.3 m/s * 0.1 s = 30 mm."""
    own = moved()
    for utime, speed in ((0, 0.2), (100_000, 0.4)):
        own.measured(utime + 1, twist(speed))
    own.advance_to(1)
    before_m = own.pose[0]
    own.advance_to(100_001)
    assert own.pose[0] - before_m == pytest.approx(0.030, abs=1e-9)
    assert own.twist.linear_mps == pytest.approx(0.4)
    assert own.source == odometry


def test_behind_the_last_measured_twist_the_model_s_error_stays_for_a_fifth_of_a_second():
    """Commanded to stand still, measured at 0.4 m/s: 40 mm in the next 0.1 s, 80 mm in 0.2 s, and then no more."""
    own = moved()
    own.measured(1, twist(0.4))
    for utime, x_m, speed in ((100_001, 0.04, 0.4), (200_000, 0.08, 0.4), (200_001, 0.08, 0.0), (900_000, 0.08, 0.0)):
        own.advance_to(utime)
        assert own.pose[0] == pytest.approx(x_m, abs=1e-6)
        assert own.twist.linear_mps == speed
    assert own.source == commanded


def test_what_is_commanded_while_odometry_is_under_way_counts_at_once():
    """Measured 0.1 m/s where the model stands still; then commanded 0.3 m/s, which both are faster by: the model's 0.3
    minus what ramp (0.3 s to 0.3 m/s) and lag leave, and 0.1 on top."""
    own, model = moved(), moved()
    own.measured(1, twist(0.1))
    for each in (own, model):
        each.advance_to(1)
        each.command(twist(0.3), 1)
        each.advance_to(150_000)
    assert own.twist.linear_mps == pytest.approx(model.twist.linear_mps + 0.1)


def test_two_measured_twists_too_far_apart_say_nothing_about_the_way_between_them():
    own = moved()
    own.measured(1, twist(0.4))
    own.measured(200_002, twist(0.4))  # 0.2 s is covered, a microsecond more is not
    own.advance_to(200_001)
    assert own.twist.linear_mps == 0.0
    own.advance_to(200_002)
    assert own.twist.linear_mps == 0.4
    assert own.pose[0] == pytest.approx(0.08, abs=1e-6)


def test_when_odometry_falls_silent_everything_is_soon_as_if_there_had_never_been_any():
    with_odometry, without = moved(), moved()
    for own in (with_odometry, without):
        own.command(twist(0.3, 0.5), 0)
    for k in range(1, 20):
        with_odometry.measured(k * PERIOD_US, twist(0.1))
    for own in (with_odometry, without):
        own.advance_to(1_200_000)
    assert with_odometry.source == commanded
    assert with_odometry.twist.linear_mps == pytest.approx(without.twist.linear_mps, abs=1e-4)
    assert with_odometry.twist.angular_radps == pytest.approx(without.twist.angular_radps, abs=1e-4)


@pytest.mark.parametrize("filter_s", [0.0, 0.1])
def test_measured_twists_show_the_way_of_wheels_that_do_something_else_than_commanded(filter_s):
    """Commanded 0.6 m/s they reach 0.35: after 2 s the commands alone are more than 0.3 m off. As measured, the way is
    right to what the straight lines between two twists leave, and with a filter of 0.1 s to 0.1 s times the 0.25 m/s
    by which the model comes to be wrong."""
    limited = sim.DriveConfig(max_linear_mps=0.35, command_timeout_s=0.0)
    robot, commanded = sim.Unicycle(limited), twist(0.6, 0.3)
    own, blind = moved(control.DriveModelConfig(odometry_filter_s=filter_s)), moved()
    for model in (own, blind):
        model.command(commanded, 0)
    for k in range(1, 201):
        robot.advance(commanded, PERIOD_US * 1e-6)
        assert own.measured(k * PERIOD_US, robot.state.twist)
        for model in (own, blind):
            model.advance_to(k * PERIOD_US)
    pose = robot.state.pose
    truth = np.array([pose.x_m, pose.y_m])
    assert np.hypot(*(truth - blind.pose[:2])) > 0.3
    assert np.hypot(*(truth - own.pose[:2])) < (0.025 + 0.001 if filter_s else 0.0005)


def test_a_filter_lets_a_quarter_of_the_noise_through_and_all_of_the_truth():
    """A first-order low-pass with T = 10 dt leaves dt / (2 T) = 5 % of white noise's variance: 22 % of its sigma."""
    random, own = np.random.default_rng(3), moved(control.DriveModelConfig(odometry_filter_s=0.1, actuator_lag_s=0.1))
    own.command(twist(0.3), 0)
    speeds = []
    for k in range(1, 1500):
        own.measured(k * PERIOD_US, twist(0.3 + 0.02 * random.standard_normal()))
        own.advance_to(k * PERIOD_US)
        speeds.append(own.twist.linear_mps)
    assert np.mean(speeds[200:]) == pytest.approx(0.3, abs=0.001)
    assert np.std(speeds[200:]) < 0.25 * 0.02


NO_TWISTS = [(math.nan, 0.0), (0.0, math.nan), (math.inf, 0.0), (0.0, -math.inf), (1e300, 0.0), (-1e300, 1e300)]
TOO_FAST = [(0.901, 0.0), (-0.901, 0.0), (0.0, 3.01), (0.0, -3.01)]


@pytest.mark.parametrize("bad", NO_TWISTS + TOO_FAST, ids=str)
def test_a_twist_that_is_no_number_or_faster_than_half_as_much_again_as_the_limits_is_refused(bad):
    """The limits are 0.6 m/s and 2 rad/s, and a push may add half of that."""
    own, same = moved(), moved()
    assert not own.measured(PERIOD_US, twist(*bad))
    for model in (own, same):
        model.advance_to(2 * PERIOD_US)
    assert own.pose == same.pose and own.source == commanded
    assert own.measured(3 * PERIOD_US, twist(0.899, 2.99))


def test_what_comes_late_twice_or_in_the_wrong_order_is_refused():
    own = moved(at_utime=1_000_000)
    assert not own.measured(1_000_000, twist(0.1))  # that time has been accounted for
    assert not own.measured(-5, twist(0.1))
    assert own.measured(1_020_000, twist(0.1))
    assert not own.measured(1_020_000, twist(0.2))
    assert not own.measured(1_010_000, twist(0.2))
    assert own.measured(1_030_000, twist(0.1))


def test_of_more_than_it_can_hold_the_oldest_are_forgotten():
    own = moved()
    assert all(own.measured(k * 1000, twist(0.2)) for k in range(1, 1001))
    own.advance_to(1_000_000)
    assert own.twist.linear_mps == 0.2
    # The last 64 ms were covered, and the model stood still before.
    assert own.pose[0] == pytest.approx(0.063 * 0.2, abs=1e-6)


@settings(derandomize=True, max_examples=200)
@given(
    st.lists(
        st.tuples(
            st.sampled_from(["command", "measured", "advance_to"]),
            st.integers(-(2**63), 2**63 - 1) | st.integers(0, 3_000_000),
            st.floats() | st.floats(-1.0, 1.0),
            st.floats() | st.floats(-3.0, 3.0),
        ),
        max_size=40,
    ),
    st.sampled_from([0.0, 0.1]),
)
def test_whatever_it_is_told_the_pose_and_the_twist_stay_finite(calls, filter_s):
    """At any times an int64 can say, in any order. What is commanded is finite and within the limits: the law's are."""
    own = control.EgoMotion(control.DriveModelConfig(odometry_filter_s=filter_s))
    for what, utime, linear_mps, angular_radps in calls:
        if what == "advance_to":
            own.advance_to(utime)
        elif what == "measured":
            own.measured(utime, twist(linear_mps, angular_radps))
        else:
            own.command(control.limit(control.LimitsConfig(), twist(linear_mps, angular_radps), twist(), 10.0), utime)
        assert np.isfinite([*own.pose, own.twist.linear_mps, own.twist.angular_radps]).all()
        # The model within its limits, and an error between a measured twist and it: 2 * 0.6 + 0.9, 2 * 2 + 3.
        assert abs(own.twist.linear_mps) <= 2.1 and abs(own.twist.angular_radps) <= 7.0

"""The heading controller, the limits, and the follower that joins them with the fuzzy law."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import ConfigError, control, core, fuzzy
from pilotfish import data as shipped

LAW = fuzzy.load_controller(str(shipped.path("fuzzy/coordination.yaml")))
LIMITS = control.LimitsConfig()
PERIOD_US = 33_333

speeds = st.floats(-2.0, 2.0)


def follower(profile=control.Profile.paper, **changes):
    return control.Follower(control.FollowerConfig(law=LAW, profile=profile, **changes))


def seen(utime, distance_m, bearing_rad=0.0):
    return core.Observation(utime=utime, distance_m=distance_m, bearing_rad=bearing_rad)


def test_a_leader_to_the_left_of_its_bearing_turns_the_robot_left():
    config = control.HeadingControllerConfig(gain_per_s=2.0)
    assert control.heading_turn_rate(config, bearing_rad=0.1, bearing_setpoint_rad=0.0) == pytest.approx(0.2)
    assert control.heading_turn_rate(config, bearing_rad=-0.1, bearing_setpoint_rad=0.0) == pytest.approx(-0.2)


def test_the_heading_controller_takes_the_short_way_round():
    config = control.HeadingControllerConfig(gain_per_s=1.0)
    # From -170 to +170 degrees the short way is 20 degrees to the right: theta - theta_pd = -340 = +20 (mod 360).
    rate = control.heading_turn_rate(config, math.radians(-170), math.radians(170))
    assert rate == pytest.approx(math.radians(20))


@settings(derandomize=True)
@given(speeds, speeds, speeds, speeds, st.floats(0.0, 0.2))
def test_a_limited_command_never_breaks_a_limit(v, w, v_before, w_before, dt_s):
    before = control.limit(LIMITS, core.Twist(linear_mps=v_before, angular_radps=w_before), core.Twist(), 10.0)
    now = control.limit(LIMITS, core.Twist(linear_mps=v, angular_radps=w), before, dt_s)
    assert -LIMITS.max_reverse_mps <= now.linear_mps <= LIMITS.max_linear_mps
    assert abs(now.angular_radps) <= LIMITS.max_angular_radps
    assert abs(now.linear_mps - before.linear_mps) <= LIMITS.max_linear_acceleration_mps2 * dt_s + 1e-12
    assert abs(now.angular_radps - before.angular_radps) <= LIMITS.max_angular_acceleration_radps2 * dt_s + 1e-12


@settings(derandomize=True)
@given(st.floats(-0.3, 0.6), st.floats(-2.0, 2.0))
def test_a_command_within_all_limits_is_left_alone(v, w):
    wanted = core.Twist(linear_mps=v, angular_radps=w)
    assert control.limit(LIMITS, wanted, wanted, 0.01) == wanted


def test_the_error_is_positive_when_the_leader_is_too_close():
    command = control.fuzzy_velocity(LAW, control.FuzzyVelocityConfig(), 1.1, 0.8, None, 0.0)
    assert command.error_m == pytest.approx(0.3)
    assert command.linear_mps < 0


def test_the_change_of_the_error_is_referred_to_the_control_period():
    """e rises by 0.02 m within two periods: per period that is 0.01 m, whatever the frames' spacing."""
    config = control.FuzzyVelocityConfig(control_period_s=0.04)
    command = control.fuzzy_velocity(LAW, config, 1.0, 0.98, 0.0, dt_s=0.08)
    assert command.error_change_m == pytest.approx(0.01)


def test_without_a_past_the_error_does_not_change():
    command = control.fuzzy_velocity(LAW, control.FuzzyVelocityConfig(), 1.0, 2.0, None, dt_s=0.0)
    assert command.error_change_m == 0.0


def test_the_follower_starts_from_rest_and_accelerates_within_its_limit():
    driver, setpoint = follower(), core.Setpoint(distance_m=1.1)
    first = driver.follow(seen(0, 2.44), setpoint)
    second = driver.follow(seen(PERIOD_US, 2.44), setpoint)
    step = LIMITS.max_linear_acceleration_mps2 / 30
    assert first.command.linear_mps == pytest.approx(step, rel=1e-3)
    assert second.command.linear_mps == pytest.approx(2 * step, rel=1e-3)


def test_after_a_restart_the_past_is_forgotten():
    driver, setpoint = follower(), core.Setpoint(distance_m=1.1)
    first = driver.follow(seen(0, 2.0), setpoint)
    for i in range(1, 30):
        driver.follow(seen(i * PERIOD_US, 2.0 - 0.02 * i), setpoint)
    driver.restart(since_utime=1_100_000)
    again = driver.follow(seen(10_000_000, 2.0), setpoint)
    assert again.command == first.command
    assert again.velocity.error_change_m == 0.0


@pytest.mark.parametrize("value", [math.nan, -1.0, 1e3])
def test_a_limit_out_of_range_is_refused_by_name_when_it_is_assigned_and_the_old_one_stays(value):
    limits = control.LimitsConfig(max_linear_mps=0.5)
    with pytest.raises(ConfigError, match=r"max_linear_mps: .* is outside \[0.01, 5\]") as refused:
        limits.max_linear_mps = value
    assert refused.value.key == "max_linear_mps"
    assert limits.max_linear_mps == 0.5

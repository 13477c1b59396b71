"""The peers: ViSP's visual servo and a PID, on numbers one can work out by hand."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import control, core, fuzzy
from pilotfish import data as shipped

LAW = fuzzy.load_controller(str(shipped.path("fuzzy/coordination.yaml")))
FREE = control.LimitsConfig(
    max_linear_mps=5.0, max_reverse_mps=5.0, max_linear_acceleration_mps2=20.0, max_angular_radps=20.0
)
PERIOD_US = 33_333


def follower(law, **config):
    limits = config.pop("limits", FREE)
    return control.Follower(control.FollowerConfig(law=LAW, active_law=law, limits=limits, **config))


def first_command(driver, distance_m, bearing_rad, setpoint):
    return driver.follow(
        core.Observation(utime=1_000_000, distance_m=distance_m, bearing_rad=bearing_rad), setpoint
    ).command


@settings(derandomize=True, deadline=None)
@given(st.floats(0.5, 1.5), st.floats(-0.3, 0.3), st.floats(0.5, 1.5), st.floats(-0.3, 0.3))
def test_the_visual_servo_lets_the_point_s_error_decay_with_its_gain(d, theta, d_pd, theta_pd):
    """A unicycle moves a fixed point (x, y) of its base frame by x' = -v + w y, y' = -w x. With (x, y)' = -lambda times
    the error: w = lambda (y - y_pd) / x and v = lambda (x - x_pd) + w y. The gain is constant here."""
    gain = 0.05
    constant = control.PbvsConfig(gain_at_zero=gain, gain_at_infinity=gain, slope_at_zero=0.0)
    driver = follower(control.Law.pbvs, pbvs=constant)
    command = first_command(driver, d, theta, core.Setpoint(distance_m=d_pd, bearing_rad=theta_pd))
    x, y = d * math.cos(theta), d * math.sin(theta)
    x_pd, y_pd = d_pd * math.cos(theta_pd), d_pd * math.sin(theta_pd)
    w = gain * (y - y_pd) / x
    assert command.angular_radps == pytest.approx(w, abs=1e-9)
    assert command.linear_mps == pytest.approx(gain * (x - x_pd) + w * y, abs=1e-9)


def test_the_visual_servo_s_gain_adapts_to_the_error():
    """ViSP: lambda(x) = (l0 - linf) exp(-slope x / (l0 - linf)) + linf of the greatest error component x. Straight
    ahead and 0.1 m too far, v = lambda 0.1."""
    config = control.PbvsConfig(gain_at_zero=2.5, gain_at_infinity=0.4, slope_at_zero=30.0)
    command = first_command(follower(control.Law.pbvs, pbvs=config), 1.1, 0.0, core.Setpoint(distance_m=1.0))
    gain = 2.1 * math.exp(-30.0 * 0.1 / 2.1) + 0.4
    assert command.linear_mps == pytest.approx(0.1 * gain, rel=1e-6)


def test_the_pid_is_the_sum_of_its_three_parts():
    """e = 0.1 m, then 0.12 m a period T later: u = kp e + ki sum(e T) + kd e', the derivative unfiltered."""
    config = control.PidConfig(distance_kp=1.0, distance_ki=0.5, distance_kd=0.2, derivative_filter_s=0.0)
    driver, setpoint = follower(control.Law.pid, pid=config), core.Setpoint(distance_m=1.0)
    first = first_command(driver, 1.1, 0.0, setpoint)
    seen = core.Observation(utime=1_000_000 + PERIOD_US, distance_m=1.12)
    second = driver.follow(seen, setpoint).command
    period = PERIOD_US * 1e-6
    assert first.linear_mps == pytest.approx(0.1 + 0.5 * 0.1 / 30)
    assert second.linear_mps == pytest.approx(0.12 + 0.5 * (0.1 / 30 + 0.12 * period) + 0.2 * 0.02 / period)


def test_behind_a_steady_leader_the_pid_has_no_standing_error_and_a_saturated_one_does_not_wind_up():
    """The plant is a pure integrator of relative speed; 2 m too far saturates the speed for seconds. Without clamping,
    the integral of 2 m over 4 s at 0.5 1/s^2 would drive on by metres."""
    limits = control.LimitsConfig()
    config = control.PidConfig(distance_kp=1.5, distance_ki=0.5, distance_kd=0.0)
    driver, setpoint = follower(control.Law.pid, pid=config, limits=limits), core.Setpoint(distance_m=1.0)
    distance_m, nearest_m = 3.0, 3.0
    for k in range(900):
        seen = core.Observation(utime=1_000_000 + k * PERIOD_US, distance_m=distance_m)
        command = driver.follow(seen, setpoint).command
        distance_m += (0.2 - command.linear_mps) * PERIOD_US * 1e-6
        nearest_m = min(nearest_m, distance_m)
    assert distance_m == pytest.approx(1.0, abs=1e-3)
    assert nearest_m > 0.9


@pytest.mark.parametrize("law", [control.Law.pbvs, control.Law.pid])
def test_a_peer_turns_towards_a_leader_on_its_left(law):
    command = first_command(follower(law), 1.0, 0.2, core.Setpoint(distance_m=1.0))
    assert command.angular_radps > 0.0


def test_a_law_that_is_not_there_is_refused_by_name(tmp_path):
    from pilotfish import coordinator

    text = shipped.path("config/line.yaml").read_text().replace("../", f"{shipped.path('.')}/")
    (tmp_path / "line.yaml").write_text(text + "law: bang_bang\n")
    with pytest.raises(ValueError, match="law: 'bang_bang' is not a law; choose fuzzy, pbvs or pid"):
        coordinator.load_coordinator(tmp_path / "line.yaml")

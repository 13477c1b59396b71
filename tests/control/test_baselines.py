"""The baselines: ViSP's visual servo and a PID, on numbers one can work out by hand."""

import math
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import ConfigError, control, core, fuzzy
from pilotfish import data as shipped

LAW = fuzzy.load_controller(str(shipped.path("fuzzy/coordination.yaml")))
FREE = control.LimitsConfig(
    max_linear_mps=5.0, max_reverse_mps=5.0, max_linear_acceleration_mps2=20.0, max_angular_radps=20.0
)
PERIOD_US = 33_333


def follower(law, parameters=None, limits=FREE, **sections):
    config = control.FollowerConfig(law=LAW, active_law=law, limits=limits, **sections)
    for key, value in (parameters or {}).items():
        config.set_law_parameter(law, key, value)
    return control.Follower(config)


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
    constant = {"gain_at_zero": gain, "gain_at_infinity": gain, "slope_at_zero": 0.0}
    driver = follower("pbvs", constant, guard=control.GuardConfig(minimum_distance_m=0.0))
    command = first_command(driver, d, theta, core.Setpoint(distance_m=d_pd, bearing_rad=theta_pd))
    x, y = d * math.cos(theta), d * math.sin(theta)
    x_pd, y_pd = d_pd * math.cos(theta_pd), d_pd * math.sin(theta_pd)
    w = gain * (y - y_pd) / x
    assert command.angular_radps == pytest.approx(w, abs=1e-9)
    assert command.linear_mps == pytest.approx(gain * (x - x_pd) + w * y, abs=1e-9)


def test_the_visual_servo_s_gain_adapts_to_the_error():
    """ViSP: lambda(x) = (l0 - linf) exp(-slope x / (l0 - linf)) + linf of the greatest error component x. Straight
    ahead and 0.1 m too far, v = lambda 0.1."""
    config = {"gain_at_zero": 2.5, "gain_at_infinity": 0.4, "slope_at_zero": 30.0}
    command = first_command(follower("pbvs", config), 1.1, 0.0, core.Setpoint(distance_m=1.0))
    gain = 2.1 * math.exp(-30.0 * 0.1 / 2.1) + 0.4
    assert command.linear_mps == pytest.approx(0.1 * gain, rel=1e-6)


def test_the_pid_is_the_sum_of_its_three_parts():
    """e = 0.1 m, then 0.12 m a period T later: u = kp e + ki sum(e T) + kd e', the derivative unfiltered."""
    config = {"distance_kp": 1.0, "distance_ki": 0.5, "distance_kd": 0.2, "derivative_filter_s": 0.0}
    driver, setpoint = follower("pid", config), core.Setpoint(distance_m=1.0)
    first = first_command(driver, 1.1, 0.0, setpoint)
    seen = core.Observation(utime=1_000_000 + PERIOD_US, distance_m=1.12)
    second = driver.follow(seen, setpoint).command
    period = PERIOD_US * 1e-6
    assert first.linear_mps == pytest.approx(0.1 + 0.5 * 0.1 / 30)
    assert second.linear_mps == pytest.approx(0.12 + 0.5 * (0.1 / 30 + 0.12 * period) + 0.2 * 0.02 / period)


def test_behind_a_steady_leader_the_pid_has_no_steady_state_error_and_a_saturated_one_does_not_wind_up():
    """The plant is a pure integrator of relative speed; 2 m too far saturates the speed for seconds. Without clamping,
    the integral of 2 m over 4 s at 0.5 1/s^2 would drive on by metres."""
    limits = control.LimitsConfig()
    config = {"distance_kp": 1.5, "distance_ki": 0.5, "distance_kd": 0.0}
    driver, setpoint = follower("pid", config, limits), core.Setpoint(distance_m=1.0)
    distance_m, nearest_m = 3.0, 3.0
    for k in range(900):
        seen = core.Observation(utime=1_000_000 + k * PERIOD_US, distance_m=distance_m)
        command = driver.follow(seen, setpoint).command
        distance_m += (0.2 - command.linear_mps) * PERIOD_US * 1e-6
        nearest_m = min(nearest_m, distance_m)
    assert distance_m == pytest.approx(1.0, abs=1e-3)
    assert nearest_m > 0.9


@pytest.mark.parametrize("law", ["pbvs", "pid"])
def test_a_baseline_turns_towards_a_leader_on_its_left(law):
    command = first_command(follower(law), 1.0, 0.2, core.Setpoint(distance_m=1.0))
    assert command.angular_radps > 0.0


def test_a_law_that_is_not_there_is_refused_by_name(tmp_path):
    from pilotfish import coordinator

    text = shipped.path("config/line.yaml").read_text().replace("../", f"{shipped.path('.')}/")
    (tmp_path / "line.yaml").write_text(text + "law: bang_bang\n")
    with pytest.raises(ValueError, match="law: 'bang_bang' is not a law; choose fuzzy, pbvs or pid"):
        coordinator.load_coordinator(tmp_path / "line.yaml")


class Bang:
    """Full speed ahead while too far, nothing else."""

    def __init__(self, parameters, limits):
        self.speed_mps, self.limits, self.restarts = parameters["speed_mps"], limits, 0

    def follow(self, observation, setpoint, dt_s):
        return core.Twist(linear_mps=self.speed_mps if observation.distance_m > setpoint.distance_m else 0.0)

    def restart(self):
        self.restarts += 1


SPEED = control.LawParameter("speed_mps", 0.3, min=0.0, max=1.0, text="speed while too far")


def with_law(make, **parameters):
    law = control.LawDescription(name="bang", text="on or off", parameters=[SPEED], make=make)
    config = control.FollowerConfig(law=LAW, limits=FREE, laws=[*control.built_in_laws(), law], active_law="bang")
    for key, value in parameters.items():
        config.set_law_parameter("bang", key, value)
    return config


@pytest.mark.parametrize(
    ("name", "owner"),
    [
        ("fuzzy", "is the fuzzy law"),
        ("pid", "comes with Pilotfish"),
        ("limits", "is a section of the configuration's `control`"),
    ],
)
def test_a_law_of_one_s_own_cannot_have_a_name_that_a_file_could_not_tell_from_another(name, owner):
    with pytest.raises(ConfigError, match=f"law: '{name}' {owner}; a law of your own needs another name") as refused:
        control.LawDescription(name=name, text="on or off", make=Bang)
    assert refused.value.key == "law"


def test_two_laws_of_one_name_are_refused_where_they_are_listed():
    law = control.LawDescription(name="bang", text="on or off", make=Bang)
    with pytest.raises(ConfigError, match="law: 'bang' is there twice"):
        control.FollowerConfig(law=LAW, laws=[law, law])
    config = control.FollowerConfig(law=LAW)
    with pytest.raises(ConfigError, match="law: 'bang' is there twice"):
        config.laws = [law, law]
    assert [each.name for each in config.laws] == [each.name for each in control.built_in_laws()]


def test_a_law_of_one_s_own_drives_with_its_parameters_and_is_told_to_restart():
    laws = []
    driver = control.Follower(with_law(lambda *given: laws.append(Bang(*given)) or laws[-1], speed_mps=0.25))
    assert first_command(driver, 1.1, 0.0, core.Setpoint(distance_m=1.0)).linear_mps == 0.25
    driver.restart(2_000_000)
    assert laws[0].restarts == 1
    assert laws[0].limits.max_linear_mps == FREE.max_linear_mps


def test_a_law_of_one_s_own_is_limited_like_every_other():
    limits = control.LimitsConfig(max_linear_mps=0.1, max_linear_acceleration_mps2=20.0)
    config = with_law(Bang)
    config.limits = limits
    assert first_command(control.Follower(config), 1.1, 0.0, core.Setpoint(distance_m=1.0)).linear_mps == 0.1


@pytest.mark.parametrize("answer", [1 / 1, "fast", None])
def test_a_law_that_answers_no_twist_makes_the_robot_stand_still(answer, monkeypatch):
    printed = []
    monkeypatch.setattr(sys, "unraisablehook", lambda about: printed.append(about.object))

    class Wrong(Bang):
        def follow(self, observation, setpoint, dt_s):
            return answer

    seen = core.Observation(utime=1_000_000, distance_m=1.1)
    output = control.Follower(with_law(Wrong)).follow(seen, core.Setpoint(distance_m=1.0))
    assert output.command == core.Twist()
    assert output.reason == core.Reason.law_not_finite
    assert printed == ["follow() of a law"]


def test_the_parameters_of_a_law_are_checked_when_they_are_set():
    config = with_law(Bang)
    with pytest.raises(ValueError, match=r"control.bang.speed_mps: 2 is outside \[0, 1\]"):
        config.set_law_parameter("bang", "speed_mps", 2.0)
    with pytest.raises(ValueError, match=r"control.bang.sped_mps: is not a parameter of this law"):
        config.set_law_parameter("bang", "sped_mps", 0.5)


@pytest.mark.parametrize("law", ["fuzzy", "pbvs", "pid", "bang"])
@pytest.mark.parametrize("profile", [control.Profile.paper, control.Profile.anticipate])
@pytest.mark.parametrize("bearing_deg", [90.0, -120.0, 180.0])
def test_a_leader_beside_or_behind_is_turned_to_and_not_driven_from(law, profile, bearing_deg):
    """d' = v_r - v cos(bearing): with cos <= 0, driving ahead leads away from a leader that is too far."""
    config = with_law(Bang)
    config.active_law, config.profile = law, profile
    command = first_command(control.Follower(config), 2.0, math.radians(bearing_deg), core.Setpoint(distance_m=1.0))
    assert command.linear_mps == 0.0

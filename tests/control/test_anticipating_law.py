"""Profile `anticipate`: closed forms of the unicycle, the guards, and the way back to the law as published."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pilotfish import control, core, fuzzy
from pilotfish import data as shipped

LAW = fuzzy.load_controller(str(shipped.path("fuzzy/coordination.yaml")))
PAPER, CONFIG, LIMITS = control.FuzzyVelocityConfig(), control.AnticipateConfig(), control.LimitsConfig()
VIEW = control.FieldOfView(right_rad=-0.49, left_rad=0.49)

distances, bearings, speeds = st.floats(0.3, 3.0), st.floats(-0.45, 0.45), st.floats(-0.4, 0.4)


def leader(distance_m=1.0, bearing_rad=0.0, radial_mps=0.0, tangential_mps=0.0, **other):
    motion = control.LeaderMotion()
    values = {"distance_m": distance_m, "bearing_rad": bearing_rad, "radial_mps": radial_mps}
    for key, value in {**values, "tangential_mps": tangential_mps, **other}.items():
        setattr(motion, key, value)
    return motion


def rates(motion, twist):
    """(d', theta') of a leader seen from a unicycle that drives `twist`, by moving both for a microsecond."""
    dt, d, theta = 1e-6, motion.distance_m, motion.bearing_rad
    line, across = np.array([math.cos(theta), math.sin(theta)]), np.array([-math.sin(theta), math.cos(theta)])
    there = d * line + (motion.radial_mps * line + motion.tangential_mps * across) * dt
    here = np.array([twist.linear_mps * dt, 0.0])
    seen, turned = there - here, twist.angular_radps * dt
    return (np.hypot(*seen) - d) / dt, (math.atan2(seen[1], seen[0]) - turned - theta) / dt


@settings(derandomize=True)
@given(distances, bearings, speeds, speeds)
def test_at_the_setpoint_the_command_keeps_distance_and_bearing_whatever_the_leader_does(d, theta, radial, tangential):
    """e = 0 and an own speed that already matches (ec = 0) give u = 0, so d' = theta' = 0."""
    motion = leader(d, theta, radial, tangential)
    own = core.Twist(linear_mps=radial / math.cos(theta))
    setpoint = core.Setpoint(distance_m=d, bearing_rad=theta)
    wanted = control.anticipate(LAW, PAPER, CONFIG, motion, own, setpoint).wanted
    assert rates(motion, wanted) == pytest.approx((0.0, 0.0), abs=1e-5)


@settings(derandomize=True)
@given(distances, bearings, st.floats(-0.2, 0.2), bearings)
def test_off_the_setpoint_the_distance_closes_at_the_law_s_speed_and_the_bearing_with_its_gain(
    d, theta, error_m, theta_pd
):
    """v = (v_r + u) / cos(theta) gives d' = -u; the bearing's rate is -gain (theta - theta_pd) at that speed."""
    assume(d - error_m > 0.06)
    motion = leader(d, theta, radial_mps=0.1, tangential_mps=0.05)
    setpoint = core.Setpoint(distance_m=d - error_m, bearing_rad=theta_pd)
    matching = core.Twist(linear_mps=0.1 / math.cos(theta))
    out = control.anticipate(LAW, PAPER, CONFIG, motion, matching, setpoint)
    d_rate, _ = rates(motion, out.wanted)
    assert d_rate == pytest.approx(-out.velocity.linear_mps, abs=1e-5)
    at_that_speed = core.Twist(linear_mps=matching.linear_mps, angular_radps=out.wanted.angular_radps)
    _, theta_rate = rates(motion, at_that_speed)
    assert theta_rate == pytest.approx(-CONFIG.heading_gain_per_s * (theta - theta_pd), abs=1e-5)


@settings(derandomize=True)
@given(distances, bearings, speeds, speeds, speeds)
def test_the_change_of_the_error_is_what_the_distance_loses_along_the_line_of_sight_in_a_control_period(
    d, theta, radial, tangential, own_mps
):
    """Of the own speed only v cos(theta) shortens the distance: d' from moving both bodies, and ec = -d' T."""
    motion, own = leader(d, theta, radial, tangential), core.Twist(linear_mps=own_mps, angular_radps=0.3)
    out = control.anticipate(LAW, PAPER, CONFIG, motion, own, core.Setpoint(distance_m=1.0))
    d_rate, _ = rates(motion, own)
    assert out.velocity.error_change_m == pytest.approx(-d_rate * PAPER.control_period_s, abs=1e-6)


def test_the_feed_forward_weight_is_one_half_at_its_sigma_and_falls_smoothly_to_nothing():
    sigmas = [0.0, CONFIG.half_weight_sigma_mps, 10.0, 1e9]
    trusts = [control.feed_forward_weight(CONFIG, leader(radial_sigma_mps=sigma)) for sigma in sigmas]
    assert trusts == pytest.approx([1.0, 0.5, 1e-4, 0.0], abs=1e-6)
    assert control.feed_forward_weight(
        CONFIG, leader(tangential_sigma_mps=CONFIG.half_weight_sigma_mps)
    ) == pytest.approx(0.5)


def follow_all(profile, covariance, frames=60, **config):
    """The commands to a leader that drives away at 0.2 m/s, slightly to the left, seen without noise."""
    driver = control.Follower(control.FollowerConfig(law=LAW, profile=profile, **config))
    outputs = []
    for k in range(frames):
        seen = core.Observation(
            utime=1_000_000 + k * 33_333, distance_m=1.5 + 0.2 * k / 30, bearing_rad=0.1, covariance=covariance
        )
        outputs.append(driver.follow(seen, core.Setpoint(distance_m=1.0)))
    return outputs


def test_a_coordinator_that_knows_nothing_drives_as_published():
    """Measurements that say of themselves that they may be a metre off leave the velocity unknown, some 0.5 m/s of
    standard deviation; trusted at 1 mm/s that is a trust of 4e-6, and the command differs by less than that times the
    speeds involved (below 10). No guard interferes, because none is near."""
    unknown = np.eye(3)
    config = control.AnticipateConfig(half_weight_sigma_mps=1e-3)
    published = follow_all(control.Profile.paper, unknown, frames=20)
    anticipated = follow_all(control.Profile.anticipate, unknown, frames=20, anticipate=config)
    for a, b in zip(published, anticipated, strict=True):
        assert b.feed_forward_weight < 1e-5
        assert b.command.linear_mps == pytest.approx(a.command.linear_mps, abs=1e-4)
        assert b.command.angular_radps == pytest.approx(a.command.angular_radps, abs=1e-4)


def test_with_a_measurement_that_cannot_be_used_the_published_law_drives_to_the_bit():
    broken = np.full((3, 3), math.nan)
    published, anticipated = (follow_all(p, broken) for p in (control.Profile.paper, control.Profile.anticipate))
    assert [a.command for a in published] == [b.command for b in anticipated]
    assert all(b.leader is None and b.feed_forward_weight == 0.0 for b in anticipated)


def test_the_same_observations_give_the_same_bits():
    known = np.diag([3e-4, 1e-4, 8e-4]) ** 2
    runs = [[output.command for output in follow_all(control.Profile.anticipate, known)] for _ in range(2)]
    assert runs[0] == runs[1]


def test_the_top_speed_is_approached_by_a_third_of_the_rest_a_frame_and_never_passed():
    """Frames of 1/30 s, a time constant of 0.1 s: what is missing to the top speed shrinks to 2/3 with every frame, so
    after n frames (2/3)^n of it is left; and slowing down is never held up."""
    missing_mps = 0.1
    speed = LIMITS.max_linear_mps - missing_mps
    for frame in range(1, 20):
        speed = control.eased_speed(CONFIG, LIMITS, previous_mps=speed, dt_s=1 / 30)
        assert LIMITS.max_linear_mps - speed == pytest.approx(missing_mps * (2 / 3) ** frame, abs=1e-12)
    assert control.eased_speed(CONFIG, LIMITS, previous_mps=LIMITS.max_linear_mps, dt_s=1 / 30) == LIMITS.max_linear_mps


def test_without_an_ease_time_or_after_a_long_pause_the_top_speed_is_free():
    abrupt = control.AnticipateConfig(ease_time_s=0.0)
    assert control.eased_speed(abrupt, LIMITS, previous_mps=0.2, dt_s=1 / 30) == LIMITS.max_linear_mps
    assert control.eased_speed(CONFIG, LIMITS, previous_mps=0.2, dt_s=5.0) == pytest.approx(LIMITS.max_linear_mps)


@settings(derandomize=True, max_examples=300)
@given(distances, bearings, speeds, speeds, st.floats(0.0, 0.6), st.floats(-4.0, 4.0))
def test_in_the_guarded_time_no_leader_leaves_the_picture(d, theta, radial, tangential, v, w):
    """|theta'| is below the way to the edge over the guard time, unless the leader's own motion alone takes more turn
    rate than there is; and the guard asks for no more turn rate than the limit, nor for more speed than was wanted."""
    motion = leader(d, theta, radial, tangential)
    assume(abs(tangential) / d < 1.0)  # the drive can turn by 2 rad/s
    kept = control.keep_in_view(CONFIG, VIEW, LIMITS, motion, core.Twist(linear_mps=v, angular_radps=w))
    assert 0.0 <= kept.linear_mps <= v
    assert abs(kept.angular_radps) <= max(abs(w), LIMITS.max_angular_radps)
    _, theta_rate = rates(motion, kept)
    assert theta_rate <= (VIEW.left_rad - theta) / CONFIG.guard_time_s + 1e-4
    assert theta_rate >= (VIEW.right_rad - theta) / CONFIG.guard_time_s - 1e-4


def test_at_the_edge_the_guard_turns_the_robot_even_if_the_law_does_not_want_to():
    """On the left edge, b = v sin(theta) / d; the bearing must not grow any more, so w is at least b."""
    motion = leader(0.5, VIEW.left_rad)
    kept = control.keep_in_view(CONFIG, VIEW, LIMITS, motion, core.Twist(linear_mps=0.4, angular_radps=-1.0))
    assert kept.linear_mps == 0.4
    assert kept.angular_radps == pytest.approx(0.4 * math.sin(VIEW.left_rad) / 0.5)


@settings(derandomize=True)
@given(distances, st.floats(-0.2, 0.2), st.floats(0.0, 0.6))
def test_far_from_the_edges_the_guard_leaves_the_command_alone(d, theta, v):
    b = v * math.sin(theta) / d
    wanted = core.Twist(linear_mps=v, angular_radps=b)  # keeps the bearing
    kept = control.keep_in_view(CONFIG, VIEW, LIMITS, leader(d, theta), wanted)
    assert kept == wanted


@pytest.mark.parametrize("law", ["fuzzy", "pbvs", "pid"])
@settings(derandomize=True, max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_no_law_ever_breaks_a_limit(law, seed):
    """Whatever is measured, near or far, steady or not."""
    random = np.random.default_rng(seed)
    driver = control.Follower(control.FollowerConfig(law=LAW, active_law=law))
    before, utime = core.Twist(), 1_000_000
    for _ in range(40):
        dt_us = int(random.integers(10_000, 100_000))
        utime += dt_us
        sigma = 10.0 ** random.uniform(-5, 0, 3)
        seen = core.Observation(
            utime=utime,
            distance_m=random.uniform(0.1, 4.0),
            bearing_rad=random.uniform(-1.0, 1.0),
            heading_rad=random.uniform(-3.0, 3.0),
            covariance=np.diag(sigma**2),
        )
        now = driver.follow(seen, core.Setpoint(distance_m=1.0, bearing_rad=-0.2)).command
        assert -LIMITS.max_reverse_mps <= now.linear_mps <= LIMITS.max_linear_mps
        assert abs(now.angular_radps) <= LIMITS.max_angular_radps
        step = max(dt_us * 1e-6, 1 / 30)  # the first command counts one control period from rest
        assert abs(now.linear_mps - before.linear_mps) <= LIMITS.max_linear_acceleration_mps2 * step + 1e-9
        assert abs(now.angular_radps - before.angular_radps) <= LIMITS.max_angular_acceleration_radps2 * step + 1e-9
        before = now


def test_dead_reckoning_is_where_the_simulated_drive_goes():
    """The same latency, ramp and lag in the simulator's own plant: a second of wild commands, within 0.1 mm."""
    from pilotfish import sim

    drive = sim.DriveConfig(command_timeout_s=0.0)
    robot, own = sim.Unicycle(drive), control.EgoMotion()
    random = np.random.default_rng(5)
    own.advance_to(0)
    for k in range(30):
        twist = core.Twist(linear_mps=random.uniform(-0.3, 0.6), angular_radps=random.uniform(-2.0, 2.0))
        own.command(twist, k * 33_000)
        robot.advance(twist, 0.033)
        own.advance_to((k + 1) * 33_000)
        pose = robot.state.pose
        assert own.pose == pytest.approx((pose.x_m, pose.y_m, pose.heading_rad), abs=1e-4)
        assert own.twist.linear_mps == pytest.approx(robot.state.twist.linear_mps, abs=1e-9)

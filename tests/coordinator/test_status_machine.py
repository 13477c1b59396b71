"""The status machine: what a coordinator says and commands when the leader is seen, hidden, or the input is bad."""

import math

import numpy as np
import pytest

from pilotfish import coordinator, core
from pilotfish import data as shipped
from pilotfish.core import Reason, Status
from scenes import PERIOD_US, leader_pictures

CONFIG = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
CONFIG.safety.noiseless_camera = True  # blank pictures here are all the same
FRAMES = leader_pictures(12)
STILL = core.Twist()


def fresh():
    return coordinator.Coordinator(CONFIG)


def at(frame, utime):
    return core.Frame(frame.image, utime=utime)


def blank(utime):
    return core.Frame(np.full((480, 640), 128, np.uint8), utime=utime)


def step(robot, frame, waited_us=0):
    """Frames arrive when they are exposed, on one clock, unless the test is about that."""
    return robot.step(frame, frame.utime + waited_us)


def tracking_coordinator():
    """Has tracked FRAMES and drives."""
    robot = fresh()
    result = [step(robot, frame) for frame in FRAMES][-1]
    assert result.status == Status.tracking and result.command.linear_mps > 0.1
    return robot, result


def test_before_the_leader_is_seen_it_searches_and_stands_still():
    result = step(fresh(), blank(1))
    assert (result.status, result.reason, result.command) == (Status.searching, Reason.no_tag_found, STILL)
    assert result.observation is None and result.control is None


def test_a_measured_leader_is_tracked_and_the_law_drives():
    result = step(fresh(), FRAMES[0])
    assert (result.status, result.reason) == (Status.tracking, Reason.none)
    assert result.observation.distance_m == pytest.approx(2.44, abs=0.02)
    assert result.control.velocity.error_m == pytest.approx(1.10 - result.observation.distance_m)
    assert result.command.linear_mps > 0
    assert len(result.control.velocity.inference.strengths) == 56


def test_without_the_leader_the_last_command_is_held_for_100_ms_then_zero():
    robot, last = tracking_coordinator()
    seen_utime = FRAMES[-1].utime
    for age_us, status in [(33_333, Status.coasting), (100_000, Status.coasting), (100_001, Status.lost)]:
        result = step(robot, blank(seen_utime + age_us))
        assert result.status == status
        assert result.command == (last.command if status == Status.coasting else STILL)


def test_asking_what_holds_without_a_frame_changes_nothing():
    asked, left_alone = fresh(), fresh()
    for frame in FRAMES:
        for age_us in (0, 50_000, 200_000, 10_000_000):
            asked.command_at(frame.utime - PERIOD_US + age_us)
        a, b = step(asked, frame), step(left_alone, frame)
        assert (a.status, a.command) == (b.status, b.command)


def test_without_frames_the_command_goes_to_zero_after_100_ms():
    robot, last = tracking_coordinator()
    coasting = robot.command_at(FRAMES[-1].utime + 100_000)
    assert (coasting.status, coasting.reason, coasting.command) == (
        Status.coasting,
        Reason.no_frame,
        last.command,
    )
    lost = robot.command_at(FRAMES[-1].utime + 100_001)
    assert (lost.status, lost.reason, lost.command) == (Status.lost, Reason.no_frame, STILL)


def test_a_measurement_from_the_future_is_not_fresh():
    robot, _ = tracking_coordinator()
    assert robot.command_at(FRAMES[-1].utime - 1).command == STILL


def test_after_being_lost_the_law_starts_from_rest():
    robot, _ = tracking_coordinator()
    first = step(fresh(), FRAMES[0])
    found_again = step(robot, at(FRAMES[0], FRAMES[-1].utime + 5_000_000))
    assert found_again.status == Status.tracking
    assert found_again.command == first.command
    assert found_again.control.velocity.error_change_m == 0.0


def test_a_frame_that_is_not_newer_is_refused_and_does_not_lengthen_the_life_of_the_last_one():
    robot, last = tracking_coordinator()
    seen = FRAMES[-1].utime
    again = robot.step(FRAMES[-1], seen + 50_000)
    assert (again.status, again.reason) == (Status.invalid_input, Reason.frame_time_not_advancing)
    assert again.command == last.command  # 50 ms old
    assert robot.step(FRAMES[-1], seen + 100_000).command == last.command
    assert robot.step(FRAMES[-1], seen + 100_001).command == STILL
    assert robot.step(FRAMES[0], seen + 100_002).command == STILL


def claims(data, width, height, stride_bytes):
    return core.Frame.unchecked(data, width=width, height=height, stride_bytes=stride_bytes, utime=10_000_000)


@pytest.mark.parametrize(
    ("frame", "reason"),
    [
        (claims(b"", 0, 0, 0), "frame_too_small"),
        (claims(b"1", 1, 1, 1), "frame_too_small"),
        (claims(b"1" * 9, 40000, 480, 40000), "frame_too_large"),
        (claims(bytes(640 * 480 - 1), 640, 480, 640), "frame_truncated"),
        (claims(bytes(640 * 480), 640, 480, 1), "frame_stride_invalid"),
        (claims(bytes(320 * 240), 320, 240, 320), "frame_size_not_calibrated"),
    ],
    ids=["0x0", "1x1", "40000 wide", "truncated", "wrong stride", "wrong size"],
)
def test_a_frame_that_cannot_be_used_moves_nothing_and_says_why(frame, reason):
    robot, _ = tracking_coordinator()
    result = step(robot, frame)  # long after the last good one
    assert (result.status, result.reason) == (Status.invalid_input, getattr(Reason, reason))
    assert result.command == STILL
    assert robot.rejected.frames_invalid == 1


def test_stop_requested_it_stands_still_but_keeps_looking():
    robot, _ = tracking_coordinator()
    assert robot.set_setpoint(core.Setpoint(distance_m=1.1, run=False))
    result = step(robot, at(FRAMES[-1], FRAMES[-1].utime + PERIOD_US))
    assert (result.status, result.reason, result.command) == (Status.stopped, Reason.stop_requested, STILL)
    assert result.observation is not None
    assert robot.command_at(FRAMES[-1].utime + PERIOD_US).status == Status.stopped


def test_a_stop_and_a_run_between_two_frames_leave_nothing_to_drive_on():
    robot, last = tracking_coordinator()
    assert robot.set_setpoint(core.Setpoint(distance_m=1.1, run=False))
    assert robot.set_setpoint(core.Setpoint(distance_m=1.1, run=True))
    seen_utime = FRAMES[-1].utime
    assert robot.command_at(seen_utime + 1).command == STILL
    next_frame = at(FRAMES[-1], seen_utime + PERIOD_US)
    again = step(robot, next_frame).command
    # From rest the acceleration limit alone decides, as for one that has just begun; it does not depend on the last mm.
    assert again.linear_mps == pytest.approx(step(fresh(), next_frame).command.linear_mps, rel=1e-9)
    assert again.linear_mps < 0.5 * last.command.linear_mps


@pytest.mark.parametrize("change", [{"distance_m": math.nan}, {"distance_m": -1.0}, {"bearing_rad": math.inf}])
def test_a_setpoint_out_of_range_is_refused_and_the_old_one_stays(change):
    robot = fresh()
    assert not robot.set_setpoint(core.Setpoint.unchecked(**change))
    assert robot.setpoint.distance_m == CONFIG.setpoint.distance_m
    assert robot.setpoint.bearing_rad == CONFIG.setpoint.bearing_rad


def test_the_same_frames_give_the_same_bits():
    a, b = fresh(), fresh()
    for frame in FRAMES:
        x, y = step(a, frame), step(b, frame)
        assert (x.command, x.observation.distance_m) == (y.command, y.observation.distance_m)


def config_with(max_age_s, max_linear_mps, max_reverse_mps=0.1):
    config = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
    config.safety.max_age_s = max_age_s
    config.control.limits.max_linear_mps = max_linear_mps
    config.control.limits.max_reverse_mps = max_reverse_mps
    return config


def test_a_longer_life_of_measurements_needs_a_speed_that_keeps_the_blind_travel_at_60_mm():
    coordinator.Coordinator(config_with(0.2, 0.3))  # 0.2 s x 0.3 m/s = 0.06 m
    for max_age_s, forward_mps, reverse_mps in [(0.2, 0.31, 0.1), (0.11, 0.6, 0.1), (0.2, 0.3, 0.31)]:
        with pytest.raises(ValueError, match=r"safety\.max_age_s: .* blind travel"):
            coordinator.Coordinator(config_with(max_age_s, forward_mps, reverse_mps))
    with pytest.raises(ValueError, match=r"max_age_s: 0\.26 is outside \[0, 0\.25\]"):
        coordinator.Coordinator(config_with(0.26, 0.1))


def test_who_is_refused_for_blind_travel_is_told_what_would_do():
    """0.2 s at 0.31 m/s is 0.062 m; 0.06 m in 0.2 s are 0.3 m/s. The faster of the two directions counts."""
    for forward_mps, reverse_mps in [(0.31, 0.1), (0.1, 0.31)]:
        with pytest.raises(ValueError, match="blind travel") as refused:
            coordinator.Coordinator(config_with(0.2, forward_mps, reverse_mps))
        assert str(refused.value).endswith(
            "0.2 s at 0.31 m/s is 0.062 m of blind travel, more than 0.06 m; "
            "lower control.limits.max_linear_mps and max_reverse_mps to 0.3, or max_age_s to 0.1"
        )


def test_a_setpoint_below_the_stop_distance_is_refused_at_load_and_later():
    config = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
    config.safety.stop_distance_m = 1.2
    with pytest.raises(ValueError, match=r"setpoint\.distance_m: 1\.1 is below safety\.stop_distance_m"):
        coordinator.Coordinator(config)
    robot = fresh()
    assert not robot.set_setpoint(core.Setpoint(distance_m=0.39))
    assert robot.set_setpoint(core.Setpoint(distance_m=0.4))


def test_a_stop_is_taken_whatever_else_the_message_says():
    robot, _ = tracking_coordinator()
    assert robot.set_setpoint(core.Setpoint.unchecked(distance_m=math.nan, run=False))
    assert not robot.setpoint.run and robot.setpoint.distance_m == CONFIG.setpoint.distance_m
    assert robot.command_at(FRAMES[-1].utime).command == STILL


MOTION_INPUTS = [coordinator.Coordinator.set_ego_motion, coordinator.Coordinator.set_leader_intent]


@pytest.mark.parametrize("set_motion", MOTION_INPUTS, ids=["odometry", "leader_intent"])
def test_motion_inputs_are_refused_before_the_first_frame_and_from_another_clock(set_motion):
    robot, twist = fresh(), core.Twist(linear_mps=0.1)
    assert not set_motion(robot, FRAMES[0].utime, twist)
    step(robot, FRAMES[0])
    assert not set_motion(robot, FRAMES[0].utime - 1_000_001, twist)
    assert not set_motion(robot, FRAMES[0].utime + 1_000_001, twist)
    assert not set_motion(robot, -(2**63), twist) and not set_motion(robot, 2**63 - 1, twist)
    assert not set_motion(robot, FRAMES[0].utime + 1, core.Twist(linear_mps=math.nan))
    assert set_motion(robot, FRAMES[0].utime + 1_000_000, twist)


@pytest.mark.parametrize("set_motion", MOTION_INPUTS, ids=["odometry", "leader_intent"])
def test_motion_inputs_move_nothing_without_a_leader_in_sight(set_motion):
    robot = fresh()
    for k in range(30):
        utime = 1_000_000 + k * PERIOD_US
        set_motion(robot, utime, core.Twist(linear_mps=0.5))
        assert step(robot, blank(utime)).command == STILL

"""The status machine: what a coordinator says and commands when the leader is seen, hidden, or the input is bad."""

import math

import numpy as np
import pytest

from pilotfish import control, coordinator, core
from pilotfish import data as shipped
from pilotfish.core import Reason, Status
from scenes import PERIOD_US, leader_pictures

CONFIG = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
FRAMES = leader_pictures(12)
STILL = core.Twist()


def fresh():
    return coordinator.Coordinator(CONFIG)


def at(frame, utime):
    return core.Frame(frame.image, utime=utime)


def blank(utime):
    return core.Frame(np.full((480, 640), 128, np.uint8), utime=utime)


def tracking_coordinator():
    """Has tracked FRAMES and drives."""
    heart = fresh()
    result = [heart.step(frame) for frame in FRAMES][-1]
    assert result.status == Status.tracking and result.command.linear_mps > 0.1
    return heart, result


def test_before_the_leader_is_seen_it_searches_and_stands_still():
    result = fresh().step(blank(1))
    assert (result.status, result.reason, result.command) == (Status.searching, Reason.no_tag_found, STILL)
    assert result.observation is None and result.control is None


def test_a_measured_leader_is_tracked_and_the_law_drives():
    result = fresh().step(FRAMES[0])
    assert (result.status, result.reason) == (Status.tracking, Reason.none)
    assert result.observation.distance_m == pytest.approx(2.44, abs=0.02)
    assert result.control.velocity.error_m == pytest.approx(1.10 - result.observation.distance_m)
    assert result.command.linear_mps > 0
    assert len(result.control.velocity.inference.strengths) == 56


def test_without_the_leader_the_last_command_is_held_for_100_ms_of_image_time_then_zero():
    heart, last = tracking_coordinator()
    seen_utime = FRAMES[-1].utime
    for age_us, status in [(33_333, Status.coasting), (100_000, Status.coasting), (100_001, Status.lost)]:
        result = heart.step(blank(seen_utime + age_us))
        assert result.status == status
        assert result.command == (last.command if status == Status.coasting else STILL)


def test_asking_what_holds_without_a_frame_changes_nothing():
    asked, left_alone = fresh(), fresh()
    for frame in FRAMES:
        for age_us in (0, 50_000, 200_000, 10_000_000):
            asked.without_frame(frame.utime - PERIOD_US + age_us)
        a, b = asked.step(frame), left_alone.step(frame)
        assert (a.status, a.command) == (b.status, b.command)


def test_without_frames_the_command_goes_to_zero_after_100_ms():
    heart, last = tracking_coordinator()
    coasting = heart.without_frame(FRAMES[-1].utime + 100_000)
    assert (coasting.status, coasting.reason, coasting.command) == (
        Status.coasting,
        Reason.no_frame,
        last.command,
    )
    lost = heart.without_frame(FRAMES[-1].utime + 100_001)
    assert (lost.status, lost.reason, lost.command) == (Status.lost, Reason.no_frame, STILL)


def test_a_measurement_from_the_future_is_not_fresh():
    heart, _ = tracking_coordinator()
    assert heart.without_frame(FRAMES[-1].utime - 1).command == STILL


def test_after_being_lost_the_law_starts_from_rest():
    heart, _ = tracking_coordinator()
    first = fresh().step(FRAMES[0])
    found_again = heart.step(at(FRAMES[0], FRAMES[-1].utime + 5_000_000))
    assert found_again.status == Status.tracking
    assert found_again.command == first.command
    assert found_again.control.velocity.error_change_m == 0.0


def test_a_frame_that_is_not_newer_is_refused_and_does_not_rewind_the_age():
    heart, last = tracking_coordinator()
    again = heart.step(FRAMES[-1])
    assert (again.status, again.reason) == (Status.invalid_input, Reason.frame_time_not_advancing)
    assert again.command == last.command  # still fresh
    heart.step(blank(FRAMES[-1].utime + 90_000))
    old = heart.step(FRAMES[0])
    assert old.reason == Reason.frame_time_not_advancing
    heart.step(blank(FRAMES[-1].utime + 110_000))
    assert heart.step(FRAMES[0]).command == STILL


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
    heart, _ = tracking_coordinator()
    result = heart.step(frame)  # long after the last good one
    assert (result.status, result.reason) == (Status.invalid_input, getattr(Reason, reason))
    assert result.command == STILL
    assert heart.rejected.frames_invalid == 1


def test_told_to_stop_it_stands_still_but_keeps_looking():
    heart, _ = tracking_coordinator()
    assert heart.set_setpoint(core.Setpoint(distance_m=1.1, run=False))
    result = heart.step(at(FRAMES[-1], FRAMES[-1].utime + PERIOD_US))
    assert (result.status, result.reason, result.command) == (Status.stopped, Reason.told_to_stop, STILL)
    assert result.observation is not None
    assert heart.without_frame(FRAMES[-1].utime + PERIOD_US).status == Status.stopped


@pytest.mark.parametrize("change", [{"distance_m": math.nan}, {"distance_m": -1.0}, {"bearing_rad": math.inf}])
def test_a_setpoint_out_of_range_is_refused_and_the_old_one_stays(change):
    heart = fresh()
    assert not heart.set_setpoint(core.Setpoint(**change))
    assert heart.setpoint.distance_m == CONFIG.setpoint.distance_m
    assert heart.setpoint.bearing_rad == CONFIG.setpoint.bearing_rad


def test_the_same_frames_give_the_same_bits():
    a, b = fresh(), fresh()
    for frame in FRAMES:
        x, y = a.step(frame), b.step(frame)
        assert (x.command, x.observation.distance_m) == (y.command, y.observation.distance_m)


def test_a_maximum_age_above_100_ms_is_refused():
    config = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
    config.safety.max_age_s = 0.2
    with pytest.raises(ValueError, match=r"safety\.max_age_s: 0\.2 is outside \[0, 0\.1\]"):
        coordinator.Coordinator(config)


TOLD = [coordinator.Coordinator.set_own_motion, coordinator.Coordinator.set_announced_motion]


@pytest.mark.parametrize("tell", TOLD, ids=["odometry", "announcement"])
def test_what_it_is_told_of_motion_is_refused_before_the_first_frame_and_from_another_clock(tell):
    heart, twist = fresh(), core.Twist(linear_mps=0.1)
    assert not tell(heart, FRAMES[0].utime, twist)
    heart.step(FRAMES[0])
    assert not tell(heart, FRAMES[0].utime - 1_000_001, twist)
    assert not tell(heart, FRAMES[0].utime + 1_000_001, twist)
    assert not tell(heart, -(2**63), twist) and not tell(heart, 2**63 - 1, twist)
    assert not tell(heart, FRAMES[0].utime + 1, core.Twist(linear_mps=math.nan))
    assert tell(heart, FRAMES[0].utime + 1_000_000, twist)


@pytest.mark.parametrize("tell", TOLD, ids=["odometry", "announcement"])
def test_what_it_is_told_of_motion_moves_nothing_without_a_leader_in_sight(tell):
    heart = fresh()
    for k in range(30):
        utime = 1_000_000 + k * PERIOD_US
        tell(heart, utime, core.Twist(linear_mps=0.5))
        assert heart.step(blank(utime)).command == STILL


@pytest.mark.parametrize("profile", ["paper", "anticipate"])
def test_frames_from_both_ends_of_the_clock_are_answered(profile):
    """From -2^63 to 2^63 - 1 us is farther than an int64 can say."""
    config = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
    config.control.profile = getattr(control.Profile, profile)
    heart = coordinator.Coordinator(config)
    for utime in (-(2**63), -(2**63) + 1, -1, 0, 2**62, 2**63 - 2, 2**63 - 1):
        result = heart.step(at(FRAMES[0], utime))
        assert result.status == Status.tracking
        assert math.isfinite(result.command.linear_mps) and math.isfinite(result.command.angular_radps)
    assert heart.step(at(FRAMES[0], -(2**63))).reason == Reason.frame_time_not_advancing

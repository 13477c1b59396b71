"""What time is, and what a stamp is worth: age is counted on the monotonic clock, stamps only order the frames."""

import pytest

from pilotfish import coordinator, core
from pilotfish import data as shipped
from pilotfish.core import Reason, Status
from scenes import PERIOD_US

CONFIG = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
STILL = core.Twist()
BOOT_US = 5_000_000_000  # the monotonic clock has nothing to do with the stamps'


def seen(utime, distance_m=2.0):
    return core.Observation(utime=utime, distance_m=distance_m, bearing_rad=0.0, heading_rad=0.0)


class Robot:
    """A coordinator, and the time that passes beside it. Measures without pictures unless it is given one."""

    def __init__(self):
        self.follower = coordinator.Coordinator(CONFIG)
        self.now_us = BOOT_US

    def frame(self, utime, after_us=PERIOD_US, leader=True, known_age_us=0):
        self.now_us += after_us
        return self.follower.step_observation(
            utime, seen(utime) if leader else None, self.now_us, known_age_us=known_age_us
        )

    def drive(self, utime=1_000_000, frames=10):
        for k in range(frames):
            result = self.frame(utime + k * PERIOD_US)
        assert result.status == Status.tracking and result.command.linear_mps > 0.1
        return utime + (frames - 1) * PERIOD_US


@pytest.mark.fault("stamps_backward")
def test_stamps_that_run_backward_drive_for_100_ms_and_no_longer():
    robot = Robot()
    last = robot.drive()
    for k in range(1, 300):
        result = robot.frame(last - k * PERIOD_US, leader=False)
        assert result.reason == Reason.frame_time_not_advancing
        # PERIOD_US x 3 = 99 999 us: the third is the last that may hold.
        assert (result.command == STILL) == (k > 3)


def test_stamps_that_run_backward_do_not_revive_a_robot_that_lost_its_leader():
    robot = Robot()
    last = robot.drive()
    for k in range(1, 150):
        robot.frame(last + k * PERIOD_US, leader=False)
    for k in range(1, 150):
        assert robot.frame(last - k * PERIOD_US, leader=False).command == STILL


@pytest.mark.parametrize("shift_us", [-3_600_000_000, 3_600_000_000, -1_500_000, 1_500_000, -200_000])
@pytest.mark.fault("clock_set")
def test_a_source_whose_clock_is_set_is_followed_again_from_rest_after_a_second_of_frames_that_agree(shift_us):
    """At 30 Hz the 31st is the first that comes a second after the last frame that fitted."""
    robot = Robot()
    last = robot.drive()
    results = [robot.frame(last + shift_us + k * PERIOD_US) for k in range(1, 35)]
    assert [r.status for r in results[:30]] == [Status.invalid_input] * 30
    assert all(r.command == STILL for r in results[3:30]), "100 ms after the last frame that fitted"
    assert [r.status for r in results[30:]] == [Status.tracking] * 4
    assert results[30].command == Robot().frame(1).command, "from rest: as if it had just begun"
    assert robot.follower.clock_epochs == 1


def test_a_delayed_second_path_does_not_take_over_in_a_gap_of_the_living_source():
    """Half a second without the living camera; the other one shows what was 300 ms ago, correctly stamped."""
    robot = Robot()
    last = robot.drive()
    for k in range(1, 15):
        result = robot.frame(last - 300_000 + k * PERIOD_US)
        assert result.status == Status.invalid_input
    assert result.command == STILL
    assert robot.frame(last + 15 * PERIOD_US).status == Status.tracking
    assert robot.follower.clock_epochs == 0


def test_a_recording_with_stamps_of_a_wall_clock_never_begins_an_epoch():
    """Its age is known, and however large it is, it is looked at where an epoch begins."""
    robot = Robot()
    for k in range(100):
        result = robot.frame(1_600_000_000_000_000 + k * PERIOD_US, known_age_us=3_600_000_000)
        assert (result.reason, result.command) == (Reason.frame_stale, STILL)


def test_a_slow_first_frame_does_not_make_later_slow_ones_look_fresh():
    """The first takes 150 ms; of those that follow every second one 5 ms, the others 150: these are 145 ms late."""
    robot = Robot()
    results = []
    arrivals = sorted((k * 2 * PERIOD_US + (5_000 if k % 2 else 150_000), k * 2 * PERIOD_US) for k in range(60))
    for arrival_us, exposure_us in arrivals:
        robot.now_us = BOOT_US + arrival_us
        results.append((arrival_us - exposure_us, robot.frame(1_000_000 + exposure_us, after_us=0)))
    late = [result for delay_us, result in results[20:] if delay_us > 100_000]
    assert late and all(result.status == Status.invalid_input for result in late)
    assert any(result.status == Status.tracking for delay_us, result in results[20:] if delay_us < 100_000)


def frames_that_took(robot, arrivals):
    """What a robot says of frames given as (arrival, how long it took from the exposure) in seconds."""
    results = []
    for arrival_s, took_s in arrivals:
        robot.now_us = BOOT_US + round(arrival_s * 1e6)
        results.append(robot.frame(1_000_000 + round((arrival_s - took_s) * 1e6), after_us=0))
    return results


def test_now_and_then_a_quick_frame_proves_nothing():
    """300 ms for each but one in 0.6 s, which takes none: of those there are never three within a second."""
    robot = Robot()
    arrivals = [(k / 30, 0.0 if k % 18 == 9 else 0.3) for k in range(300)]
    results = frames_that_took(robot, arrivals)
    quick = [result for (_, took_s), result in zip(arrivals, results, strict=True) if took_s == 0.0]
    assert len(quick) == 17 and {result.reason for result in quick} == {Reason.frame_time_implausible}
    assert robot.follower.clock_epochs == 0


@pytest.mark.parametrize(("seconds_later", "epochs"), [(8.0, 1), (11.0, 2)])
def test_a_second_proof_that_the_first_frame_was_late_counts_after_ten_seconds(seconds_later, epochs):
    """First all take 400 ms, then 200: three of them are a proof. Some seconds later 0 ms, in a burst of three."""
    robot = Robot()
    second_s = 1.0 + seconds_later
    frames_that_took(robot, [(k / 30, 0.4) for k in range(30)])
    frames_that_took(robot, [(1.0 + k / 30, 0.2) for k in range(round(30 * seconds_later))])
    assert robot.follower.clock_epochs == 1
    frames_that_took(robot, [(second_s + k / 30, 0.0) for k in range(3)])
    assert robot.follower.clock_epochs == epochs


@pytest.mark.parametrize(("gap_s", "epochs"), [(0.9, 1), (1.1, 0)])
def test_frames_more_than_a_second_apart_do_not_agree_on_a_new_clock(gap_s, epochs):
    robot = Robot()
    robot.drive()
    for k in range(20):
        robot.frame(-3_600_000_000 + round(k * gap_s * 1e6), after_us=round(gap_s * 1e6))
    assert robot.follower.clock_epochs == epochs


def test_the_fifth_frame_that_agrees_with_those_before_it_begins_an_epoch():
    """Half a second apart, so that the second of silence is over with the third."""
    robot = Robot()
    robot.drive()
    results = [robot.frame(-3_600_000_000 + k * 500_000, after_us=500_000) for k in range(5)]
    assert [r.reason for r in results[:4]] == [Reason.frame_time_not_advancing] * 4
    assert results[4].status == Status.tracking


def test_a_stamp_one_microsecond_back_is_back():
    robot = Robot()
    last = robot.drive()
    assert robot.frame(last - 1).reason == Reason.frame_time_not_advancing
    assert robot.frame(last + 1).status == Status.tracking


@pytest.mark.parametrize(("known_age_us", "left_us"), [(60_000, 40_000), (1, 99_999), (0, 100_000), (-50_000, 100_000)])
def test_the_first_frame_too_is_as_old_as_is_known_and_50_ms_of_the_future_are_now(known_age_us, left_us):
    robot = Robot()
    assert robot.frame(1_000_000, known_age_us=known_age_us).status == Status.tracking
    assert robot.follower.held.until_us == robot.now_us + left_us


@pytest.mark.fault("second_source")
@pytest.mark.parametrize("stale_hz", [10, 300])
@pytest.mark.parametrize("silent_s", [0.95, 1.5, 3.0])
def test_a_camera_on_this_hosts_clock_never_gives_way_to_pictures_of_which_nothing_is_known(stale_hz, silent_s):
    """The camera stamps with our clock and takes 5 ms; it is silent for a while from 2 s on. Beside it, from 1 s on, a
    source with stamps of its own shows what was long ago."""
    robot = Robot()
    camera = [(k / 30, True) for k in range(180) if not 2.0 <= k / 30 < 2.0 + silent_s]
    stale = [(1.0 + k / stale_hz + 1e-4, False) for k in range(5 * stale_hz)]
    answered = []
    for at_s, live in sorted(camera + stale):
        robot.now_us = BOOT_US + round(at_s * 1e6)
        utime = 1_600_000_000_000_000 if live else 7_000_000
        utime += round(at_s * 1e6)
        answered.append((at_s, live, robot.frame(utime, after_us=0, known_age_us=5_000 if live else 0)))
    assert not any(result.status == Status.tracking for _, live, result in answered if not live)
    assert all(result.status == Status.tracking for _, live, result in answered if live)
    assert robot.follower.clock_epochs == 0


def test_a_camera_on_this_hosts_clock_ends_an_epoch_of_which_nothing_is_known_with_its_third_picture():
    robot = Robot()
    for k in range(60):
        robot.frame(7_000_000 + k * PERIOD_US)
    last = 7_000_000 + 59 * PERIOD_US
    live = []
    for k in range(1, 30):  # both, one after the other
        live.append(robot.frame(1_600_000_000_000_000 + k * PERIOD_US, after_us=PERIOD_US // 2, known_age_us=5_000))
        other = robot.frame(last + k * PERIOD_US, after_us=PERIOD_US - PERIOD_US // 2)
        assert (other.status == Status.tracking) == (k < 3)
    assert [result.status for result in live[:2]] == [Status.invalid_input] * 2
    assert {result.status for result in live[2:]} == {Status.tracking}
    assert robot.follower.clock_epochs == 1


@pytest.mark.fault("odd_stamp")
@pytest.mark.parametrize("odd_us", [-1_000, -5_000, -30_000, 400_000])
@pytest.mark.parametrize("late_s", [0.15, 0.5, 3.0])
def test_one_odd_stamp_does_not_make_a_late_source_a_quick_one(late_s, odd_us):
    """A clock of its own; from 2 s on everything is late, and is refused; at 4 s one stamp is odd, and no other."""
    robot = Robot()
    frames_that_took(robot, [(k / 30, 0.005) for k in range(60)])
    late = [(2.0 + late_s + k / 30, 0.005 + late_s) for k in range(60)]
    results = frames_that_took(robot, late)
    # 1 ms behind the last one, which was exposed 5 ms and its lateness before it came.
    frames_that_took(robot, [(late[-1][0] + 0.001, 0.006 + late_s - odd_us * 1e-6)])
    results += frames_that_took(robot, [(4.0 + late_s + k / 30, 0.005 + late_s) for k in range(120)])
    assert not any(result.status == Status.tracking for result in results)
    assert robot.follower.clock_epochs == 0


def test_an_odd_stamp_in_a_queue_that_grows_does_not_forget_how_late_it_is():
    """100 ms later every second, up to 400; one stamp 40 ms back when it is 300 late."""
    robot = Robot()
    frames_that_took(robot, [(k / 30, 0.005) for k in range(60)])
    results = []
    for k in range(240):
        took_s = 0.005 + min(0.1 * k / 30, 0.4)
        results.append((took_s, frames_that_took(robot, [(2.0 + k / 30 + took_s, took_s)])[0]))
        if k == 90:
            frames_that_took(robot, [(2.0 + k / 30 + took_s + 0.001, took_s + 0.041)])
    assert not any(result.status == Status.tracking for took_s, result in results if took_s > 0.125)
    assert robot.follower.clock_epochs == 0


def test_a_clock_that_is_set_back_by_less_than_a_frame_is_no_epoch():
    robot = Robot()
    last = robot.drive()
    assert robot.frame(last + PERIOD_US - 20_000).status == Status.tracking
    assert robot.follower.clock_epochs == 0


@pytest.mark.parametrize("stamp", [2**61, 2**62, -(2**62), 0, 2**63 - 1, -(2**63)])
@pytest.mark.fault("wild_stamp")
def test_one_frame_with_a_wild_stamp_changes_nothing_for_those_before_and_after(stamp):
    robot = Robot()
    last = robot.drive()
    wild = robot.frame(stamp, after_us=10_000)
    assert wild.status == Status.invalid_input
    assert wild.reason in (Reason.frame_time_implausible, Reason.frame_time_not_advancing)
    for k in range(1, 50):
        after_us = PERIOD_US - 10_000 if k == 1 else PERIOD_US
        assert robot.frame(last + k * PERIOD_US, after_us=after_us).status == Status.tracking
    assert robot.follower.clock_epochs == 0


def test_wild_stamps_between_all_good_frames_do_not_end_the_epoch():
    robot = Robot()
    last = robot.drive()
    for k in range(1, 100):
        assert robot.frame(last + 2**50 + k * PERIOD_US, after_us=10_000).status == Status.invalid_input
        assert robot.frame(last + k * PERIOD_US, after_us=PERIOD_US - 10_000).status == Status.tracking


def test_a_frame_a_little_ahead_of_time_is_accepted_even_if_the_one_before_it_was_too_far_ahead():
    """50 ms ahead are no fault; that the two agree with each other to 20 ms says nothing against the second."""
    robot = Robot()
    last = robot.drive()
    assert robot.frame(last + PERIOD_US + 60_000).reason == Reason.frame_time_implausible
    assert robot.frame(last + 2 * PERIOD_US + 40_000).status == Status.tracking


@pytest.mark.fault("stamps_wrong_unit")
def test_stamps_in_milliseconds_are_refused_as_soon_as_they_cannot_be_true():
    robot = Robot()
    results = [robot.frame(1_000 + 33 * k) for k in range(100)]
    # Each frame seems 33.3 ms later than it is: the fourth after the first is 133 ms late.
    assert [r.status for r in results[:4]] == [Status.tracking] * 4
    assert all(r.reason == Reason.frame_stale and r.command == STILL for r in results[5:])


def test_a_stamp_that_runs_twice_as_fast_as_time_is_refused():
    robot = Robot()
    results = [robot.frame(1_000_000 + 2 * PERIOD_US * k) for k in range(200)]
    # Once in ten seconds they pass for a source whose first frame was late: two frames more.
    assert sum(r.status == Status.tracking for r in results) <= 6
    assert all(r.reason == Reason.frame_time_implausible and r.command == STILL for r in results[12:])


@pytest.mark.fault("late_frames")
def test_frames_that_were_held_up_are_as_old_as_they_are():
    """A burst after a stall of 4 s: 120 frames at once, of which only the last three are young enough."""
    robot = Robot()
    last = robot.drive()
    robot.now_us += 120 * PERIOD_US
    results = [robot.frame(last + k * PERIOD_US, after_us=0) for k in range(1, 121)]
    # Frame k is (120 - k) periods old: 3 x 33 333 us is the last below 100 ms.
    assert all(r.reason == Reason.frame_stale and r.command == STILL for r in results[:116])
    assert [r.status for r in results[116:]] == [Status.tracking] * 4


def test_a_measurement_dies_100_ms_after_its_exposure_as_far_as_that_is_known():
    robot = Robot()
    last = robot.drive()
    assert robot.frame(last + PERIOD_US, known_age_us=60_000).status == Status.tracking
    assert robot.follower.held.until_us == robot.now_us + 40_000
    assert robot.follower.command_at(robot.now_us + 40_000).command != STILL
    assert robot.follower.command_at(robot.now_us + 40_001).command == STILL


def test_a_frame_known_to_be_old_or_of_the_future_moves_nothing():
    for known_age_us, reason in [
        (100_001, Reason.frame_stale),
        (3_000_000, Reason.frame_stale),
        (-50_001, Reason.frame_time_implausible),
    ]:
        result = Robot().frame(1_000_000, known_age_us=known_age_us)
        assert (result.status, result.reason, result.command) == (Status.invalid_input, reason, STILL)


def test_a_frame_of_the_future_by_a_clock_that_both_sides_share_is_refused_in_the_middle_of_an_epoch_too():
    """Its stamp fits those before it; but exposed 50.001 ms after it arrived, it is a lie, and one that never ends an
    epoch, however long it lasts."""
    robot = Robot()
    last = robot.drive()
    assert robot.frame(last + PERIOD_US, known_age_us=-50_000).status == Status.tracking
    for k in range(2, 60):
        result = robot.frame(last + k * PERIOD_US, known_age_us=-50_001)
        assert result.reason == Reason.frame_time_implausible
        assert (result.command == STILL) == (k > 4)  # three periods are 99 999 us: till then the last one holds
    assert robot.follower.clock_epochs == 0
    assert robot.frame(last + 60 * PERIOD_US, known_age_us=0).status == Status.tracking


@pytest.mark.fault("forged_first_image")
def test_one_forged_first_image_does_not_make_a_camera_that_is_3_s_late_look_fresh():
    robot = Robot()
    robot.frame(1)
    for k in range(60):
        result = robot.frame(1_600_000_000_000_000 + k * PERIOD_US, known_age_us=3_000_000)
        if k > 2:  # 100 ms after the forged one
            assert result.command == STILL


def test_a_monotonic_clock_that_went_backward_moves_nothing():
    robot = Robot()
    robot.drive()
    assert robot.follower.command_at(robot.now_us - 1).command == STILL


def test_asking_late_and_often_never_lengthens_a_life():
    robot = Robot()
    robot.drive()
    for _ in range(1000):
        robot.follower.command_at(robot.now_us + 100_001)
    assert robot.follower.command_at(robot.now_us + 100_001).command == STILL
    assert robot.follower.command_at(robot.now_us + 100_000).command != STILL


def test_clocks_that_drift_apart_by_200_ppm_for_an_hour_are_still_one_epoch():
    robot = Robot()
    for k in range(3600 * 2):
        assert robot.frame(1_000_000 + round(k * 500_000 * 1.0002), after_us=500_000).status == Status.tracking
    assert robot.follower.clock_epochs == 0

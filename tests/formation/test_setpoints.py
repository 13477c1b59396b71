"""A change of formation: setpoints over time, the time to form again, how near robots come to each other."""

import math

import numpy as np
import pytest
from formation_files import formation
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish.formation.measures import errors, forming, keeping, least_apart_m, place_errors_m
from pilotfish.formation.run import FormationRun, play, setpoint_at
from pilotfish.recording import Meta, Recording

CHANGING = formation("chain", duration_s=20.0, changes=[{"at_s": 8.0, "over_s": 2.0, "spacing_m": 1.5}])
RATE_HZ = 30.0


def recording(robot, leader, error_m, setpoint_m):
    """Behind a leader at rest at the origin, at the distance setpoint - error."""
    n = len(error_m)
    time_s, zero, distance_m = np.arange(n) / RATE_HZ, np.zeros(n), setpoint_m - error_m
    columns = dict.fromkeys(Recording.__dataclass_fields__, zero)
    columns |= {"time_s": time_s, "utime_us": np.arange(n), "true_distance_m": distance_m, "x_m": -distance_m}
    columns |= {
        "status": np.full(n, "tracking"),
        "delivered": np.ones(n, bool),
        "meta": Meta(robot=robot, leader=leader),
    }
    return Recording(**columns)


def run_with(error_m, bearing_error_rad=0.0):
    """One robot and its leader; the setpoint steps from 1.0 to 1.5 m at 8 s."""
    shape = formation("chain", robots=2, duration_s=20.0, changes=[{"at_s": 8.0, "spacing_m": 1.5}])
    setpoint_m = np.where(np.arange(len(error_m)) / RATE_HZ < 8.0 - 1e-9, 1.0, 1.5)
    bearing_rad = np.full(len(error_m), -bearing_error_rad)
    own = recording("robot1", "leader", error_m, setpoint_m)
    return FormationRun(shape, "paper", {"robot1": own}, {"robot1": setpoint_m}, {"robot1": bearing_rad})


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.floats(0.0, 25.0))
def test_a_setpoint_goes_in_a_straight_line_from_the_old_to_the_new_one(time_s):
    expected_m = 1.0 + 0.5 * min(1.0, max(0.0, (time_s - 8.0) / 2.0))
    assert setpoint_at(CHANGING, "robot2", time_s).distance_m == pytest.approx(expected_m, abs=1e-6)


def test_without_a_duration_it_jumps():
    jumps = formation("chain", duration_s=20.0, changes=[{"at_s": 8.0, "spacing_m": 1.5}])
    assert [setpoint_at(jumps, "robot1", t).distance_m for t in (7.99, 8.0)] == pytest.approx([1.0, 1.5])


def test_an_error_that_decays_is_formed_when_it_is_within_the_tolerance():
    """e = 0.5 exp(-t / 0.7) is 5 mm after 0.7 ln 100 = 3.22 s; frames come every 33 ms."""
    time_s = np.arange(600) / RATE_HZ
    since_s = time_s - 8.0
    error_m = np.where(since_s < -1e-9, 0.0, 0.5 * np.exp(-since_s / 0.7))
    start, change = forming(run_with(error_m))
    assert start.formed_after_s == 0.0
    assert change.formed_after_s == pytest.approx(0.7 * math.log(100.0), abs=1.0 / RATE_HZ)


def test_what_leaves_the_tolerance_again_was_not_formed_and_what_never_enters_it_is_never():
    time_s = np.arange(600) / RATE_HZ
    once_more = np.where((time_s > 14.9) & (time_s < 15.02), 0.006, 0.0)  # frames at 14.93 to 15.0 s are outside
    assert forming(run_with(once_more))[1].formed_after_s == pytest.approx(15.033 - 8.0, abs=0.01)
    assert forming(run_with(np.full(600, 0.006)))[1].formed_after_s is None


def test_across_the_line_of_sight_counts_the_distance_times_the_bearing_error():
    """At 1.0 and 1.5 m 4 mrad are 4 and 6 mm: within 5 mm before the change alone."""
    start, change = forming(run_with(np.zeros(600), bearing_error_rad=0.004))
    assert (start.formed_after_s, change.formed_after_s) == (0.0, None)


def test_while_setpoints_move_nothing_is_formed():
    """A robot that follows a setpoint that moves for 2 s without any error is formed when that stands."""
    run = play(formation("chain", robots=2, duration_s=6.0, tolerance_m=0.9, changes=[{"at_s": 2.0, "over_s": 2.0}]))
    assert forming(run)[1].formed_after_s == 0.0, "nothing changes"
    moving = {"at_s": 2.0, "over_s": 2.0, "spacing_m": 1.2}
    run = play(formation("chain", robots=2, duration_s=6.0, tolerance_m=0.9, changes=[moving]))
    assert forming(run)[1].formed_after_s == pytest.approx(2.0, abs=0.05)


def test_the_least_distance_of_robots_that_cross_is_where_their_paths_are_nearest():
    """a along x, b along -y half a metre ahead: |(t, 0) - (0.5, 1 - t)| is least at t = 0.75, sqrt(2) / 4."""
    t = np.linspace(0.0, 1.5, 1501)
    where = {"a": np.stack([t, 0 * t], -1), "b": np.stack([0 * t + 0.5, 1 - t], -1), "c": np.full((1501, 2), 9.0)}
    apart_m, pair = least_apart_m(where, slice(None))
    assert (apart_m, pair) == (pytest.approx(math.sqrt(2) / 4, abs=1e-6), ("a", "b"))
    assert least_apart_m(where, t < 0.2)[0] > apart_m


def test_signs_of_the_errors_are_those_of_all_tables():
    run = run_with(np.full(600, 0.02))
    error_m, _ = errors(run, "robot1")
    assert error_m == pytest.approx(np.full(600, 0.02)), "positive: too close"
    kept = keeping(run)[0]
    assert (kept.mean_error_m, kept.max_error_m, kept.distance_setpoint_m) == pytest.approx((0.02, 0.02, 1.5))
    assert place_errors_m(run)["robot1"][-1] == pytest.approx(0.02), "its place is 1.5 m behind the leader"


def test_a_wedge_forms_again_within_its_tolerance_and_no_robot_touches_another():
    """Drawn measurements; 0.2 m more in a step. The step is 0.2 m and the law's time constant about 0.5 s: 5 mm, a
    fortieth, after some 2 s. Any two stay as far apart as the circles they turn in are wide."""
    wedge = formation("wedge", angle_deg=18.0, duration_s=8.0, changes=[{"at_s": 3.0, "spacing_m": 1.2}])
    run = play(wedge)
    change = forming(run)[1]
    assert change.formed_after_s is not None and change.formed_after_s < 4.0
    assert change.least_apart_m > 2 * wedge.outlook.radius_m - 0.02
    assert all(kept.max_error_m < 0.005 and kept.seen_ratio == 1.0 for kept in keeping(run))


def test_a_run_repeats_bit_for_bit():
    runs = [play(CHANGING, duration_s=1.0) for _ in range(2)]
    assert np.array_equal(*(run.recordings["robot2"].true_distance_m for run in runs))


def test_rendered_and_drawn_runs_agree_to_a_tenth_of_a_millimetre():
    short = formation("chain", robots=2, duration_s=2.0)
    kept = [play(short, transport=how).recordings["robot1"].true_distance_m for how in ("drawn", "in-process")]
    assert np.abs(kept[0] - kept[1]).max() < 5e-4


def test_another_transport_is_refused():
    with pytest.raises(ValueError, match="one of drawn, in-process, lcm"):
        play(CHANGING, transport="pigeon")

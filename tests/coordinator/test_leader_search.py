"""A leader that is lost is searched by turning in place, and in no other way."""

import math

import pytest
from ring_robot import FRAME_US, Robot, settings

from pilotfish import core
from pilotfish.core import Reason, Status
from pilotfish.errors import ConfigError


def lost(side=1.0, config=None, frames=600, **how):
    """Frames after the leader was last seen at 15 degrees on that side; the robot really turns as it is commanded."""
    robot = Robot(config)
    robot.core.set_setpoint(core.Setpoint(distance_m=1.1, bearing_rad=side * math.radians(15.0)))
    robot.steps(6, bearing_rad=side * math.radians(15.0))
    return robot, robot.steps(frames, False, **how)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_it_turns_to_where_the_leader_was_last_seen_and_never_translates(side):
    _, results = lost(side)
    assert all(result.command.linear_mps == 0.0 for result in results[4:])  # the last command is 100 ms good
    turning = [result for result in results if result.reason == Reason.turning_to_search]
    assert turning
    assert all(result.status == Status.lost for result in turning)
    assert side * turning[0].command.angular_radps > 0.0
    # It waits for 0.3 s first: nine frames.
    first = results.index(turning[0])
    assert first == pytest.approx(9, abs=1)


def test_it_gives_up_after_its_retries():
    # One sweep of +-60 degrees at 0.6 rad/s: beyond the leader by 60 + 15, back by 120, home by 60 degrees: 4.45 rad,
    # 7.4 s, and a little more to start and to stop. Without a retry it is over after 8 s, with one after twice that.
    def ended_s(retries):
        _, results = lost(config=settings(search={"max_retries": retries}), frames=700)
        turning = [k for k, result in enumerate(results) if result.command != core.Twist()]
        assert turning[-1] < 690
        return turning[-1] * FRAME_US * 1e-6

    once, twice = ended_s(0), ended_s(1)
    assert once == pytest.approx(7.4 + 0.3, abs=1.5)
    assert twice == pytest.approx(2 * once, abs=1.5)


def test_off_it_stands_still():
    _, results = lost(config=settings(search={"search_by_rotating": False}), frames=60)
    assert all(result.command == core.Twist() for result in results[4:])
    assert results[-1].status == Status.lost


def test_it_does_not_turn_without_fresh_ranges_all_around():
    robot, _ = lost(frames=30)
    assert robot.step(False).command.angular_radps != 0.0
    results = robot.steps(20, False, ranges=False)
    assert all(result.command == core.Twist() for result in results[5:])
    # With a sensor missing for good nothing is known of one direction.
    for _ in range(10):
        robot.now_us += FRAME_US
        scan = core.RangeScan(utime=robot.now_us, first_rad=-3.0, step_rad=0.25, ranges_m=[3.0] * 20)
        robot.core.set_ranges(scan, robot.now_us)
        result = robot.core.step_observation(robot.now_us, None, robot.now_us)
    assert result.command == core.Twist()


def test_it_does_not_turn_when_something_is_within_its_circle():
    _, results = lost(frames=60, surfaces=[(2.0, 0.2)])
    assert all(result.command == core.Twist() for result in results[4:])


def test_it_stops_when_pictures_stop():
    robot, results = lost(frames=30)
    assert results[-1].command.angular_radps != 0.0
    assert robot.core.command_at(robot.now_us + 99_000).reason == Reason.turning_to_search
    assert robot.core.command_at(robot.now_us + 101_000).command == core.Twist()


def test_a_stop_ends_it_and_a_leader_that_was_never_seen_is_not_searched():
    robot, _ = lost(frames=30)
    stop = core.Setpoint(distance_m=1.1, run=False)
    robot.core.set_setpoint(stop)
    assert robot.core.command_at(robot.now_us).command == core.Twist()
    assert all(result.command == core.Twist() for result in robot.steps(10, False))
    assert all(result.command == core.Twist() for result in Robot().steps(40, False))


def test_it_follows_again_when_the_leader_is_found():
    robot, _ = lost(frames=40)
    results = robot.steps(10, distance_m=1.6, bearing_rad=0.0)
    assert results[0].status == Status.tracking
    assert results[-1].command.linear_mps > 0.0


def test_a_search_without_ranges_is_refused_at_load():
    with pytest.raises(ConfigError, match=r"control\.search\.search_by_rotating: needs ranges all around"):
        Robot(settings(avoidance={"enabled": False}))

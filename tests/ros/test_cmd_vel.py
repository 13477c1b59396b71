"""The bridges drive a ROS robot's wheels, and stop them."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import lcm
import pytest
from cmd_vel_chain import SPEED_MPS, TWISTS, WITHIN_S, Chain, moves, now_us, twist_of

from pilotfish.lcmtypes.pilotfish.base_t import base_t

# The rule is 100 ms. What is more is left to a test machine that runs other things at the same time; how often 100 ms
# were kept is measured in docs/ros.md.
BOUND_US = 400_000


@pytest.fixture(scope="module")
def running(graph, url) -> Iterator[Chain]:
    with Chain(graph, url) as chain:
        yield chain


@pytest.fixture
def chain(running) -> Iterator[Chain]:
    """At the commanded speed."""
    yield running.driving()
    running.end_drivers()


def test_a_robot_is_told_zeros_before_anything_drives_it(running):
    running.wait(lambda heard: len(heard) >= 20, "twenty messages")
    assert not any(map(moves, running.listener.heard()))
    assert "no message of pilotfish-base yet" in running.bridge.stderr()


def test_a_robot_is_driven_within_the_limits_of_the_base(chain):
    twists = [twist_of(each) for each in chain.listener.heard()]
    speeds = [twist.linear.x for twist in twists]
    assert any(0 < speed < SPEED_MPS for speed in speeds), "pilotfish-base speeds up and does not jump"
    assert max(speeds) == SPEED_MPS
    assert {(t.linear.y, t.linear.z, t.angular.x, t.angular.y) for t in twists} == {(0.0, 0.0, 0.0, 0.0)}
    if chain.graph.name == "ros2":
        check_header(chain)


def check_header(chain):
    """Commands are stamped with the time at which pilotfish-base gave them."""
    given, bases = set(), lcm.LCM(chain.url)
    bases.subscribe("ROBOT1_BASE", lambda _, data: given.add(base_t.decode(data).utime))
    chain.listener.forget()
    chain.wait(lambda heard: sum(map(moves, heard)) >= 20, "twenty commands")
    while bases.handle_timeout(0):
        pass
    headers = [each.message.header for each in chain.listener.heard() if moves(each)]
    assert {header.frame_id for header in headers} == {"base_link"}
    stamps = [header.stamp.sec * 1_000_000 + header.stamp.nanosec // 1000 for header in headers]
    assert len([stamp for stamp in stamps if stamp in given]) >= 10  # the first were given before this listened


def test_when_the_coordinator_dies_zeros_are_published_and_go_on(chain):
    at_us = now_us()
    chain.commander.process.kill()
    assert chain.zeros_after(at_us) < BOUND_US


def test_when_the_base_is_stopped_zeros_are_published_and_go_on(chain):
    at_us = now_us()
    chain.base.process.send_signal(signal.SIGSTOP)
    assert chain.zeros_after(at_us) < BOUND_US
    # and when it goes on, so does the robot
    chain.base.process.send_signal(signal.SIGCONT)
    chain.reach_speed()


def test_when_both_are_stopped_at_once_the_bridge_counts_from_the_coordinators_last_command(chain):
    at_us = now_us()
    chain.base.process.send_signal(signal.SIGSTOP)
    chain.commander.process.send_signal(signal.SIGSTOP)
    assert chain.zeros_after(at_us) < BOUND_US


def test_a_subscriber_that_hangs_delays_no_other(chain):
    with chain.graph.listen(chain.topic, TWISTS[chain.graph.name]) as stuck:
        stuck.wait_until(lambda: bool(stuck.raw()), WITHIN_S, "a second subscriber")
        stuck.process.send_signal(signal.SIGSTOP)
        try:
            chain.listener.forget()
            chain.wait(lambda heard: len(heard) > 60, "sixty more messages")
            at_us = now_us()
            chain.commander.process.kill()
            assert chain.zeros_after(at_us) < BOUND_US
        finally:
            stuck.process.send_signal(signal.SIGCONT)


def test_a_bridge_that_ends_leaves_zeros(graph, url):
    """Here of the other kind of Twist, too."""
    options, ros_name = {
        "ros1": ("--stamped", "geometry_msgs/msg/TwistStamped"),
        "ros2": ("--no-stamped", "geometry_msgs/msg/Twist"),
    }[graph.name]
    with Chain(graph, url, options, ros_name=ros_name) as chain:
        chain.driving()
        if graph.name == "ros1":
            check_header(chain)
        assert chain.bridge.terminate() == 0
        chain.listener.wait_until(lambda: not moves(chain.listener.heard()[-1]), WITHIN_S, "a zero")

"""Odometry and pictures into LCM, status and leader out of it: through the bridges, in processes of their own.

What goes in and what comes out is encoded by rosbags and compared to the bit."""

from __future__ import annotations

import io
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

import lcm
import numpy as np
import pytest
from PIL import Image
from ros_graphs import Graph, Listener

from pilotfish.harness.child import Child
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.bot_core.pose_t import pose_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.observation_t import observation_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t

WITHIN_S = 20.0
UTIME = 1_700_000_123_456_789
GENERATOR = np.random.default_rng(20)


def odometry(graph: Graph, utime):
    """Straight ahead along the local x, so that no number is rounded on its way: then R is the identity."""
    make = graph.definitions.make
    covariance = GENERATOR.normal(size=36)
    x, y, z, vx, vy, wz = GENERATOR.normal(size=6)
    pose = make(
        "geometry_msgs/msg/Pose",
        make("geometry_msgs/msg/Point", x, y, z),
        make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0),
    )
    linear = make("geometry_msgs/msg/Vector3", vx, vy, 0.0)
    twist = make("geometry_msgs/msg/Twist", linear, make("geometry_msgs/msg/Vector3", 0.0, 0.0, wz))
    return make(
        "nav_msgs/msg/Odometry",
        graph.definitions.header(utime, "odom"),
        "base_link",
        make("geometry_msgs/msg/PoseWithCovariance", pose, covariance),
        make("geometry_msgs/msg/TwistWithCovariance", twist, covariance),
    )


def image(graph: Graph, utime, encoding, width, height, step):
    data = GENERATOR.integers(0, 256, step * height, dtype=np.uint8)
    header = graph.definitions.header(utime, "camera")
    return graph.definitions.make("sensor_msgs/msg/Image", header, height, width, encoding, 0, step, data)


def compressed(graph: Graph, utime):
    file = io.BytesIO()
    Image.fromarray(GENERATOR.integers(0, 256, (48, 64, 3), dtype=np.uint8)).save(file, "JPEG")
    data = np.frombuffer(file.getvalue(), dtype=np.uint8)
    return graph.definitions.make(
        "sensor_msgs/msg/CompressedImage", graph.definitions.header(utime, "camera"), "rgb8; jpeg compressed bgr8", data
    )


class Received:
    """By channel and stamp."""

    def __init__(self, url, kinds):
        self.bus, self.messages = lcm.LCM(url), defaultdict(dict)
        for channel, kind in kinds.items():
            self.bus.subscribe(channel, lambda channel, data, kind=kind: self.take(channel, kind.decode(data)))

    def take(self, channel, message):
        self.messages[channel][message.utime] = message

    def wait(self, child, channel, utimes):
        give_up_s = time.monotonic() + WITHIN_S
        while not set(utimes) <= set(self.messages[channel]):
            assert time.monotonic() < give_up_s, child.error(f"{sorted(self.messages[channel])} of {utimes}")
            self.bus.handle_timeout(50)
        return [self.messages[channel][utime] for utime in utimes]


@dataclass
class Running:
    """Three bridges and their peers, started at once."""

    motions: list[Any]
    pictures: list[Any]
    jpegs: list[Any]
    sensors: Child
    compressed: Child
    report: Child
    diagnostics: Listener
    leader: Listener
    received: Received


@pytest.fixture(scope="module")
def running(graph, url) -> Iterator[Running]:
    motions = [odometry(graph, UTIME + k) for k in range(3)]
    formats = ("rgb8", 64, 48, 200), ("mono8", 64, 48, 64), ("bgr8", 33, 7, 99), ("rgb8", 640, 480, 1920)
    pictures = [image(graph, UTIME + k, *each) for k, each in enumerate(formats)]
    refused = [image(graph, UTIME + 9, "yuv422", 64, 48, 128), image(graph, 0, "mono8", 4, 4, 4)]
    jpegs = [compressed(graph, UTIME + k) for k in range(2)]
    odom, raw, jpeg, status, leader = (graph.topic(name) for name in ("odom", "raw", "jpeg", "status", "leader"))
    lcm_url = ("--lcm-url", url)
    with ExitStack() as started:
        start = started.enter_context
        for topic, messages in ((odom, motions), (raw, [*pictures, *refused]), (jpeg, jpegs)):
            start(graph.publish(topic, messages))
        shown = ("--diagnostics", status, "--leader", leader, "--frame", "base")
        yield Running(
            motions,
            pictures,
            jpegs,
            start(graph.bridge("sensors", "robot1", "--odom", odom, "--image", raw, *lcm_url)),
            start(graph.bridge("sensors", "robot2", "--compressed", jpeg, *lcm_url)),
            start(graph.bridge("report", "robot1", *shown, *lcm_url)),
            start(graph.listen(status, "diagnostic_msgs/msg/DiagnosticArray")),
            start(graph.listen(leader, "geometry_msgs/msg/PoseStamped")),
            Received(url, {"ROBOT1_POSE": pose_t, "ROBOT1_IMAGE": image_t, "ROBOT2_IMAGE": image_t}),
        )


def test_odometry_reaches_the_coordinators_channel(running):
    received = running.received.wait(running.sensors, "ROBOT1_POSE", range(UTIME, UTIME + 3))
    for given, got in zip(running.motions, received, strict=True):
        position, twist = given.pose.pose.position, given.twist.twist
        assert got.pos == (position.x, position.y, position.z)
        assert got.orientation == (1.0, 0.0, 0.0, 0.0)
        assert got.vel == (twist.linear.x, twist.linear.y, 0.0)
        assert got.rotation_rate == (0.0, 0.0, twist.angular.z)


def test_pictures_reach_the_coordinators_channel_and_others_are_refused_by_name(running):
    received = running.received.wait(running.sensors, "ROBOT1_IMAGE", range(UTIME, UTIME + 4))
    for given, got in zip(running.pictures, received, strict=True):
        assert (got.width, got.height, got.row_stride) == (given.width, given.height, given.step)
        assert got.data == given.data.tobytes()
    bridge = running.sensors
    for reason in ("header.stamp is not set", "'yuv422': Pilotfish reads mono8, 8UC1, rgb8, bgr8"):
        bridge.wait_until(lambda reason=reason: reason in bridge.stderr(), WITHIN_S, "the reason of a refusal")
    assert not {UTIME + 9, 0} & set(running.received.messages["ROBOT1_IMAGE"])


def test_compressed_pictures_reach_the_coordinators_channel(running):
    received = running.received.wait(running.compressed, "ROBOT2_IMAGE", [UTIME, UTIME + 1])
    for given, got in zip(running.jpegs, received, strict=True):
        assert (got.width, got.height, got.pixelformat) == (64, 48, image_t.PIXEL_FORMAT_MJPEG)
        assert got.data == given.data.tobytes()


def test_the_status_and_the_leader_reach_ros(running, url):
    status = status_t()
    status.utime, status.status, status.text = UTIME, command_t.STATUS_LOST, "lost: größer"
    status.error_m, status.frame_rate_hz = 0.125, 29.5
    observation = observation_t()
    observation.utime, observation.detected = UTIME, True
    observation.distance_m, observation.bearing_rad, observation.heading_rad = 1.25, 0.3, -0.7
    bus, bridge, diagnostics, leader = lcm.LCM(url), running.report, running.diagnostics, running.leader

    def all_heard():
        bus.publish("ROBOT1_STATUS", b"no status")  # survived
        bus.publish("ROBOT1_STATUS", status.encode())
        bus.publish("ROBOT1_OBSERVATION", observation.encode())
        return levels(diagnostics) & {2} and leader.raw()

    bridge.wait_until(all_heard, WITHIN_S, "both messages")
    pose = leader.heard()[-1].message
    assert (pose.header.frame_id, pose.header.stamp.sec) == ("base", UTIME // 1_000_000)
    assert pose.header.stamp.nanosec == UTIME % 1_000_000 * 1000
    assert (pose.pose.position.x, pose.pose.position.y) == (1.25 * np.cos(0.3), 1.25 * np.sin(0.3))
    assert (pose.pose.orientation.z, pose.pose.orientation.w) == (np.sin(-0.35), np.cos(-0.35))
    (found,) = next(h for h in diagnostics.heard() if h.message.status[0].level == 2).message.status
    assert (found.name, found.message, found.hardware_id) == ("pilotfish: robot1", "lost: größer", "robot1")
    assert ("error_m", "0.125") in {(value.key, value.value) for value in found.values}
    # And when the coordinator falls silent, so it says (level 3: stale).
    diagnostics.forget()
    bridge.wait_until(lambda: 3 in levels(diagnostics), WITHIN_S, "staleness")


def levels(diagnostics):
    return {heard.message.status[0].level for heard in diagnostics.heard()}


def test_a_bridge_ends_with_0_when_it_is_told_to(running):
    bridges = running.sensors, running.compressed, running.report
    for bridge in bridges:
        bridge.process.terminate()
    assert [bridge.process.wait(WITHIN_S) for bridge in bridges] == [0, 0, 0]


WRONG = (
    (["sensors", "robot1", "--image", "/a", "--compressed", "/b"], 64, "--compressed"),
    (["cmd-vel", "no name"], 64, "no name"),
    (["report", "robot1", "--leader", "/a b"], 64, "'/a b' is no topic"),
)


def test_what_is_wrong_on_the_command_line_is_said_without_a_traceback(graph, monkeypatch):
    with ExitStack() as started:
        bridges = [started.enter_context(graph.bridge(*arguments)) for arguments, _, _ in WRONG]
        for name in ("ROS_MASTER_URI", "CYCLONEDDS_URI"):
            monkeypatch.setenv(name, "http://nobody.invalid:1")
        bridges.append(started.enter_context(graph.bridge("report", "robot1")))
        nobody = {"ros1": "no ROS master at http://nobody.invalid:1", "ros2": "DDS cannot be opened"}[graph.name]
        for bridge, (_, code, says) in zip(bridges, [*WRONG, ([], 69, nobody)], strict=True):
            assert bridge.process.wait(WITHIN_S) == code
            assert says in bridge.stderr()
            assert "Traceback" not in bridge.stderr()

"""A coordinator's messages on a bus, with the values that a test says."""

from __future__ import annotations

import io
import threading
import time

import lcm
import numpy as np
from PIL import Image

from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.lcmtypes.pilotfish import (
    base_t,
    command_t,
    counter_t,
    observation_t,
    stage_t,
    status_t,
    tag_detection_t,
)

NOW_US = 1_764_000_000_000_000
SESSION = 7_000_000_001


def status(**values) -> status_t:
    """Tracking, at a setpoint of 1.1 m and -10 deg."""
    message = status_t()
    message.utime, message.status, message.session = NOW_US, command_t.STATUS_TRACKING, SESSION
    message.error_m, message.error_change_m, message.output = -0.25, 0.002, 0.31
    message.setpoint_distance_m, message.setpoint_bearing_rad, message.setpoint_run = 1.1, np.radians(-10.0), True
    message.frame_rate_hz, message.processing_ms, message.latency_s = 29.7, 0.62, 0.0385
    message.latency_from_exposure = True
    for name, value in values.items():
        setattr(message, name, value)
    return message


def with_lists(message: status_t, *, strengths=(), counters=(), stages=()) -> status_t:
    """The lists of a status: {rule: strength}, {name: count}, (name, counts, max_ms)."""
    message.strengths = [0.0] * 56
    for rule, strength in dict(strengths).items():
        message.strengths[rule] = strength
    message.rejected = []
    for name, count in dict(counters).items():
        counter = counter_t()
        counter.name, counter.count = name, count
        message.rejected.append(counter)
    message.rejected_count = len(message.rejected)
    message.stages = []
    for name, counts, max_ms in stages:
        stage = stage_t()
        stage.name, stage.counts, stage.max_ms = name, counts, max_ms
        message.stages.append(stage)
    message.stage_count = len(message.stages)
    return message


def observation(tags: int = 2, **values) -> observation_t:
    """1.35 m away, 12.5 deg to the right, seen by so many tags."""
    message = observation_t()
    message.utime, message.detected = NOW_US, True
    message.distance_m, message.bearing_rad, message.heading_rad = 1.35, np.radians(-12.5), np.radians(4.0)
    message.reprojection_error_px = 0.12
    # cMo of a leader 1.3 m ahead of the camera: its x is the camera's z, its y the camera's -x, its z the camera's -y
    message.camera_from_leader = [[0.0, -1.0, 0.0, 0.29], [0.0, 0.0, -1.0, 0.2], [1.0, 0.0, 0.0, 1.3]]
    message.tags = []
    for k in range(tags):
        tag = tag_detection_t()
        left = 40.0 + 48.0 * k
        tag.id, tag.corners_px = k, [[left, 240.0], [left + 40, 240.0], [left + 40, 200.0], [left, 200.0]]
        message.tags.append(tag)
    message.tag_count = tags
    for name, value in values.items():
        setattr(message, name, value)
    return message


def command(**values) -> command_t:
    """0.321 m/s ahead, 0.25 rad/s to the right."""
    message = command_t()
    message.utime, message.session, message.status = NOW_US, SESSION, command_t.STATUS_TRACKING
    message.linear_mps, message.angular_radps, message.mac = 0.321, -0.25, bytes(32)
    for name, value in values.items():
        setattr(message, name, value)
    return message


def base(**values) -> base_t:
    """Wheels that drive and measure 0.3 m/s."""
    message = base_t()
    message.state, message.mac = base_t.STATE_DRIVING, bytes(32)
    message.linear_mps, message.measured, message.measured_linear_mps = 0.321, True, 0.3
    for name, value in values.items():
        setattr(message, name, value)
    return message


def gray_image(width: int = 640, height: int = 480, level: int = 128) -> np.ndarray:
    """With a gradient, so that an outline can be told from it."""
    return np.tile(np.linspace(level - 40, level + 40, width).astype(np.uint8), (height, 1))


def picture(image: np.ndarray, *, jpeg: bool = True, utime: int = NOW_US) -> image_t:
    """As a preview (JPEG) or as a camera's (raw)."""
    message = image_t()
    message.utime = utime
    message.height, message.width = image.shape
    if jpeg:
        file = io.BytesIO()
        Image.fromarray(image).save(file, "JPEG", quality=80)
        message.pixelformat, message.data = image_t.PIXEL_FORMAT_MJPEG, file.getvalue()
    else:
        message.pixelformat, message.row_stride = image_t.PIXEL_FORMAT_GRAY, image.shape[1]
        message.data = image.tobytes()
    message.size = len(message.data)
    return message


class RobotOnBus:
    """Sends its messages ten times a second, in a thread, until the end of the block; they may be replaced."""

    def __init__(self, url: str, robot: str = "robot1", **messages) -> None:
        self.bus = lcm.LCM(url)
        self.name, self.robot = robot, robot.upper()
        self.messages = {"STATUS": status(), "OBSERVATION": observation(), "COMMAND": command()} | messages
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def send(self, kind: str, data: bytes) -> None:
        """Any bytes, once."""
        self.bus.publish(f"{self.robot}_{kind}", data)

    def _run(self) -> None:
        due_s = time.monotonic()
        while not self._end.wait(max(0.0, due_s - time.monotonic())):
            due_s += 0.1
            for kind, message in tuple(self.messages.items()):
                self.send(kind, message if isinstance(message, bytes) else message.encode())

    def __enter__(self) -> RobotOnBus:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._end.set()
        self._thread.join()

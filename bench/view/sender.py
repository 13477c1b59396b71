"""A robot's messages and pictures on a bus, in a process of their own. A picture's utime is the wall clock just before
it is sent: that is its exposure here."""

from __future__ import annotations

import time

import lcm
import numpy as np

from bench.common import wire
from pilotfish import data, sim
from pilotfish.lcmtypes.pilotfish import command_t, observation_t, status_t, tag_detection_t

SPEED_MPS = 0.2


def pictures(count: int, *, jpeg: bool) -> list[bytearray]:
    """Encoded, 640x480, of a leader that drives ahead."""
    world = sim.World(sim.load_scenario(str(data.path("scenarios/line.yaml"))))
    robot = next(r.name for r in world.scenario.robots if r.follows)
    encoded = []
    for k in range(count):
        world.advance_to(k / 10)
        encoded.append(bytearray(wire.encode_image(world.capture(robot).image, utime=0, jpeg=jpeg)))
    return encoded


def send(url: str, rate_hz: float, picture_kind: str, picture_hz: float) -> None:
    """STATUS, OBSERVATION and COMMAND at a rate, pictures on PREVIEW (JPEG) or IMAGE (raw) at another, until killed."""
    bus, shown = lcm.LCM(url), pictures(20, jpeg=picture_kind == "PREVIEW")
    status, observation, command = _messages()
    start_s, sent_messages, sent_pictures = time.monotonic(), 0, 0
    while True:
        due_s = start_s + min(sent_messages / rate_hz, sent_pictures / picture_hz)
        time.sleep(max(0.0, due_s - time.monotonic()))
        now_s = time.monotonic() - start_s
        utime = time.time_ns() // 1000
        with_picture = now_s >= sent_pictures / picture_hz
        if with_picture:
            picture = shown[sent_pictures % len(shown)]
            picture[8:16] = utime.to_bytes(8, "big")  # behind the fingerprint
            bus.publish(f"ROBOT1_{picture_kind}", bytes(picture))
            sent_pictures += 1
        if now_s >= sent_messages / rate_hz:
            sent_messages += 1
            for kind, message in (("COMMAND", command), ("OBSERVATION", observation), ("STATUS", status)):
                message.utime = utime
                bus.publish(f"ROBOT1_{kind}", message.encode())


def _messages() -> tuple[status_t, observation_t, command_t]:
    status, observation, command = status_t(), observation_t(), command_t()
    status.status = command.status = command_t.STATUS_TRACKING
    status.session = command.session = 1
    status.setpoint_distance_m, status.setpoint_run = 1.1, True
    status.strengths = [1.0 if rule in (24, 31) else 0.0 for rule in range(56)]
    command.linear_mps, command.mac = SPEED_MPS, bytes(32)
    observation.detected, observation.distance_m = True, 1.2
    observation.camera_from_leader = [[0.0, -1.0, 0.0, 0.1], [0.0, 0.0, -1.0, 0.2], [1.0, 0.0, 0.0, 1.2]]
    corners = np.array([[0, 40], [40, 40], [40, 0], [0, 0]], float)
    for number in range(3):
        tag = tag_detection_t()
        tag.id, tag.corners_px = number, (corners + np.array([250 + 50 * number, 200])).tolist()
        observation.tags.append(tag)
    observation.tag_count = len(observation.tags)
    return status, observation, command

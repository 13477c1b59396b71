"""Faults that others commit on the bus while the camera goes on as ever."""

from __future__ import annotations

import random
import struct
import time

from robot import FORGED_SESSION, NAME, Robot

from pilotfish.bus import BaseReport, CommandReport, MotionReport, SetpointReport
from pilotfish.core import Setpoint, Status, Twist, monotonic_now_us

_FRAGMENT = 0x4C433033  # "LC03"
_KEPT_M, _KEPT_RAD = 1.10, -0.17453292519943295  # what the configuration says
_WITHIN_S = 5.0  # of robot time, for what an operator asks


def random_datagrams(robot: Robot, rng: random.Random, duration_s: float) -> None:
    end_s = robot.now_s + duration_s
    while robot.now_s < end_s:
        for _ in range(20):
            magic = rng.choice([b"", b"LC02", b"LC03", struct.pack(">I", _FRAGMENT)])
            robot.datagrams.send(magic + rng.randbytes(rng.randrange(0, 1400)))
        robot.show_good()


def _fragment(part: bytes, sequence: int, message_bytes: int, offset: int, number: int, fragments: int) -> bytes:
    return struct.pack(">IIIIHH", _FRAGMENT, sequence, message_bytes, offset, number, fragments) + part


def liblcm_killer(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """A fragment whose offset is 2^32 - 1 ends every program that receives with liblcm 1.3.1."""
    end_s = robot.now_s + duration_s
    while robot.now_s < end_s:
        sequence = rng.getrandbits(32)
        robot.datagrams.send(
            _fragment(b"X\0" + bytes(41), sequence, 64, 0, 0, 3), _fragment(bytes(44), sequence, 64, 2**32 - 1, 1, 3)
        )
        robot.show_good()


def endless_fragments(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """Beginnings of messages of up to 16 MB on the pictures' and the commands' channels."""
    end_s = robot.now_s + duration_s
    while robot.now_s < end_s:
        for _ in range(10):
            channel = rng.choice([b"ROBOT1_IMAGE\0", b"ROBOT1_COMMAND\0", b"ROBOT1_SETPOINT\0"])
            part, fragments = rng.randbytes(rng.randrange(1, 1200)), rng.randrange(2, 16000)
            message_bytes = rng.randrange(2000, 16_000_000)
            robot.datagrams.send(_fragment(channel + part, rng.getrandbits(32), message_bytes, 0, 0, fragments))
        robot.show_good()


def forgeries(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """From a sender with everything but the key: the sessions, and counters that would be accepted."""
    end_s = robot.now_s + duration_s
    moving = Twist(linear_mps=0.6, angular_radps=1.0)
    while robot.now_s < end_s:
        robot.unauthorised_bus.publish_command(
            NAME,
            CommandReport(
                utime=robot.now_us(),
                session=rng.choice([robot.session, rng.getrandbits(62)]),
                counter=2**62,
                base_session=robot.base_session,
                valid_until_us=monotonic_now_us() + 100_000,
                command=moving,
                simulated=True,
                status=Status.tracking,
            ),
        )
        _publish(robot, robot.unauthorised_bus, distance_m=rng.uniform(0.05, 5.0), run=True)
        robot.unauthorised_bus.publish_base(NAME, BaseReport(utime=0, session=FORGED_SESSION, command=moving))
        robot.show_good()


def setpoint_flood(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """Many with every picture, from an authorised sender."""
    end_s = robot.now_s + duration_s
    while robot.now_s < end_s:
        for _ in range(100):
            _publish(robot, robot.authorised_bus, distance_m=rng.uniform(1.0, 1.2), run=True)
        robot.show_good()
    _publish(robot, robot.authorised_bus, distance_m=_KEPT_M, run=True)


def stop_and_resume(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """A stop from the operator or from a sender without the key, accepted as well; the resume is the operator's."""
    who = rng.choice([robot.authorised_bus, robot.unauthorised_bus])
    _ask_until(robot, lambda: _publish(robot, who, distance_m=_KEPT_M, run=False), stopped=True)
    end_s = robot.now_s + duration_s
    while robot.now_s < end_s:
        robot.show_good()
        if robot.moving:
            robot.violations.append(f"stop-resume: moves although stopped, at {robot.now_s:.1f} s of robot time")
    _ask_until(robot, lambda: _publish(robot, robot.authorised_bus, distance_m=_KEPT_M, run=True), stopped=False)


def false_intents(robot: Robot, rng: random.Random, duration_s: float) -> None:
    end_s = robot.now_s + duration_s
    while robot.now_s < end_s:
        false_twist = Twist(linear_mps=rng.uniform(-2, 2), angular_radps=rng.uniform(-3, 3))
        stamp_us = robot.now_us() + rng.choice([0, 0, 0, -(10**6), 10**9])
        robot.authorised_bus.publish_motion("leader", MotionReport(utime=stamp_us, twist=false_twist))
        robot.show_good()


def second_camera(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """Its pictures, in which there is no leader, come between those of the first."""
    end_s, gray = robot.now_s + duration_s, robot.pictures.bad["gray"]
    while robot.now_s < end_s:
        robot.show_good()
        stamp_us = robot.now_us() + round(robot.period_s * 1e6 * rng.uniform(0.2, 0.8))
        robot.send(gray[robot.frames % len(gray)], stamp_us)


def second_coordinator(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """With the key and a session of its own. Both send zeros, until a second after the last of its commands."""
    end_s, session, counter = robot.now_s + duration_s, rng.getrandbits(62) | 1, 0
    while robot.now_s < end_s:
        counter += 1
        command = CommandReport(
            utime=robot.now_us(), session=session, counter=counter, base_session=robot.base_session, simulated=True
        )
        robot.authorised_bus.publish_command(NAME, command)
        robot.show_good()


def _publish(robot: Robot, who: object, *, distance_m: float, run: bool) -> None:
    robot.counter = max(robot.counter + 1, time.time_ns() // 1000)
    setpoint = Setpoint(distance_m=distance_m, bearing_rad=_KEPT_RAD, run=run)
    report = SetpointReport(utime=robot.now_us(), session=robot.session, counter=robot.counter, setpoint=setpoint)
    who.publish_setpoint(NAME, report)


def _ask_until(robot: Robot, ask: object, *, stopped: bool) -> None:
    """As an operator does: again with every picture, until it shows, at the coordinator and at the wheels."""
    end_s = robot.now_s + _WITHIN_S
    while robot.now_s < end_s:
        ask()
        robot.show_good()
        if (robot.status == Status.stopped) == stopped and robot.base_stopped == stopped:
            return
    robot.violations.append(f"stop-resume: {'no stop' if stopped else 'no resume'} within {_WITHIN_S} s")

"""The real pilotfish-coordinator on a camera that the test plays (fake_camera.py), and the faults to play."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import lcm
import numpy as np

from fake_camera import NUMBER, FakeCamera, blurred, encode, noisy
from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from scenes import leader_pictures

LINE_CONFIG = shipped.path("config/line.yaml")


def leader_camera(folder: Path, *, format: str = "GREY", rate_hz: int = 30) -> FakeCamera:
    """Sees a leader that stands 2.4 m ahead, farther than it should (so the robot drives), with the noise of a sensor.
    Further series: black, saturated, blurred, empty (no leader), frozen (one picture, for ever), cut_off (MJPG)."""
    return FakeCamera(folder, _series(format), format=format, rate_hz=rate_hz)


@cache
def _series(format: str) -> dict[str, list[np.ndarray | bytes]]:
    """Made once: the noise takes as long as a test."""
    if format == "MJPG":
        whole = [encode(picture, format) for picture in _series("GREY")["leader"]]
        return _series("GREY") | {"cut_off": [jpeg[: len(jpeg) * 2 // 3] for jpeg in whole]}
    if format != "GREY":
        return _series("GREY")
    image = leader_pictures(1)[0].image
    return {
        "leader": noisy(image),
        "black": noisy(np.full_like(image, 16)),
        "saturated": [np.full_like(image, 255)],
        "blurred": noisy(blurred(image)),
        "empty": noisy(np.full_like(image, 128)),
        "frozen": noisy(image, count=1),
    }


def _set(**values: int) -> Callable[[FakeCamera], None]:
    def apply(camera: FakeCamera) -> None:
        for name, value in values.items():
            setattr(camera, name, value)

    return apply


# What a camera can do wrong: each must stop the robot, and end with the fault. Value: the camera's format, and how.
CAMERA_FAULTS: dict[str, tuple[str, Callable[[FakeCamera], None]]] = {
    "pulled out": ("GREY", _set(pulled_out=1)),
    "blocked": ("GREY", _set(blocked=1)),
    "covered: black": ("GREY", lambda camera: camera.show("black")),
    "saturated": ("GREY", lambda camera: camera.show("saturated")),
    "blurred": ("GREY", lambda camera: camera.show("blurred")),
    "leader out of sight": ("GREY", lambda camera: camera.show("empty")),
    "frozen": ("GREY", lambda camera: camera.show("frozen")),
    "buffers 400 ms old": ("GREY", _set(late_us=400_000)),
    "stamps 1 s of the past": ("GREY", _set(stamp_shift_us=-1_000_000)),
    "stamps 1 s of the future": ("GREY", _set(stamp_shift_us=1_000_000)),
    "buffers marked as damaged": ("YUYV", _set(error_flag=1)),
    "buffers too short": ("YUYV", _set(bytes_short=1000)),
    "buffers that claim too much": ("YUYV", _set(bytes_short=-(10**7))),
    "JPEG cut off": ("MJPG", lambda camera: camera.show("cut_off")),
}


class CameraRobot:
    """A running coordinator and the commands it sends. Use as a context manager."""

    def __init__(self, camera: FakeCamera, folder: Path, *options: str, config: Path = LINE_CONFIG) -> None:
        self.camera = camera
        self.commands: list[command_t] = []
        url = private_lcm_url()
        self.bus = lcm.LCM(url)
        self.bus.subscribe("ROBOT1_COMMAND", lambda _, data: self.commands.append(command_t.decode(data)))
        program = find_executable(COORDINATOR)
        source = ["--source", f"camera:{NUMBER}"]
        command = [*camera.prefix(), program, "--config", config, "--lcm-url", url, *source, *options]
        self.child = Child(command, folder, "robot1")

    def __enter__(self) -> CameraRobot:
        return self

    def __exit__(self, *_: object) -> None:
        self.child.terminate()

    def listen_until(self, condition: Callable[[], bool], what: str, timeout_s: float = 20.0) -> None:
        """Handles messages until the condition holds; fails after timeout_s."""
        deadline = time.monotonic() + timeout_s
        while not condition():
            assert time.monotonic() < deadline, self.child.error(f"{what}: not within {timeout_s} s")
            assert self.child.process.poll() is None, self.child.error(f"ended before {what}")
            self.bus.handle_timeout(20)

    def drives(self, count: int = 10) -> None:
        """Waits for so many moving commands in a row, from a measurement of their own frame."""
        first = len(self.commands)

        def run_of_moving() -> bool:
            last = self.commands[first:][-count:]
            return len(last) == count and all(is_moving(c) and c.status == command_t.STATUS_TRACKING for c in last)

        self.listen_until(run_of_moving, f"{count} moving commands in a row")

    def stands(self, count: int = 30) -> None:
        """Waits for the first zero command, then for so many more: all of them must be zero."""
        first = len(self.commands)
        self.listen_until(lambda: any(not is_moving(c) for c in self.commands[first:]), "a zero command")
        zero = next(k for k in range(first, len(self.commands)) if not is_moving(self.commands[k]))
        self.listen_until(lambda: len(self.commands) >= zero + count, f"{count} commands")
        moving = [c for c in self.commands[zero:] if is_moving(c)]
        assert moving == [], f"{len(moving)} of {len(self.commands) - zero} commands move, although the camera is bad"


def is_moving(command: command_t) -> bool:
    return (command.linear_mps, command.angular_radps) != (0.0, 0.0)

"""Drives the real pilotfish-coordinator as a robot would: images and setpoints in over LCM, commands out."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import lcm

from pilotfish import coordinator, core
from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.setpoint_t import setpoint_t

LINE_CONFIG = shipped.path("config/line.yaml")
FOURCC_GRAY = 1497715271  # bot_core's PIXEL_FORMAT_GRAY


class Onboard:
    """A running coordinator with the bus around it. Use as a context manager."""

    def __init__(
        self, folder: Path, *options: str, config: Path = LINE_CONFIG, robot: str = "robot1", simulated: bool = True
    ) -> None:
        self.url = private_lcm_url()
        self.robot = robot
        self.commands: list[command_t] = []
        self.bus = lcm.LCM(self.url)
        self.bus.subscribe(f"{robot.upper()}_COMMAND", lambda _, data: self.commands.append(command_t.decode(data)))
        program = find_executable(COORDINATOR)
        command = [program, "--config", config, "--lcm-url", self.url, "--json", *options]
        if simulated:  # images are sent as fast as they are answered
            command.append("--simulated-time")
        self.child = Child(command, folder, robot)

    def __enter__(self) -> Onboard:
        self.child.wait_until(lambda: " ready: " in self.child.stderr(), 20.0, "being ready")
        return self

    def __exit__(self, *_: object) -> None:
        self.child.terminate()

    def send_image(self, frame: core.Frame) -> None:
        message = image_t()
        message.utime = frame.utime
        message.width, message.height, message.row_stride = frame.width, frame.height, frame.width
        message.pixelformat = FOURCC_GRAY
        message.data = frame.image.tobytes()
        message.size = len(message.data)
        self.bus.publish(f"{self.robot.upper()}_IMAGE", message.encode())

    def send_setpoint(self, distance_m: float, bearing_rad: float, run: bool) -> None:
        """Names the session that the coordinator says with its commands, and a counter that rises: the wall clock."""
        message = setpoint_t()
        message.session = self.commands[-1].session if self.commands else 0
        message.utime = message.counter = time.time_ns() // 1000
        message.mac = bytes(32)
        message.distance_m, message.bearing_rad, message.run = distance_m, bearing_rad, run
        self.bus.publish(f"{self.robot.upper()}_SETPOINT", message.encode())

    def listen_until(self, condition: Callable[[], bool], what: str, timeout_s: float = 10.0) -> None:
        """Handles messages until the condition holds; fails after timeout_s."""
        deadline = time.monotonic() + timeout_s
        while not condition():
            assert time.monotonic() < deadline, self.child.error(f"{what}: not within {timeout_s} s")
            self.bus.handle_timeout(20)

    def answer_to(self, frame: core.Frame) -> command_t:
        """Sends the image, again every 50 ms like the simulator in lock-step, until its command comes."""
        first = len(self.commands)

        def answered() -> bool:
            return any(command.utime == frame.utime for command in self.commands[first:])

        deadline = time.monotonic() + 10.0
        while not answered():
            assert time.monotonic() < deadline, self.child.error(f"no command for utime {frame.utime}")
            self.send_image(frame)
            resend_at = time.monotonic() + 0.05
            while not answered() and time.monotonic() < resend_at:
                self.bus.handle_timeout(5)
        return next(command for command in self.commands[first:] if command.utime == frame.utime)


def same_in_process(frames: list[core.Frame], config: Path = LINE_CONFIG) -> list[coordinator.StepResult]:
    """What Coordinator.step says to these frames: the program around it must change nothing."""
    follower = coordinator.Coordinator(coordinator.load_coordinator(str(config)).coordinator)
    return [follower.step(frame, frame.utime) for frame in frames]

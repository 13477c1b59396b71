"""The last good picture, then something goes wrong: how long until a zero is on the bus?

Pictures come at the camera's rate over LCM to a real pilotfish-coordinator. After a random number of them the fault
begins. The clock runs from just before the last good picture is sent to the kernel's time stamp of the first zero
command, so that neither the scheduling of this script nor Python is in it.
"""

from __future__ import annotations

import random
import tempfile
import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import lcm
import numpy as np
import yaml

from bench.common.configuration import shipped_coordinator
from bench.common.processes import process, real_time, work
from pilotfish import bus, core, data, sim
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.bot_core.image_t import image_t

FAULTS = {
    "no-pictures": "pictures stop",
    "gray": "no leader in the pictures",
    "frozen": "the same picture again and again",
    "backward": "stamps run backward",
}
WITHIN_S = 5.0


@dataclass
class Loss:
    """In milliseconds from the last good picture."""

    zero_ms: list[float] = field(default_factory=list)
    moved_after: int = 0  # commands that move the robot behind the first zero


def measure(fault: str, repetitions: int, *, rate_hz: float = 30.0, busy_loops: int = 0) -> Loss:
    """Many times, with one coordinator. Raises HarnessError if the robot cannot be made to move."""
    rng = random.Random(9)
    loss = Loss()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        url = private_lcm_url()
        for _ in range(busy_loops):
            stack.enter_context(process(work))
        command = [find_executable(COORDINATOR), "--config", _config(Path(folder), rate_hz), "--lcm-url", url]
        child = stack.enter_context(Child(command, Path(folder), "coordinator"))
        child.wait_until(lambda: "ready:" in child.stdout(), 20.0, "being ready")
        stack.callback(real_time, 0)
        real_time(10)
        camera = _Camera(url, rate_hz, child)
        for _ in range(repetitions):
            camera.drive(rng.randrange(3, 8))
            camera.begin_fault(fault)
            loss.zero_ms.append(1e-3 * (camera.zero_us - camera.last_good_us))
            loss.moved_after += camera.moved_after
    return loss


class _Camera:
    """Shows the leader, or what the fault shows, and hears the commands."""

    def __init__(self, url: str, rate_hz: float, child: Child) -> None:
        self.child, self.period_s = child, 1.0 / rate_hz
        world = sim.World(sim.load_scenario(str(data.path("scenarios/line.yaml"))))
        robot = next(r.name for r in world.scenario.robots if r.follows)
        self.pictures = []
        for k in range(30):
            world.advance_to(k / 30)
            self.pictures.append(world.capture(robot).image.tobytes())
        rng = np.random.default_rng(1)
        self.grays = [(128 + rng.integers(-3, 4, (480, 640))).astype(np.uint8).tobytes() for _ in range(30)]
        self.out = lcm.LCM(url)
        self.receiver = bus.Bus(url)
        self.receiver.on_command("robot1", self._on_command)
        self.sent = 0
        self.next_s = time.monotonic()
        self.last_good_us = self.zero_us = 0
        self.moving = False
        self.watching, self.moved_after = False, 0

    def drive(self, frames: int) -> None:
        """At least so many pictures of the leader, until the robot moves."""
        end_s = time.monotonic() + WITHIN_S
        shown = 0
        self.watching = False
        while shown < frames or not self.moving:
            if time.monotonic() > end_s:
                raise self.child.error("the robot does not move")
            self._show(self.pictures[self.sent % 30], time.monotonic_ns() // 1000)
            self.sent += 1
            shown += 1
            last = shown >= frames and self.moving
            if not last:
                self._pass_a_period()

    def begin_fault(self, fault: str) -> None:
        """Until a zero has been received, and a quarter of a second longer."""
        self.watching, self.zero_us, self.moved_after = True, 0, 0
        stamp, last_picture = time.monotonic_ns() // 1000, self.pictures[(self.sent - 1) % 30]
        end_s, k = time.monotonic() + WITHIN_S, 0
        stop_s = None
        while stop_s is None or time.monotonic() < stop_s:
            self._pass_a_period()
            k += 1
            if fault == "gray":
                self._show(self.grays[k % 30], time.monotonic_ns() // 1000, good=False)
            elif fault == "frozen":
                self._show(last_picture, time.monotonic_ns() // 1000, good=False)
            elif fault == "backward":
                self._show(self.grays[k % 30], stamp - k * 33_333, good=False)
            if self.zero_us and stop_s is None:
                stop_s = time.monotonic() + 0.25
            if time.monotonic() > end_s:
                raise self.child.error("no zero came")

    def _show(self, pixels: bytes, utime: int, good: bool = True) -> None:
        message = image_t()
        message.utime, message.width, message.height, message.row_stride = utime, 640, 480, 640
        message.pixelformat, message.data, message.size = 1497715271, pixels, len(pixels)
        encoded = message.encode()
        if good:
            self.last_good_us = core.monotonic_now_us()
        self.out.publish("ROBOT1_IMAGE", encoded)

    def _pass_a_period(self) -> None:
        self.next_s = max(self.next_s + self.period_s, time.monotonic())
        while (left_s := self.next_s - time.monotonic()) > 0:
            self.receiver.handle(max(int(left_s * 1e3), 1))

    def _on_command(self, report: bus.CommandReport) -> None:
        self.moving = report.command.linear_mps != 0.0 or report.command.angular_radps != 0.0
        at_us = self.receiver.arrival_us
        if not self.watching or at_us < self.last_good_us:
            return
        if not self.moving and self.zero_us == 0:
            self.zero_us = at_us
        elif self.moving and self.zero_us:
            self.moved_after += 1


def _config(folder: Path, rate_hz: float) -> Path:
    """The shipped configuration; a slow camera's with a longer life of measurements and less speed."""
    config = shipped_coordinator()
    config["frame_rate_hz"] = rate_hz
    if rate_hz < 12.0:
        config["safety"] = {"max_age_s": 0.25}
        config["control"]["limits"]["max_linear_mps"] = 0.24
        config["control"]["limits"]["max_reverse_mps"] = 0.24
    file = folder / "coordinator.yaml"
    file.write_text(yaml.safe_dump(config))
    return file

"""The sender of commands is killed or stopped while the wheels turn: how long until they are commanded zero?

A child process sends 30 commands a second, as a coordinator does. At a random instant it gets the signal; the clock
runs from just before the signal to the moment when the first zero has been read at the other end of the serial line. A
real line adds the time that 20 bytes need on it (2 ms at 115200 baud).
"""

from __future__ import annotations

import os
import random
import select
import signal
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import lcm
import yaml
from serial_line import SerialLine

from bench.common.processes import process, real_time, work
from pilotfish import core, data
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.pilotfish.base_t import base_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t

COMMANDS_PER_S = 30.0
PATIENCE_S = 10.0


@dataclass(frozen=True)
class Kind:
    words: str
    signal: signal.Signals


KINDS = {"kill": Kind("SIGKILL", signal.SIGKILL), "stop": Kind("SIGSTOP", signal.SIGSTOP)}


@dataclass
class Deadline:
    """In milliseconds from the signal."""

    line_ms: list[float] = field(default_factory=list)  # to the first zero on the serial line
    bus_ms: list[float] = field(default_factory=list)  # to the first zero on NAME_BASE
    moved_after: int = 0  # lines that move the wheels behind the first zero


def measure(kind: str, repetitions: int, *, busy_loops: int = 0) -> Deadline:
    """Many times, with one pilotfish-base. Raises HarnessError if the wheels cannot be made to turn."""
    rng = random.Random(8)
    deadline = Deadline()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        line, url = SerialLine(), private_lcm_url()
        stack.callback(line.close)
        for _ in range(busy_loops):
            stack.enter_context(process(work))
        base = stack.enter_context(Child(_command(Path(folder), line.device, url), Path(folder), "base"))
        stack.callback(real_time, 0)
        real_time(10)
        wheels = _Wheels(line, url, base)
        wheels.wait(lambda: bool(wheels.session), "pilotfish-base did not answer")
        sender = stack.enter_context(process(_send, url, wheels.session))
        for _ in range(repetitions):
            wheels.wait(lambda: wheels.moving, "the wheels do not turn")
            wheels.watch(rng.uniform(0.05, 0.15))
            sent_s = wheels.begin()
            os.kill(sender.pid or 0, KINDS[kind].signal)
            wheels.wait(lambda: wheels.line_zero_s > 0 and wheels.bus_zero_s > 0, "no zero")
            deadline.line_ms.append(1e3 * (wheels.line_zero_s - sent_s))
            deadline.bus_ms.append(1e3 * (wheels.bus_zero_s - sent_s))
            wheels.watch(0.06)
            deadline.moved_after += wheels.moved_after
            sender.kill()  # one that was stopped, too: what it would send next belongs to no run
            sender = stack.enter_context(process(_send, url, wheels.session))
    return deadline


class _Wheels:
    """What they are commanded, on the line and as the base says it on the bus."""

    def __init__(self, line: SerialLine, url: str, base: Child) -> None:
        self.session = 0
        self.moving = False
        self._line, self._base = line, base
        self._bus = lcm.LCM(url)
        self._bus.subscribe("ROBOT1_BASE", self._heard)
        self.begin()

    def begin(self) -> float:
        """From now on the first zeros are looked for."""
        self.line_zero_s = self.bus_zero_s = 0.0
        self.moved_after = 0
        return time.monotonic()

    def watch(self, seconds: float) -> None:
        end_s = time.monotonic() + seconds
        while (left_s := end_s - time.monotonic()) > 0:
            select.select([self._line, self._bus.fileno()], [], [], left_s)
            for at_s, moves in self._line.read():
                self.moving = moves
                if moves:
                    self.moved_after += self.line_zero_s > 0
                elif self.line_zero_s == 0:
                    self.line_zero_s = at_s
            self._bus.handle_timeout(0)

    def wait(self, condition: Callable[[], bool], problem: str) -> None:
        end_s = time.monotonic() + PATIENCE_S
        while not condition():
            self.watch(0.002)
            if time.monotonic() > end_s:
                raise self._base.error(problem)

    def _heard(self, _: str, data: bytes) -> None:
        message = base_t.decode(data)
        self.session = message.session
        if message.linear_mps == 0.0 and self.bus_zero_s == 0:
            self.bus_zero_s = time.monotonic()


def _command(folder: Path, device: str, url: str) -> list[str | Path]:
    """The shipped configuration; but the next sender is obeyed sooner, which saves a quarter of an hour."""
    config = yaml.safe_load(data.path("config/base.yaml").read_text())
    config["commands"]["takeover_s"] = 0.25
    file = folder / "base.yaml"
    file.write_text(yaml.safe_dump(config))
    return [find_executable(BASE), "--config", file, "--driver", f"serial:{device}", "--lcm-url", url]


def _send(url: str, base_session: int) -> None:
    real_time(10)
    bus = lcm.LCM(url)
    message = command_t()
    message.mac = bytes(32)
    message.session, message.base_session = random.SystemRandom().getrandbits(62) + 1, base_session
    message.linear_mps, message.status = 0.5, command_t.STATUS_TRACKING
    next_s = time.monotonic()
    while True:
        message.counter += 1
        message.valid_until_us = core.monotonic_now_us() + 100_000
        bus.publish("ROBOT1_COMMAND", message.encode())
        next_s = max(next_s + 1 / COMMANDS_PER_S, time.monotonic())
        time.sleep(max(next_s - time.monotonic(), 0.0))

"""The sender of commands is killed or stopped while the wheels turn: how long until they are told zero?

A child process sends 30 commands a second, as a coordinator does. At a random instant it gets the signal; the clock
runs from just before the signal to the moment when the first zero has been read at the other end of the serial line. A
real line adds the time that 20 bytes need on it (2 ms at 115200 baud).
"""

from __future__ import annotations

import math
import multiprocessing
import os
import random
import signal
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path

import lcm
import yaml
from serial_line import SerialLine

from pilotfish import data
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
    to_zero_ms: list[float] = field(default_factory=list)
    moved_after: int = 0  # lines that move the wheels behind the first zero

    @property
    def worst_ms(self) -> float:
        return max(self.to_zero_ms)

    def quantile(self, share: float) -> float:
        ordered = sorted(self.to_zero_ms)
        return ordered[min(math.ceil(share * len(ordered)), len(ordered)) - 1]


def measure(kind: str, repetitions: int, *, busy_loops: int = 0) -> Deadline:
    """Many times, with one pilotfish-base. Raises RuntimeError if the wheels cannot be made to turn."""
    rng = random.Random(8)
    deadline = Deadline()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        stack.callback(_as_the_system_has_it)
        line, url = SerialLine(), private_lcm_url()
        stack.callback(line.close)
        for _ in range(busy_loops):
            stack.enter_context(_Busy())
        base = stack.enter_context(Child(_command(kind, Path(folder), line.device, url), Path(folder), "base"))
        session = _session_of_base(url, line, base)
        _measure_in_real_time()
        sender = stack.enter_context(_Sender(url, session))
        for _ in range(repetitions):
            _turning(line, base)
            _listen(line, rng.uniform(0.05, 0.15))
            sent_s = time.monotonic()
            sender.signal(KINDS[kind].signal)
            zero_s = next(at_s for at_s, moves in line.read(PATIENCE_S) if not moves)
            deadline.to_zero_ms.append(1e3 * (zero_s - sent_s))
            deadline.moved_after += _listen(line, 0.06)
            if kind == "kill":
                sender.close()
                sender = stack.enter_context(_Sender(url, session))
            else:
                sender.signal(signal.SIGCONT)
    return deadline


def _command(kind: str, folder: Path, device: str, url: str) -> list[str | Path]:
    """The shipped configuration, but the next sender is obeyed sooner, which saves a quarter of an hour; and one that
    was stopped may go on, however long the computer takes to let it."""
    config = yaml.safe_load(data.path("config/base.yaml").read_text())
    config["commands"]["takeover_s"] = 0.2 if kind == "kill" else 10.0
    file = folder / "base.yaml"
    file.write_text(yaml.safe_dump(config))
    return [find_executable(BASE), "--config", file, "--driver", f"serial:{device}", "--lcm-url", url]


def _session_of_base(url: str, line: SerialLine, base: Child) -> int:
    heard: list[int] = []
    bus = lcm.LCM(url)
    bus.subscribe("ROBOT1_BASE", lambda _, message: heard.append(base_t.decode(message).session))
    _wait(lambda: bool(bus.handle_timeout(5) >= 0 and heard), line, base, "pilotfish-base did not speak")
    return heard[-1]


def _turning(line: SerialLine, base: Child) -> None:
    _wait(lambda: any(moves for _, moves in line.read(0.01)), line, base, "the wheels do not turn")


def _wait(condition: Callable[[], bool], line: SerialLine, base: Child, problem: str) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not condition():
        _listen(line, 0.005)
        if time.monotonic() > end_s:
            raise base.error(problem)


def _listen(line: SerialLine, seconds: float) -> int:
    """How many lines moved the wheels in this time."""
    end_s, moving = time.monotonic() + seconds, 0
    while (left_s := end_s - time.monotonic()) > 0:
        for _, moves in line.read(left_s):
            moving += moves
            if time.monotonic() >= end_s:
                break
    return moving


class _Sender:
    """A process that sends commands, as quickly begun as ended: a fork."""

    def __init__(self, url: str, base_session: int) -> None:
        self._process = multiprocessing.get_context("fork").Process(target=_send, args=(url, base_session), daemon=True)
        self._process.start()

    def __enter__(self) -> _Sender:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def signal(self, number: signal.Signals) -> None:
        assert self._process.pid
        os.kill(self._process.pid, number)

    def close(self) -> None:
        self._process.kill()
        self._process.join()


def _send(url: str, base_session: int) -> None:
    _as_the_system_has_it()
    bus = lcm.LCM(url)
    message = command_t()
    message.mac = bytes(32)
    message.session, message.base_session = random.SystemRandom().getrandbits(62) + 1, base_session
    message.linear_mps, message.status = 0.5, command_t.STATUS_TRACKING
    next_s = time.monotonic()
    while True:
        message.counter += 1
        bus.publish("ROBOT1_COMMAND", message.encode())
        next_s = max(next_s + 1 / COMMANDS_PER_S, time.monotonic())
        time.sleep(max(next_s - time.monotonic(), 0.0))


class _Busy:
    """A process that does nothing but work."""

    def __enter__(self) -> None:
        self._process = multiprocessing.get_context("fork").Process(target=_work, daemon=True)
        self._process.start()

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.join()


def _work() -> None:
    while True:
        pass


def _measure_in_real_time() -> None:
    """So that what is measured is the base and not how long this script waits for a core."""
    with suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))


def _as_the_system_has_it() -> None:
    with suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))

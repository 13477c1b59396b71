"""The link between a coordinator's host and the wheels' goes down while they turn: how long until they stand?

A sender gives commands as a coordinator does, good for 100 ms, from one host to a real pilotfish-base on another. The
clock runs from just before the link is taken down to the first zero that the base publishes on its own host.
"""

from __future__ import annotations

import random
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import lcm
from forward import BUFFER, SHARED_URL
from hosts import hosts

from pilotfish import core, data
from pilotfish.errors import HarnessError
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, find_executable
from pilotfish.lcmtypes.pilotfish.base_t import base_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t

PATIENCE_S = 10.0


def stopping_ms(repetitions: int) -> list[float]:
    """From the link's end to the first zero. To be called in a network namespace of the caller's own."""
    rng = random.Random(23)
    found: list[float] = []
    with ExitStack() as stack:
        lan = stack.enter_context(hosts(["robot1", "wheels"], "none", seed=1, switch="relay"))
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="pilotfish-network-")))
        url = SHARED_URL + BUFFER
        words = [find_executable(BASE), "--config", data.path("config/base.yaml"), "--driver", "dry_run"]
        base = stack.enter_context(Child(lan["wheels"].command([*words, "--lcm-url", url]), folder, "base"))
        with lan["wheels"].entered():
            heard = _Heard(url)
        with lan["robot1"].entered():
            sender = _Sender(url)
        stack.callback(sender.end)
        for _ in range(repetitions):
            heard.until(lambda: heard.speed_mps > 0, base)
            heard.listen(rng.uniform(0.05, 0.15))
            down_s = time.monotonic()
            lan["robot1"].set_down("link", True)
            heard.until(lambda: heard.speed_mps == 0, base)
            found.append(1e3 * (heard.at_s - down_s))
            lan["robot1"].set_down("link", False)
    return found


class _Heard:
    """What the base says on its own host."""

    def __init__(self, url: str) -> None:
        self.speed_mps = self.at_s = 0.0
        self._bus = lcm.LCM(url)
        self._bus.subscribe("ROBOT1_BASE", self._take)

    def listen(self, seconds: float) -> None:
        end_s = time.monotonic() + seconds
        while (left_s := end_s - time.monotonic()) > 0:
            self._bus.handle_timeout(max(int(left_s * 1e3), 1))

    def until(self, condition: Callable[[], bool], base: Child) -> None:
        end_s = time.monotonic() + PATIENCE_S
        while not condition():
            if time.monotonic() > end_s:
                raise base.error(f"its speed remains {self.speed_mps} m/s")
            self._bus.handle_timeout(10)

    def _take(self, _: str, message: bytes) -> None:
        self.speed_mps, self.at_s = base_t.decode(message).linear_mps, time.monotonic()


class _Sender:
    """30 commands a second, for the base of which it hears."""

    def __init__(self, url: str) -> None:
        self._bus, self._base_session, self._ended = lcm.LCM(url), 0, threading.Event()
        self._bus.subscribe("ROBOT1_BASE", self._take)
        self._thread = threading.Thread(target=self._send)
        self._thread.start()

    def end(self) -> None:
        self._ended.set()
        self._thread.join(PATIENCE_S)
        if self._thread.is_alive():
            raise HarnessError("the sender of commands does not end")

    def _take(self, _: str, message: bytes) -> None:
        self._base_session = base_t.decode(message).session

    def _send(self) -> None:
        message = command_t()
        message.mac, message.session = bytes(32), random.SystemRandom().getrandbits(62) + 1
        message.linear_mps, message.status = 0.5, command_t.STATUS_TRACKING
        while not self._ended.is_set():
            end_s = time.monotonic() + 1 / 30
            while (left_s := end_s - time.monotonic()) > 0:
                self._bus.handle_timeout(max(int(left_s * 1e3), 1))
            message.counter += 1
            message.base_session = self._base_session
            message.valid_until_us = core.monotonic_now_us() + 100_000
            self._bus.publish("ROBOT1_COMMAND", message.encode())

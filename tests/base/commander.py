"""A sender of commands, in the test's own process or (run as a program) in one that can be killed.

python commander.py URL ROBOT LINEAR_MPS
"""

from __future__ import annotations

import ctypes
import ctypes.util
import random
import sys
import time
from collections.abc import Callable

import lcm

from pilotfish import core
from pilotfish.lcmtypes.bot_core.pose_t import pose_t
from pilotfish.lcmtypes.pilotfish.base_t import base_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.setpoint_t import setpoint_t

_sodium = ctypes.CDLL(ctypes.util.find_library("sodium") or "libsodium.so.23")


def mac(key: bytes, channel: str, message: bytes) -> bytes:
    """crypto_auth of the channel's name, a zero byte, and the message with zeros for its mac."""
    text = channel.encode() + b"\0" + message[:-32] + bytes(32)
    out = ctypes.create_string_buffer(32)
    _sodium.crypto_auth(out, text, ctypes.c_ulonglong(len(text)), key)
    return out.raw


class Commander:
    """Sends and receives as a coordinator does."""

    def __init__(self, url: str, robot: str = "robot1", *, key: bytes | None = None) -> None:
        self.bus = lcm.LCM(url)
        self.prefix = robot.upper()
        self.key = key
        self.session = random.getrandbits(62) + 1
        self.counter = 0
        self.simulated = False
        self.status, self.reason = command_t.STATUS_TRACKING, 0
        self.valid_ms = 100
        self.received: list[base_t] = []
        self.poses: list[pose_t] = []
        self.sent: list[bytes] = []
        self.base_session: int | None = None  # instead of the one that is received
        self.bus.subscribe(f"{self.prefix}_BASE", lambda _, data: self.received.append(base_t.decode(data)))
        self.bus.subscribe(f"{self.prefix}_POSE", lambda _, data: self.poses.append(pose_t.decode(data)))

    @property
    def last(self) -> base_t:
        return self.received[-1]

    def listen(self, seconds: float) -> None:
        end_s = time.monotonic() + seconds
        while (left_s := end_s - time.monotonic()) > 0:
            self.bus.handle_timeout(max(1, int(left_s * 1e3)))

    def _publish(self, what: str, message: command_t | setpoint_t) -> bytes:
        channel = f"{self.prefix}_{what}"
        data = message.encode()
        if self.key:
            data = data[:-32] + mac(self.key, channel, data)
        self.bus.publish(channel, data)
        return data

    def command(self, linear_mps: float, angular_radps: float = 0.0) -> None:
        self.counter += 1
        message = command_t()
        message.mac = bytes(32)
        message.utime = time.time_ns() // 1000
        message.session, message.counter = self.session, self.counter
        received = self.received[-1].session if self.received else 0
        message.base_session = received if self.base_session is None else self.base_session
        message.valid_until_us = core.monotonic_now_us() + self.valid_ms * 1000
        message.linear_mps, message.angular_radps = linear_mps, angular_radps
        message.simulated = self.simulated
        message.status, message.reason = self.status, self.reason
        self.sent.append(self._publish("COMMAND", message))

    def setpoint(self, *, run: bool, session: int = 0, counter: int = 0) -> bytes:
        message = setpoint_t()
        message.mac = bytes(32)
        message.session, message.counter, message.run = session, counter, run
        message.distance_m = 1.0
        return self._publish("SETPOINT", message)

    def drive_until(
        self, condition: Callable[[], bool], what: str, *, linear_mps: float = 0.3, within_s: float = 15.0
    ) -> None:
        """A command every 20 ms until the condition holds."""
        self._until(condition, what, within_s, lambda: self.command(linear_mps))

    def act_until(self, condition: Callable[[], bool], what: str, act: Callable[[], None]) -> None:
        """act() every 20 ms until the condition holds."""
        self._until(condition, what, 15.0, act)

    def listen_until(self, condition: Callable[[], bool], what: str, *, within_s: float = 15.0) -> None:
        self._until(condition, what, within_s, lambda: None)

    def _until(self, condition: Callable[[], bool], what: str, within_s: float, act: Callable[[], None]) -> None:
        give_up_s = time.monotonic() + within_s
        while not condition():
            assert time.monotonic() < give_up_s, f"{what}: not within {within_s} s; last received: {self._words()}"
            act()
            self.listen(0.02)

    def _words(self) -> str:
        if not self.received:
            return "nothing"
        counters = {c.name: c.count for c in self.last.rejected}
        return f"{self.last.text}, {self.last.linear_mps:.3f} m/s, {counters}"

    def rejected(self, name: str) -> int:
        return {c.name: c.count for c in self.last.rejected}.get(name, 0)


def main() -> None:
    url, robot, linear_mps = sys.argv[1:4]
    commander = Commander(url, robot)
    while True:
        commander.command(float(linear_mps))
        commander.listen(0.02)


if __name__ == "__main__":
    main()

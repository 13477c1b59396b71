"""The motor controller's side of the line, written from docs/base-serial-protocol.md and not from our code."""

from __future__ import annotations

import os
import re
import select
import threading
import time
import tty
from contextlib import suppress
from dataclasses import dataclass
from types import TracebackType


def checksum(body: bytes) -> int:
    """CRC-8, polynomial x^8 + x^2 + x + 1, start 0: by long division of the whole text as one number."""
    remainder = int.from_bytes(body, "big") << 8
    for shift in range(remainder.bit_length() - 9, -1, -1):
        if remainder >> (shift + 8) & 1:
            remainder ^= 0x107 << shift
    return remainder


def telemetry_line(sequence: int, time_ms: int = 0, left: int = 0, right: int = 0, faults: int = 0) -> bytes:
    body = f"PFE,{sequence},{time_ms},{left},{right},{faults}".encode()
    return b"$" + body + b"*%02X\r\n" % checksum(body)


@dataclass(frozen=True)
class SetPoint:
    """A good set-point line, and when it was read [monotonic s]."""

    at_s: float
    sequence: int
    left_mradps: int
    right_mradps: int

    @property
    def moves(self) -> bool:
        return self.left_mradps != 0 or self.right_mradps != 0


_LINE = re.compile(rb"\$(PFW,(\d+),(-?\d+),(-?\d+))\*([0-9A-F]{2})\r?\n")


class MotorController:
    """A pseudo terminal whose other end is opened by pilotfish-base as ``device``. It answers every good set-point with
    its encoders, which count as if the wheels executed commands at once (1000 ticks a turn)."""

    def __init__(self) -> None:
        self._master, self._slave = os.openpty()
        tty.setraw(self._master)
        os.set_blocking(self._master, False)
        self.device = os.ttyname(self._slave)
        self.set_points: list[SetPoint] = []
        self.bad_lines = 0
        self.faults = 0
        self.reads = True  # False: the line is blocked
        self.answers = True
        self.chatter = b""  # sent before every answer
        self._ticks = [0.0, 0.0]
        self._moved_s: float | None = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> MotorController:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.unplug()

    def unplug(self) -> None:
        """Both ends are gone, as when a USB adapter is pulled out."""
        if self._stop.is_set():
            return
        self._stop.set()
        self._thread.join()
        os.close(self._master)
        os.close(self._slave)

    def _run(self) -> None:
        pending = b""
        while not self._stop.is_set():
            if not self.reads:
                self._stop.wait(0.005)
                continue
            if not select.select([self._master], [], [], 0.005)[0]:
                continue
            try:
                pending += os.read(self._master, 4096)
            except OSError:  # the other end is not open
                self._stop.wait(0.005)
                continue
            now_s = time.monotonic()
            *lines, pending = pending.split(b"\n")
            for line in lines:
                self._heard(line + b"\n", now_s)

    def _heard(self, line: bytes, now_s: float) -> None:
        found = _LINE.search(line)
        if not found or checksum(found[1]) != int(found[5], 16):
            self.bad_lines += 1
            return
        set_point = SetPoint(now_s, int(found[2]), int(found[3]), int(found[4]))
        if self._moved_s is not None and self.set_points:
            last = self.set_points[-1]
            for k, speed in enumerate((last.left_mradps, last.right_mradps)):
                self._ticks[k] += 1e-3 * speed * (now_s - self._moved_s) / (2 * 3.141592653589793) * 1000
        self._moved_s = now_s
        self.set_points.append(set_point)
        if self.answers:
            left, right = (int(ticks) for ticks in self._ticks)
            answer = telemetry_line(set_point.sequence, int(now_s * 1e3) % 2**32, left, right, self.faults)
            with suppress(BlockingIOError):
                os.write(self._master, self.chatter + answer)

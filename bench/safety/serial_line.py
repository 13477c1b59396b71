"""The other end of the serial line, as fast as Python can: a pseudo terminal that is read by whoever waits."""

from __future__ import annotations

import os
import re
import select
import time
import tty

_LINE = re.compile(rb"\$PFW,(\d+),(-?\d+),(-?\d+)\*[0-9A-F]{2}\r\n")


def checksum(body: bytes) -> int:
    """CRC-8 of docs/base-serial-protocol.md."""
    remainder = 0
    for byte in body:
        remainder ^= byte
        for _ in range(8):
            remainder = (remainder << 1) ^ (0x107 if remainder & 0x80 else 0)
    return remainder


class SerialLine:
    """Answers every set-point with encoders that stand still, so that the link counts as alive."""

    def __init__(self) -> None:
        self._master, self._slave = os.openpty()
        tty.setraw(self._master)
        self.device = os.ttyname(self._slave)
        self._pending = b""

    def close(self) -> None:
        os.close(self._master)
        os.close(self._slave)

    def fileno(self) -> int:
        return self._master

    def read(self) -> list[tuple[float, bool]]:
        """What has come: when it was read [monotonic s], and whether it moves the wheels. Nothing if nothing has."""
        if not select.select([self], [], [], 0.0)[0]:
            return []
        now_s = time.monotonic()
        self._pending += os.read(self._master, 4096)
        lines = list(_LINE.finditer(self._pending))
        if lines:
            self._pending = self._pending[lines[-1].end() :]
            self._answer(int(lines[-1][1]), now_s)
        return [(now_s, line[2] != b"0" or line[3] != b"0") for line in lines]

    def _answer(self, sequence: int, now_s: float) -> None:
        body = f"PFE,{sequence},{int(now_s * 1e3) % 2**32},0,0,0".encode()
        os.write(self._master, b"$" + body + b"*%02X\r\n" % checksum(body))

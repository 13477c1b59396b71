"""LCM's datagrams in, whole messages out. No socket, no clock, and no field of a datagram is used unchecked.

liblcm 1.3.1, which the Python package ``lcm`` contains, writes outside of its memory on some malformed datagrams; a
program with a STOP button must not end on them. The wire format (big endian):

    short:     "LC02", u32 sequence, channel, zero byte, payload
    fragment:  "LC03", u32 sequence, u32 payload bytes of the message, u32 offset of this part, u16 number,
               u16 fragments; number 0 goes on with the channel and its zero byte; then the part
"""

from __future__ import annotations

import struct
from collections import Counter, OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

_SHORT, _FRAGMENT = b"LC02", b"LC03"
_FRAGMENT_HEADER = struct.Struct(">IIIIHH")
MAX_CHANNEL_BYTES = 63  # liblcm's
MAX_MESSAGE_BYTES = 8 << 20  # a raw picture of 1920 x 1080 in colour, and more
MAX_UNFINISHED = 8
PATIENCE_S = 1.0  # from a message's first fragment to its last


@dataclass
class _Unfinished:
    channel: str | None  # None until fragment 0 has come
    message_bytes: int
    fragments: int
    since_s: float
    parts: dict[int, tuple[int, bytes]] = field(default_factory=dict)  # by number: offset, bytes
    received_bytes: int = 0


class Reassembly:
    """Puts fragments together. ``wanted(channel)`` says whether a message is of interest; others are not held."""

    def __init__(self, wanted: Callable[[str], bool]) -> None:
        self.refused: Counter[str] = Counter()
        self._wanted = wanted
        self._unfinished: OrderedDict[Hashable, _Unfinished | None] = OrderedDict()  # None: not wanted, or refused

    def take(self, datagram: bytes, sender: Hashable, now_s: float) -> tuple[str, bytes] | None:
        """The message (channel, payload) that this datagram completes, if it is wanted."""
        magic = datagram[:4]
        if magic == _SHORT:
            return self._take_short(datagram)
        if magic == _FRAGMENT and len(datagram) >= _FRAGMENT_HEADER.size:
            return self._take_fragment(datagram, sender, now_s)
        self.refused["datagram_not_lcm"] += 1
        return None

    def _take_short(self, datagram: bytes) -> tuple[str, bytes] | None:
        channel, end = self._channel(datagram, 8)
        if channel is None or not self._wanted(channel):
            return None
        return channel, datagram[end:]

    def _channel(self, datagram: bytes, start: int) -> tuple[str | None, int]:
        end = datagram.find(b"\0", start, start + MAX_CHANNEL_BYTES + 1)
        name = datagram[start:end] if end > start else b""
        if not name or not name.isascii():
            self.refused["datagram_channel_bad"] += 1
            return None, 0
        return name.decode("ascii"), end + 1

    def _take_fragment(self, datagram: bytes, sender: Hashable, now_s: float) -> tuple[str, bytes] | None:
        _, sequence, message_bytes, offset, number, fragments = _FRAGMENT_HEADER.unpack_from(datagram)
        key = (sender, sequence)
        self._drop_old(now_s)
        start, channel = _FRAGMENT_HEADER.size, None
        if number == 0:
            channel, start = self._channel(datagram, start)
        part = datagram[start:]
        if (
            not fragments > 0
            or number >= fragments
            or not 0 < message_bytes <= MAX_MESSAGE_BYTES
            or offset + len(part) > message_bytes
            or (number == 0 and channel is None)
        ):
            self.refused["fragment_header_bad"] += 1
            return None
        if key not in self._unfinished:
            self._unfinished[key] = _Unfinished(None, message_bytes, fragments, now_s)
            while len(self._unfinished) > MAX_UNFINISHED:
                if self._unfinished.popitem(last=False)[1] is not None:
                    self.refused["message_displaced"] += 1
        message = self._unfinished[key]
        if message is None:
            return None  # of a message that is not wanted, or was refused
        if (message.message_bytes, message.fragments) != (message_bytes, fragments) or number in message.parts:
            self.refused["fragment_mismatch"] += 1
            self._unfinished[key] = None
            return None
        if channel is not None:
            message.channel = channel
            if not self._wanted(channel):
                self._unfinished[key] = None
                return None
        message.parts[number] = offset, part
        message.received_bytes += len(part)
        if len(message.parts) < fragments:
            return None
        self._unfinished[key] = None
        payload = _joined(message)
        if payload is None or message.channel is None:
            self.refused["fragment_mismatch"] += 1
            return None
        return message.channel, payload

    def _drop_old(self, now_s: float) -> None:
        while self._unfinished:
            key, message = next(iter(self._unfinished.items()))
            if message is not None and now_s - message.since_s <= PATIENCE_S:
                return
            if message is None and len(self._unfinished) <= MAX_UNFINISHED // 2:
                return
            if message is not None:
                self.refused["message_incomplete"] += 1
            del self._unfinished[key]


def _joined(message: _Unfinished) -> bytes | None:
    """The payload; None if the parts do not cover it exactly."""
    parts = sorted(message.parts.values())
    at = 0
    for offset, part in parts:
        if offset != at:
            return None
        at += len(part)
    return b"".join(part for _, part in parts) if at == message.message_bytes else None

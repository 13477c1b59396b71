"""LCM's datagrams, byte by byte, as liblcm's udpm provider sends them, and malformed."""

from __future__ import annotations

import socket
import struct
from urllib.parse import urlparse

SHORT, FRAGMENT = 0x4C433032, 0x4C433033  # "LC02", "LC03"


def short(channel: bytes, payload: bytes, sequence: int = 0) -> bytes:
    return struct.pack(">II", SHORT, sequence) + channel + b"\0" + payload


def fragment(part: bytes, *, sequence=0, message_bytes, offset, number, fragments) -> bytes:
    return struct.pack(">IIIIHH", FRAGMENT, sequence, message_bytes, offset, number, fragments) + part


def in_fragments(channel: bytes, payload: bytes, part_bytes: int, sequence: int = 0) -> list[bytes]:
    """As liblcm cuts it: the channel takes its bytes from the first part."""
    first = part_bytes - len(channel) - 1
    assert 0 < first <= len(payload)
    cuts = [0, first, *range(first + part_bytes, len(payload), part_bytes), len(payload)]
    cuts = sorted(set(cuts))
    parts = [payload[a:b] for a, b in zip(cuts, cuts[1:], strict=False)]
    return [
        fragment(
            (channel + b"\0" if number == 0 else b"") + part,
            sequence=sequence,
            message_bytes=len(payload),
            offset=cuts[number],
            number=number,
            fragments=len(parts),
        )
        for number, part in enumerate(parts)
    ]


def two_datagrams(channel: bytes) -> list[bytes]:
    """What ends every program that receives with liblcm 1.3.1: the second datagram's part goes to 2^32 - 1 bytes behind
    the beginning of a buffer of 64 bytes; in liblcm's 32 bits its end is at 43 and passes the check."""
    return [
        fragment(channel + b"\0" + bytes(42 - len(channel)), message_bytes=64, offset=0, number=0, fragments=3),
        fragment(bytes(44), message_bytes=64, offset=0xFFFFFFFF, number=1, fragments=3),
    ]


TWO_DATAGRAMS = two_datagrams(b"X")


class Sender:
    """A socket that sends any bytes to the bus of an LCM URL."""

    def __init__(self, url: str) -> None:
        parsed = urlparse(url)
        self.to = (parsed.hostname, parsed.port)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)

    def send(self, *datagrams: bytes) -> None:
        for datagram in datagrams:
            self.socket.sendto(datagram, self.to)

    def close(self) -> None:
        self.socket.close()

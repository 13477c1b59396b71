"""The motor controller's side of the line, written from docs/base-serial-protocol.md and not from our code."""

from __future__ import annotations


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

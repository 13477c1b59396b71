"""Numbers compared bit for bit."""

from __future__ import annotations

import struct


def bits(*numbers: float) -> bytes:
    """Equal only if every bit is: zero is not minus zero, and one NaN is another of the same bits."""
    return struct.pack(f"<{len(numbers)}d", *numbers)


def same_bits(one: float, other: float) -> bool:
    """Whether two numbers agree in every bit."""
    return bits(one) == bits(other)

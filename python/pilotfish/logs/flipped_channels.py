"""Channels that are there because a bit of their name has changed on a disk: damage, and nobody's."""

from __future__ import annotations

from collections.abc import Mapping

_MOST_MESSAGES = 1  # robot1 and robot3 are a bit apart, too, and say more than that
_LEAST_OF_THE_OTHER = 10
_BITS = 7  # of ASCII


def flipped_channels(events: Mapping[str, int]) -> dict[str, str]:
    """Of event counts by channel: those with a single event that are one bit away from one with many, and which that
    is."""
    often = {channel for channel, count in events.items() if count >= _LEAST_OF_THE_OTHER}
    found = {}
    for channel, count in events.items():
        if count <= _MOST_MESSAGES and (meant := next((near for near in _one_bit_away(channel) if near in often), "")):
            found[channel] = meant
    return found


def _one_bit_away(channel: str) -> list[str]:
    return [
        f"{channel[:at]}{chr(ord(letter) ^ 1 << bit)}{channel[at + 1 :]}"
        for at, letter in enumerate(channel)
        for bit in range(_BITS)
    ]

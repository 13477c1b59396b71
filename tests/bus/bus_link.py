"""Our Bus and PyPI's lcm side by side."""

from __future__ import annotations

import time
from collections.abc import Callable

import lcm

from pilotfish import bus as pf_bus

PATIENCE_S = 5.0  # a bound for waits that normally end within a millisecond


class Link:
    """Our Bus and PyPI's lcm on one private network (real multicast on loopback)."""

    def __init__(self, url: str) -> None:
        self.bus = pf_bus.Bus(url)
        self.lcm = lcm.LCM(url)

    def send(self, channel: str, data: bytes) -> None:
        """From PyPI's lcm to the Bus, which must handle exactly this one message."""
        self.lcm.publish(channel, data)
        assert self.bus.handle(int(PATIENCE_S * 1000)) == 1

    def catch(self, channel: str, publish: Callable[[], None]) -> bytes:
        """From the Bus to PyPI's lcm: the bytes that `publish` puts on the channel."""
        caught: list[bytes] = []
        subscription = self.lcm.subscribe(channel, lambda _, data: caught.append(bytes(data)))
        publish()
        give_up = time.monotonic() + PATIENCE_S
        while not caught and time.monotonic() < give_up:
            self.lcm.handle_timeout(100)
        self.lcm.unsubscribe(subscription)
        assert len(caught) == 1
        return caught[0]

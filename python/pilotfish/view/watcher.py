"""One page's connection: newest wins, and nothing is queued.

Of each kind (state, picture) at most two messages are on their way; the page acknowledges each by its kind. What
becomes new meanwhile is remembered as one bit, and the newest is sent when there is room. So a page that stands still
loses frames, takes no memory, and shows nothing old when it goes on.
"""

from __future__ import annotations

import asyncio
import json
import struct
import time
from collections.abc import Awaitable, Callable
from typing import Any

from pilotfish.view.feed import Feed

IN_FLIGHT = 2
HEARTBEAT_S = 0.5  # a state is sent at least so often: the page knows that this server lives
_AT_MOST_EVERY_S = {"state": 0.06, "picture": 0.04}
_HEADER_BYTES = struct.Struct(">I")

SendText = Callable[[str], Awaitable[None]]
SendBytes = Callable[[bytes], Awaitable[None]]


class Watcher:
    """Sends a feed's news to one page until ``run`` is cancelled or sending fails."""

    def __init__(self, feed: Feed, send_text: SendText, send_bytes: SendBytes, hello: dict[str, Any]) -> None:
        self._feed, self._hello = feed, hello
        self._send_text, self._send_bytes = send_text, send_bytes
        self._news = {"state": True, "picture": True}
        self._in_flight = {"state": 0, "picture": 0}
        self._sent_s = {"state": 0.0, "picture": 0.0}
        self._next_sample = 0
        self._picture_utime_us: int | None = None  # sent without what was seen in it
        self._wake = asyncio.Event()

    def on_news(self, kind: str) -> None:
        """The feed has a newer one."""
        self._news[kind] = True
        self._wake.set()

    def acknowledge(self, kind: str) -> None:
        """The page has handled a message of that kind."""
        if self._in_flight.get(kind, 0) > 0:
            self._in_flight[kind] -= 1
            self._wake.set()

    async def run(self) -> None:
        """Until cancelled."""
        await self._send_text(_dump({"kind": "hello"} | self._hello | self._feed.hello()))
        self._feed.watch(self.on_news)
        try:
            while True:
                self._wake.clear()
                wait_s = await self._send_what_is_due()
                if not self._wake.is_set():
                    try:
                        await asyncio.wait_for(self._wake.wait(), wait_s)
                    except asyncio.TimeoutError:
                        continue
        finally:
            self._feed.unwatch(self.on_news)

    async def _send_what_is_due(self) -> float:
        """Seconds until something may become due by itself."""
        wait_s = HEARTBEAT_S
        for kind, send in (("picture", self._send_picture), ("state", self._send_state)):
            since_s = time.monotonic() - self._sent_s[kind]
            wanted = self._news[kind] or (kind == "state" and since_s >= HEARTBEAT_S)
            if not wanted or self._in_flight[kind] >= IN_FLIGHT:
                continue
            if since_s < _AT_MOST_EVERY_S[kind]:
                wait_s = min(wait_s, _AT_MOST_EVERY_S[kind] - since_s)
                continue
            self._news[kind] = False
            await send()
        return wait_s

    async def _send_state(self) -> None:
        now_s = time.monotonic()
        state, self._next_sample = self._feed.state(self._next_sample, now_s)
        overlay = None
        if self._picture_utime_us is not None:
            overlay = self._feed.overlay(self._picture_utime_us)
            if overlay is not None:
                self._picture_utime_us = None
        message = {"kind": "state", "sent_s": now_s, "overlay": overlay} | state
        await self._send("state", lambda: self._send_text(_dump(message)))

    async def _send_picture(self) -> None:
        newest = self._feed.picture()
        if newest is None:
            return
        picture, arrival_s = newest
        overlay = self._feed.overlay(picture.utime_us)
        self._picture_utime_us = picture.utime_us if overlay is None else None
        header = {
            "utime_us": picture.utime_us,
            "age_s": time.monotonic() - arrival_s,
            "source_size": [picture.source_width, picture.source_height],
            "overlay": overlay,
        }
        encoded = _dump(header).encode()
        await self._send("picture", lambda: self._send_bytes(_HEADER_BYTES.pack(len(encoded)) + encoded + picture.jpeg))

    async def _send(self, kind: str, send: Callable[[], Awaitable[None]]) -> None:
        self._in_flight[kind] += 1
        self._sent_s[kind] = time.monotonic()
        await send()


def _dump(values: dict[str, Any]) -> str:
    return json.dumps(values, separators=(",", ":"), allow_nan=False)

"""The feeds of one server, by name: robots on the bus as they are heard of."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping

from pilotfish.names_on_bus import split_channel
from pilotfish.view.feed import Feed
from pilotfish.view.listener import Listener
from pilotfish.view.robot_feed import KINDS, PICTURE_KINDS, RobotFeed
from pilotfish.view.setup import Setup

MAX_ROBOTS = 16
_KINDS = frozenset((*KINDS, *PICTURE_KINDS))


class Hub:
    """One feed, or robots that appear."""

    def __init__(self, feeds: list[Feed]) -> None:
        self.feeds: dict[str, Feed] = {feed.name: feed for feed in feeds}

    def names(self) -> list[str]:
        """In alphabetical order."""
        return sorted(self.feeds)

    def others(self) -> list[str]:
        """Robots that were heard of and that this server does not watch, in alphabetical order."""
        return []

    def find(self, name: str) -> Feed | None:
        """That one; the first one if it is not named."""
        if name:
            return self.feeds.get(name)
        return self.feeds[self.names()[0]] if self.feeds else None

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """Begins to receive."""

    def stop(self, loop: asyncio.AbstractEventLoop) -> None:
        """Ends that."""


class BusHub(Hub):
    """Listens to one bus. ``robot`` empty: whatever sends a status or a command becomes a feed, MAX_ROBOTS at most.

    ``setups``: of robots whose own is known, by name in small letters; ``setup`` is that of all others."""

    def __init__(self, url: str, robot: str, setup: Setup, setups: Mapping[str, Setup] | None = None) -> None:
        self._setup, self._setups, self._discovers = setup, setups or {}, not robot
        super().__init__([RobotFeed(robot, self._setup_of(robot))] if robot else [])
        self._by_channel: dict[str, RobotFeed] = {}
        self._others: set[str] = set()
        self._listener = Listener(url, self._wanted, self._on_message)

    @property
    def refused(self) -> dict[str, int]:
        """Datagrams that were no message, by kind."""
        return dict(self._listener.reassembly.refused)

    def others(self) -> list[str]:
        """As Hub's."""
        return sorted(self._others)

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """As Hub's."""
        self._listener.start(loop)

    def stop(self, loop: asyncio.AbstractEventLoop) -> None:
        """As Hub's."""
        self._listener.stop(loop)

    def _setup_of(self, robot: str) -> Setup:
        return self._setups.get(robot.lower(), self._setup)

    def _wanted(self, channel: str) -> bool:
        feed, kind = self._feed_of(channel)
        return feed is not None and feed.wants(kind)

    def _on_message(self, channel: str, data: bytes, arrival_s: float) -> None:
        feed, kind = self._feed_of(channel)
        if feed is not None:
            feed.take(kind, data, arrival_s)

    def _feed_of(self, channel: str) -> tuple[RobotFeed | None, str]:
        kind = channel.rpartition("_")[2]
        if channel in self._by_channel:
            return self._by_channel[channel], kind
        named = split_channel(channel)
        if named is None or kind not in _KINDS:
            return None, kind
        name = named[0]
        feed = next((feed for own, feed in self.feeds.items() if own.lower() == name), None)
        if feed is None and self._discovers and kind in ("STATUS", "COMMAND") and len(self.feeds) < MAX_ROBOTS:
            feed = self.feeds[name] = RobotFeed(name, self._setup_of(name))
        if feed is None and kind == "STATUS" and len(self._others) < MAX_ROBOTS:
            self._others.add(name)
        if isinstance(feed, RobotFeed):
            self._by_channel[channel] = feed
            return feed, kind
        return None, kind

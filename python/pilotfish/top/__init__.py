"""``pilotfish top``: robots on the bus. ``once`` is for scripts; the screen is in ``top.app`` (needs Textual)."""

from __future__ import annotations

import time

from pilotfish.watching.feed import Feed
from pilotfish.watching.robots import Robots

CHANNELS = ".*_(STATUS|COMMAND|OBSERVATION|BASE)"  # no images: they are none of its business, and large


def once(url: str = "", seconds: float = 1.0, robots: tuple[str, ...] = ()) -> tuple[Robots, str]:
    """The robots that were heard within ``seconds``, and the bus's URL. SilentRobotError without a bus."""
    known = Robots(robots)
    feed = Feed(url, known.receive, CHANNELS)
    until_s = time.monotonic() + seconds
    while (left_s := until_s - time.monotonic()) > 0:
        feed.handle(left_s)
    return known, feed.url

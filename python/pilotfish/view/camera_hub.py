"""The hub of a server that shows a camera alone."""

from __future__ import annotations

import asyncio

from pilotfish.view.camera_feed import CameraFeed
from pilotfish.view.hub import Hub


class CameraHub(Hub):
    """A camera alone."""

    def __init__(self, feed: CameraFeed) -> None:
        super().__init__([feed])
        self._feed = feed

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """As Hub's."""
        self._feed.start(loop)

    def stop(self, loop: asyncio.AbstractEventLoop) -> None:
        """As Hub's."""
        self._feed.stop()

"""What a page can watch: a robot on the bus, or a camera. Knows who watches, and tells them that there is news."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pilotfish.view.pictures import Picture

OnNews = Callable[[str], None]  # with "state" or "picture"


class Feed:
    """Base of both. All methods are called on the event loop's thread."""

    mode = "robot"

    def __init__(self, name: str) -> None:
        self.name = name
        self._watchers: set[OnNews] = set()

    @property
    def watched(self) -> bool:
        """Whether any page watches; while none does, nothing is decoded or encoded."""
        return bool(self._watchers)

    def watch(self, on_news: OnNews) -> None:
        """From now on ``on_news`` is called whenever a newer state or picture is there."""
        self._watchers.add(on_news)

    def unwatch(self, on_news: OnNews) -> None:
        """Ends that."""
        self._watchers.discard(on_news)

    def hello(self) -> dict[str, Any]:
        """What a page needs once."""
        raise NotImplementedError

    def state(self, samples_from: int, now_s: float) -> tuple[dict[str, Any], int]:
        """The newest values, samples from that number on, and the number of the next."""
        raise NotImplementedError

    def picture(self) -> tuple[Picture, float] | None:
        """The newest picture and when it arrived (time.monotonic() [s])."""
        raise NotImplementedError

    def overlay(self, utime_us: int) -> dict[str, Any] | None:
        """What was seen in the picture of that exposure; None: nothing is known (yet)."""
        raise NotImplementedError

    def tell(self, kind: str) -> None:
        """There is a newer state, or picture."""
        for on_news in tuple(self._watchers):
            on_news(kind)

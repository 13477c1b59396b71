"""A page that stands still loses frames and slows nothing: the newest wins, and no queue grows."""

from __future__ import annotations

import asyncio
import json
from concurrent.futures import ThreadPoolExecutor

from pilotfish.view.robot_feed import RobotFeed
from pilotfish.view.setup import default_setup
from pilotfish.view.watcher import IN_FLIGHT, Watcher
from robot_on_bus import command, gray_image, picture

SETUP = default_setup()


class Page:
    """Takes what is sent; acknowledges when it is told to."""

    def __init__(self, feed):
        self.states, self.pictures = [], []
        self.watcher = Watcher(feed, self.on_text, self.on_bytes, {})

    async def on_text(self, text):
        message = json.loads(text)
        if message["kind"] == "state":
            self.states.append(message)

    async def on_bytes(self, data):
        length = int.from_bytes(data[:4], "big")
        self.pictures.append(json.loads(data[4 : 4 + length]))


def run(play):
    """In a thread of its own: Playwright's browser keeps an event loop in this one."""
    with ThreadPoolExecutor(1) as executor:
        executor.submit(lambda: asyncio.run(play())).result()


async def until(condition):
    for _ in range(500):
        if condition():
            return
        await asyncio.sleep(0.01)
    raise AssertionError("not within 5 s")


def test_a_page_that_does_not_answer_gets_two_of_a_kind_and_then_the_newest():
    async def play():
        feed = RobotFeed("robot1", SETUP)
        stalled, quick = Page(feed), Page(feed)
        tasks = [asyncio.create_task(page.watcher.run()) for page in (stalled, quick)]
        await until(lambda: stalled.states and quick.states)
        for k in range(40):
            feed.take("COMMAND", command(linear_mps=0.001 * k).encode(), 100.0 + 0.05 * k)
            feed.take("PREVIEW", picture(gray_image(16, 16), utime=k).encode(), 100.0 + 0.05 * k)
            for kind in ("state", "picture"):
                quick.watcher.acknowledge(kind)
            await asyncio.sleep(0.02)
        for kind in ("state", "picture"):
            quick.watcher.acknowledge(kind)
        await until(lambda: quick.pictures and quick.pictures[-1]["utime_us"] == 39)
        assert (len(stalled.states), len(stalled.pictures)) == (IN_FLIGHT, IN_FLIGHT)
        assert len(quick.pictures) > IN_FLIGHT + 3
        for kind in ("state", "picture"):
            stalled.watcher.acknowledge(kind)
        await until(lambda: len(stalled.pictures) == IN_FLIGHT + 1 and len(stalled.states) == IN_FLIGHT + 1)
        assert stalled.pictures[-1]["utime_us"] == 39  # the newest, none of those between
        assert stalled.states[-1]["command"]["linear_mps"] == 0.039
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        assert not feed.watched

    run(play)


def test_a_picture_that_was_sent_before_its_measurement_gets_it_with_the_next_state():
    from robot_on_bus import observation

    async def play():
        feed = RobotFeed("robot1", SETUP)
        page = Page(feed)
        task = asyncio.create_task(page.watcher.run())
        await until(lambda: page.states)
        page.watcher.acknowledge("state")
        feed.take("PREVIEW", picture(gray_image(16, 16)).encode(), 100.0)
        await until(lambda: page.pictures)
        assert page.pictures[0]["overlay"] is None
        feed.take("OBSERVATION", observation(tags=3).encode(), 100.01)
        await until(lambda: page.states[-1]["overlay"] is not None)
        assert page.states[-1]["overlay"]["utime_us"] == page.pictures[0]["utime_us"]
        assert len(page.states[-1]["overlay"]["tags"]) == 3
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    run(play)

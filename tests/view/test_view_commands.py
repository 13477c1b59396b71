"""Stops, resumes and setpoints of pages, without a page: confirmed or not, and a stop before everything else."""

from __future__ import annotations

import asyncio
import os
import resource
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest

from pilotfish import bus
from pilotfish.operating import new_key
from pilotfish.view.commands import Commander
from scripted_coordinator import ScriptedCoordinator


def play(commander, *requests):
    """Outcomes of requests (action, values) that are made at once, in this order."""

    async def all_of_them():
        tasks = []
        for action, values in requests:
            tasks.append(asyncio.create_task(commander.do("robot1", action, values)))
            await asyncio.sleep(0)  # it is under way when the next one comes
        return await asyncio.gather(*tasks)

    # In a thread of its own: Playwright's browser keeps an event loop in this one.
    with ThreadPoolExecutor(1) as executor:
        outcomes = executor.submit(lambda: asyncio.run(all_of_them())).result()
    return outcomes if len(outcomes) > 1 else outcomes[0]


def test_each_request_is_confirmed_with_what_the_robot_then_says(url):
    commander = Commander(url)
    with ScriptedCoordinator(url) as robot:
        stopped = play(commander, ("stop", {}))
        assert stopped.confirmed
        assert stopped.sent >= 3
        assert not robot.setpoint.run
        changed = play(commander, ("setpoint", {"distance_m": 1.5, "bearing_rad": 0.1}))
        assert (changed.confirmed, robot.setpoint.distance_m, robot.setpoint.bearing_rad) == (True, 1.5, 0.1)
        assert not robot.setpoint.run
        only_one = play(commander, ("setpoint", {"bearing_rad": -0.2}))
        assert (only_one.confirmed, robot.setpoint.distance_m, robot.setpoint.bearing_rad) == (True, 1.5, -0.2)
        assert play(commander, ("resume", {})).confirmed
        assert robot.setpoint.run
    commander.close()


def test_the_key_authenticates_a_resume_and_a_stop_needs_none(tmp_path, url):
    key = tmp_path / "robot1.key"
    new_key(key)
    with ScriptedCoordinator(url, key=bus.load_key(str(key))) as robot:
        without = Commander(url, within_s=0.6)
        assert play(without, ("stop", {})).confirmed
        refused = play(without, ("resume", {}))
        assert not refused.confirmed
        assert "its key is not yours" in refused.text
        assert not robot.setpoint.run
        assert play(Commander(url, key), ("resume", {})).confirmed


def test_a_stop_that_comes_while_a_resume_is_being_sent_wins(url):
    """The coordinator is silent when both are asked for: the resume waits for its session. When it speaks, the stop has
    been sent, and a resume that then went on would end it."""
    commander = Commander(url)
    robot = ScriptedCoordinator(url)
    start_s = time.monotonic()
    with ThreadPoolExecutor(1) as executor:
        outcomes = executor.submit(play, commander, ("resume", {}), ("stop", {}))
        while time.monotonic() - start_s < 0.5:  # both are listening by now
            robot.bus.handle(10)
        with robot:
            resume, stop = outcomes.result()
            assert (resume.confirmed, stop.confirmed) == (False, True)
            assert "cancelled" in resume.text
            assert not robot.setpoint.run


def test_a_second_request_does_not_wait_behind_the_first(url):
    commander = Commander(url, within_s=0.5)
    with ScriptedCoordinator(url, ignores_setpoints=True):
        first, second = play(commander, ("resume", {}), ("setpoint", {"distance_m": 1.2}))
        assert "not confirmed" in first.text
        assert "another request is still being sent" in second.text


def test_where_no_robot_is_the_outcome_says_so(url):
    outcome = play(Commander(url, within_s=0.2), ("stop", {}))
    assert not outcome.confirmed
    assert outcome.sent >= 3
    assert "none was confirmed" in outcome.text


@pytest.mark.parametrize("values", [{}, {"distance_m": "1"}, {"bearing_rad": True}, {"distance_m": float("nan")}])
def test_numbers_that_are_none_are_not_sent(url, values):
    outcome = play(Commander(url), ("setpoint", values))
    assert (outcome.confirmed, outcome.sent) == (False, 0)


def descriptors():
    return [int(entry.name) for entry in Path("/proc/self/fd").iterdir()]


def test_a_request_leaves_no_descriptor_behind(url):
    commander = Commander(url)
    with ScriptedCoordinator(url):
        play(commander, ("stop", {}))  # opens what is opened once
        before = len(descriptors())
        for _ in range(5):
            assert play(commander, ("stop", {})).confirmed
            assert play(commander, ("resume", {})).confirmed
        assert len(descriptors()) == before
    commander.close()


def test_a_stop_is_sent_where_no_file_can_be_opened_any_more(url):
    commander = Commander(url)
    allowed = resource.getrlimit(resource.RLIMIT_NOFILE)

    async def stop_without_descriptors():
        resource.setrlimit(resource.RLIMIT_NOFILE, (max(descriptors()) + 1, allowed[1]))
        taken = []
        try:
            with suppress(OSError):  # EMFILE
                while True:
                    taken.append(os.open(os.devnull, os.O_RDONLY))
            return [await commander.do("robot1", "stop", {}) for _ in range(2)]
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, allowed)
            for descriptor in taken:
                os.close(descriptor)

    with ScriptedCoordinator(url) as robot:
        with ThreadPoolExecutor(1) as executor:
            outcomes = executor.submit(lambda: asyncio.run(stop_without_descriptors())).result()
        assert [outcome.confirmed for outcome in outcomes] == [True, True]  # the second one needs them as well
        assert not robot.setpoint.run
    commander.close()

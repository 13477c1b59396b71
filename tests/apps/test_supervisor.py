"""The supervisor of pilotfish-coordinator's threads: what it reports to the watchdog, and that the program always ends.

Its times are seconds of real time, so all runs go on at once; each has a service manager that logs what it receives.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import threading
import time
from dataclasses import dataclass, field

import pytest

from build_tree import built
from pilotfish.core import Reason, Status

TURN_WITHIN_S, END_WITHIN_S = 2.0, 3.0  # supervisor.cpp's kTurnWithin_us, kEndWithin_us
STUCK = "idle=20000"

RUNS = {  # what main() does, and after which line of it SIGTERM comes
    "all is well": (("look=300", "ready=camera 0", "look=1500"), None),
    "main is stuck": (("ready=x", "look=500", "idle=3500"), None),
    "the sender is stuck": (("ready=x", "look=500", "hold", "look=1000", "release", "look=500"), None),
    "a signal": (("ready=x", "take"), "take"),
    "a signal, and main is stuck": (("ready=x", STUCK), "idle"),
    "a signal, and the sender is stuck": (("ready=x", "hold", "look=500", STUCK), "idle"),
    "a failure": (("ready=x", "fail=the bus", "ended"), None),
    "a failure, and main is stuck": (("ready=x", "fail=the bus", STUCK), None),
}


@dataclass
class Run:
    received: list[tuple[float, str]] = field(default_factory=list)  # by the manager: when, and what
    began_s: dict[str, float] = field(default_factory=dict)  # a verb, by its last time
    sent: list[tuple[Status, Reason]] = field(default_factory=list)
    end: list[str] | None = None
    code: int = -1
    ended_s: float = 0.0

    def fed(self, from_s: float, to_s: float) -> int:
        """How often it fed the watchdog between those times."""
        return sum(what == "WATCHDOG=1" and from_s <= at <= to_s for at, what in self.received)


def listen(listening: socket.socket, run: Run) -> None:
    while (message := listening.recv(4096)) != b"over":
        run.received.append((time.monotonic(), message.decode()))


def read(process: subprocess.Popen, stop_at: str | None, run: Run) -> None:
    with process:
        for line in process.stdout:
            verb, *words = line.split()
            if verb == "sent":
                run.sent.append((Status(int(words[0])), Reason(int(words[1]))))
            elif verb == "end":
                run.end = words
            else:
                run.began_s[verb] = int(words[0]) / 1e6
            if verb == stop_at:
                process.send_signal(signal.SIGTERM)
    run.code = process.returncode
    run.ended_s = time.monotonic()


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    found, threads, managers = {}, [], []
    for name, (verbs, stop_at) in RUNS.items():
        run = found[name] = Run()
        address = str(tmp_path_factory.mktemp("manager") / "notify")
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        listening.bind(address)
        environment = {**os.environ, "NOTIFY_SOCKET": address, "WATCHDOG_USEC": "200000"}
        process = subprocess.Popen(
            [built("supervisor_probe"), *verbs], env=environment, stdout=subprocess.PIPE, text=True
        )
        threads.append((threading.Thread(target=read, args=(process, stop_at, run)), process))
        manager = threading.Thread(target=listen, args=(listening, run))
        managers.append((manager, listening, address))
        threads[-1][0].start()
        manager.start()
    for thread, process in threads:
        thread.join(30.0)
        process.kill()
    for manager, listening, address in managers:
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as ending:
            ending.sendto(b"over", address)
        manager.join(30.0)
        listening.close()
    return found


def test_the_watchdog_is_fed_from_ready_on_while_all_threads_go_on(runs):
    # Every 50 ms for 1.5 s are 30 times; a third of them is enough on a computer that has other things to do.
    run = runs["all is well"]
    assert run.received[0][1] == "READY=1\nSTATUS=looking through camera 0"
    assert {what for _, what in run.received[1:]} == {"WATCHDOG=1"}
    assert 10 <= len(run.received) - 1 <= 40
    assert run.end == ["0", "0"]
    assert run.code == 0


def test_a_control_loop_that_stands_still_is_given_two_seconds_and_then_starves_the_watchdog(runs):
    # Vision may take its time over a frame: so long the watchdog is fed. Half a second is for what is under way.
    run = runs["main is stuck"]
    still_s = run.began_s["idle"]
    assert run.fed(still_s + 0.5, still_s + TURN_WITHIN_S) >= 5
    assert run.fed(still_s + TURN_WITHIN_S + 0.5, still_s + 3.5) == 0


def test_a_sender_of_commands_that_stands_still_starves_the_watchdog_at_once(runs):
    run = runs["the sender is stuck"]
    assert run.fed(run.began_s["hold"] + 0.4, run.began_s["release"]) == 0
    assert run.fed(run.began_s["release"], run.ended_s) >= 2


def test_a_signal_sends_zeros_and_wakes_the_control_loop(runs):
    run = runs["a signal"]
    assert run.ended_s - run.began_s["take"] < 10.0  # of the 20 s that it would have waited
    assert run.sent[-3:] == [(Status.stopped, Reason.stop_requested)] * 3
    assert run.end == ["1", "0"]
    assert run.code == 0


def test_a_program_that_is_told_to_end_ends_though_a_thread_is_stuck(runs):
    run = runs["a signal, and main is stuck"]
    assert run.sent[-3:] == [(Status.stopped, Reason.stop_requested)] * 3
    assert [what for _, what in run.received if "STOPPING" in what] == ["STOPPING=1\nSTATUS=stopping"]
    assert run.end is None
    assert run.code == 0
    assert END_WITHIN_S - 0.1 < run.ended_s - run.began_s["idle"] < 10.0


def test_it_ends_though_the_thread_that_sends_commands_is_stuck(runs):
    run = runs["a signal, and the sender is stuck"]
    assert run.end is None
    assert run.code == 0
    assert END_WITHIN_S - 0.1 < run.ended_s - run.began_s["idle"] < 10.0


def test_a_failure_sends_zeros_and_is_remembered(runs):
    run = runs["a failure"]
    assert run.sent[-3:] == [(Status.invalid_input, Reason.internal_error)] * 3
    assert run.end == ["1", "1"]
    assert run.received[-1][1] == "STOPPING=1\nSTATUS=stopping"


def test_a_failure_ends_with_70_though_a_thread_is_stuck(runs):
    run = runs["a failure, and main is stuck"]
    assert run.end is None
    assert run.code == 70
    assert run.ended_s - run.began_s["idle"] < 10.0


@pytest.mark.parametrize("name", ["a signal, and main is stuck", "a failure, and main is stuck"])
def test_what_is_ending_feeds_no_watchdog(runs, name):
    # What hangs while it ends is ended by the manager at the latest.
    stopping_s = next(at for at, what in runs[name].received if "STOPPING" in what)
    assert runs[name].fed(stopping_s, runs[name].ended_s) == 0

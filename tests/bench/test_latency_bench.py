"""The benchmark of the delay from picture to command counts only answers, and its figures are what their names say."""

from __future__ import annotations

import math
import select
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import lcm
import pytest

sys.path.append(str(Path(__file__).parents[2] / "bench" / "latency"))  # where measure finds its neighbours

from bench.latency.figures import rows_of
from bench.latency.measure import moving_leader
from bench.latency.receiver import Receiver
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t

ROOT = Path(__file__).parents[2]


def command(utime: int, status: int) -> bytes:
    message = command_t()
    message.utime, message.status, message.mac = utime, status, bytes(32)
    return message.encode()


def arm(receiver: str, picture: str, milliseconds: list[float], sent: int | None = None) -> SimpleNamespace:
    sent = len(milliseconds) if sent is None else sent
    return SimpleNamespace(receiver=receiver, picture=picture, sent=sent, milliseconds=milliseconds)


def test_the_first_command_that_names_a_picture_answers_it_and_a_repetition_does_not():
    url = private_lcm_url()
    receiver, sender = Receiver(url), lcm.LCM(url)
    try:
        picture = image_t()
        picture.data = bytes(200_000)  # in fragments, which the kernel keeps away
        picture.size = len(picture.data)
        before_ns = time.time_ns()
        sender.publish("ROBOT1_IMAGE", picture.encode())
        sender.publish("ROBOT1_COMMAND", command(1, command_t.STATUS_SEARCHING))
        sender.publish("ROBOT1_COMMAND", command(2, command_t.STATUS_TRACKING))
        between_ns = time.time_ns()
        sender.publish("ROBOT1_COMMAND", command(2, command_t.STATUS_TRACKING))  # as the coordinator between pictures
        sender.publish("ROBOT1_COMMAND", command(3, command_t.STATUS_TRACKING))
        give_up_s = time.monotonic() + 5.0
        while 3 not in receiver.received.answers_ns and time.monotonic() < give_up_s:
            select.select([receiver], [], [], 1.0)
            receiver.listen()
    finally:
        receiver.close()
    assert sorted(receiver.received.answers_ns) == [1, 2, 3]
    assert receiver.received.other_commands == 1
    assert receiver.received.tracking == 2
    # By the kernel's clock, not by when the receiver got round to it.
    assert before_ns <= receiver.received.answers_ns[1] <= receiver.received.answers_ns[2] <= between_ns
    assert between_ns <= receiver.received.answers_ns[3]


def test_no_picture_is_one_that_was_shown_just_before():
    """Such a picture is refused as a frozen camera's without a look at it, and a quarter of them made the figures those
    of a leader that is lost and searched for, over and over."""
    raw = [bytes(message) for message in moving_leader()["raw"]]
    assert len(set(raw)) == len(raw)


@pytest.mark.parametrize(("ours_ms", "missed"), [(3.0, []), (3.1, ["p50"])])
def test_the_coordinator_is_compared_with_the_same_picture_over_lcm_alone(ours_ms: float, missed: list[str]):
    found = [
        arm("bare", "raw", [2.0] * 10),
        arm("bare", "JPEG", [1.0] * 10),
        arm("pilotfish", "JPEG", [ours_ms] * 10),
    ]
    row = rows_of("idle", found)[-1]
    assert (row.to_same_bare, row.to_raw_bare) == (ours_ms, ours_ms / 2.0)
    assert row.missed == missed  # 1.5 times 2 ms


def test_a_picture_that_nobody_answers_is_not_left_out():
    found = [arm("bare", "raw", [1.0] * 10), arm("pilotfish", "raw", [1.0] * 9, sent=10)]
    row = rows_of("busy", found)[-1]
    assert (row.p50_ms, row.p999_ms, row.missed) == (1.0, math.inf, ["p99.9"])


def test_its_help_says_what_is_timed_and_an_unknown_condition_is_refused():
    call = [sys.executable, ROOT / "bench" / "latency"]
    answer = subprocess.run([*call, "--help"], capture_output=True, text=True, timeout=60)
    assert answer.returncode == 0
    assert "time stamp" in answer.stdout
    wrong = subprocess.run([*call, "--condition", "asleep"], capture_output=True, text=True, timeout=60)
    assert wrong.returncode == 2
    assert "one-core" in wrong.stderr

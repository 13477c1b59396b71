"""What goes wrong: each fault is a function that shows pictures and sends messages until it is over.

`share` is how often a fault is drawn; those that make robot time pass as the wall's does are rarer. While a fault of
the camera lasts no picture counts as good, so nothing may move 100 ms after the last one.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass

from intruders import (
    endless_fragments,
    false_intents,
    forgeries,
    liblcm_killer,
    random_datagrams,
    second_camera,
    second_coordinator,
    setpoint_flood,
    stop_and_resume,
)
from pictures import Message
from robot import Robot

HOUR_US = 3_600_000_000
_OFTEN, _SELDOM = 3, 1

Play = Callable[[Robot, random.Random, float], None]


@dataclass(frozen=True)
class Fault:
    words: str
    play: Play
    share: int = _OFTEN
    longest_s: float = 4.0
    paced_recovery: bool = False  # what holds the robot back afterwards is a time of the wall


def bad(series: str, *, answered: bool = True) -> Play:
    def play(robot: Robot, rng: random.Random, duration_s: float) -> None:
        messages, end_s = robot.pictures.bad[series], robot.now_s + duration_s
        while robot.now_s < end_s:
            robot.show(messages[robot.frames % len(messages)], answered=answered)

    return play


def frozen(robot: Robot, rng: random.Random, duration_s: float) -> None:
    end_s = robot.now_s + duration_s
    while robot.now_s < end_s:
        robot.show_again()


def silence(robot: Robot, rng: random.Random, duration_s: float) -> None:
    robot.rest(duration_s)


def backward(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """From two hours ago on: to come back from there is a leap that the simulated clock does not accept either."""
    end_s, start_us = robot.now_s + duration_s, robot.now_us() - 2 * HOUR_US
    pictures = rng.choice([robot.pictures.bad["gray"], robot.pictures.good])
    k = 0
    while robot.now_s < end_s:
        k += 1
        robot.show(pictures[k % len(pictures)], utime=start_us - round(k * robot.period_s * 1e6))


def repeated(robot: Robot, rng: random.Random, duration_s: float) -> None:
    end_s, stamp = robot.now_s + duration_s, robot.last_stamp
    while robot.now_s < end_s:
        robot.show(robot.pictures.good[robot.frames % len(robot.pictures.good)], utime=stamp)


def wild_stamps(robot: Robot, rng: random.Random, duration_s: float) -> None:
    for _ in range(rng.randrange(1, 4)):
        stamp = rng.choice([2**61, 2**62 - 1, 2**63 - 1, -(2**62), -(2**63), 0, 1])
        accepted_as_a_time = 0 <= stamp < 2**62  # what is not is refused with the message's header
        robot.show(robot.pictures.good[0], utime=stamp, answered=accepted_as_a_time)
        robot.show_good()


def clock_set_by_an_hour(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """And set right again."""
    by_us, end_s = rng.choice([-1, 1]) * HOUR_US, robot.now_s + duration_s
    robot.clock_us += by_us
    while robot.now_s < end_s:
        robot.show_good()
    robot.clock_us -= by_us


def clock_set_back(robot: Robot, rng: random.Random, duration_s: float) -> None:
    robot.clock_us -= round(duration_s * 1e6)


def random_bytes(robot: Robot, rng: random.Random, duration_s: float) -> None:
    """On the pictures' channel: no message at all, no JPEG in it, a header that is wrong."""
    end_s = robot.now_s + duration_s
    gray = robot.pictures.bad["gray"][0]
    while robot.now_s < end_s:
        kind = rng.randrange(3)
        if kind == 0:
            robot.out.publish("ROBOT1_IMAGE", rng.randbytes(rng.randrange(1, 100_000)))
        elif kind == 1:
            robot.show(Message.of_bytes(rng.randbytes(rng.randrange(1, 50_000))), answered=False)
        else:
            broken = bytearray(gray.stamped(robot.now_us()))
            broken[rng.randrange(16, 36)] ^= 1 << rng.randrange(8)
            robot.out.publish("ROBOT1_IMAGE", bytes(broken))
        robot.rest(robot.period_s)


FAULTS: dict[str, Fault] = {
    "gray": Fault("pictures without a leader", bad("gray")),
    "black": Fault("black pictures", bad("black")),
    "saturated": Fault("saturated pictures", bad("saturated")),
    "blurred": Fault("blurred pictures", bad("blurred")),
    "frozen": Fault("the same picture under new stamps", frozen),
    "wrong-size": Fault("pictures of another size", bad("wrong size")),
    "cut-off-jpeg": Fault("JPEGs that are cut off", bad("cut-off JPEG", answered=False), _SELDOM, 0.8),
    "random-bytes": Fault("random bytes as pictures", random_bytes, _SELDOM, 0.8),
    "silence": Fault("no pictures", silence, _SELDOM, 0.8),
    "backward": Fault("stamps run backward", backward, _SELDOM, 0.8),
    "repeated": Fault("the same stamp again and again", repeated, _SELDOM, 0.8),
    "wild-stamps": Fault("single stamps of up to 2^63", wild_stamps, _SELDOM),
    "clock-hour": Fault("the clock is set by an hour, and back", clock_set_by_an_hour),
    "clock-back": Fault("the clock is set back a little", clock_set_back),
    "datagrams": Fault("random datagrams", random_datagrams),
    "liblcm-killer": Fault("datagrams that end liblcm", liblcm_killer),
    "fragments": Fault("fragments that never complete", endless_fragments),
    "forgeries": Fault("forged commands, setpoints, base", forgeries),
    "setpoint-flood": Fault("a flood of setpoints", setpoint_flood, longest_s=1.0),
    "stop-resume": Fault("stop, and resume", stop_and_resume),
    "false-intents": Fault("a leader that announces false twists", false_intents),
    "second-camera": Fault("a second camera on the channel", second_camera),
    "second-coordinator": Fault("a second coordinator commands", second_coordinator, _SELDOM, 0.4, True),
}


def deck(rng: random.Random, kinds: list[str]) -> list[str]:
    """Every fault as often as its share says, shuffled: so that the first ten minutes see them all."""
    cards = [kind for kind in kinds for _ in range(FAULTS[kind].share)]
    rng.shuffle(cards)
    return cards

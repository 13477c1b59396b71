"""Hours of robot time with a fault every ten seconds."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from census import Census
from fault_kinds import FAULTS, deck
from robot import Robot

from pilotfish.harness.child import Child

EVERY_S = 10.0
RECOVERED_WITHIN_S = 8.0  # later: it is not waited for
_FIRST_SHORTEST_S = 0.2


@dataclass(frozen=True)
class Played:
    """One fault. Times from the first good picture after it."""

    kind: str
    at_s: float  # robot time
    lasted_s: float
    stood: bool  # at least one zero was sent while it lasted
    recovery_s: float  # robot time until the robot tracked and moved, RECOVERED_WITHIN_S at most
    wheels_s: float  # wall time until pilotfish-base drove, too
    disturbed: bool  # this script did not run for a while: its times say nothing


@dataclass
class Soak:
    rate_hz: float
    robot_s: float = 0.0
    wall_s: float = 0.0
    frames: int = 0
    commands: int = 0
    resent: int = 0
    played: list[Played] = field(default_factory=list)
    stumbles: list[str] = field(default_factory=list)  # good pictures behind a recovery that did not move the robot
    violations: list[str] = field(default_factory=list)
    census: dict[str, Census] = field(default_factory=dict)
    refused: dict[str, dict[str, int]] = field(default_factory=dict)
    ended: dict[str, int] = field(default_factory=dict)  # exit codes


OnProgress = Callable[[Soak], None]


def soak(robot: Robot, duration_s: float, seed: int, kinds: list[str], progress: OnProgress) -> Soak:
    rng, begin_s = random.Random(seed), time.monotonic()
    found = Soak(robot.rate_hz, violations=robot.violations, census={name: Census() for name in robot.children})
    cards: list[str] = []
    drive(robot)
    while robot.now_s < duration_s:
        for name, child in robot.children.items():
            _check_alive(child)
            found.census[name].sample(child.process.pid, robot.now_s)
        cards = cards or deck(rng, kinds)
        next_s = robot.now_s - robot.now_s % EVERY_S + EVERY_S
        found.played.append(play(robot, cards.pop(), rng))
        while robot.now_s < next_s:
            robot.show_good()
            if not robot.tracking:
                found.stumbles.append(f"{robot.now_s:.3f} s, after {found.played[-1].kind}: {robot.said}")
        found.robot_s, found.wall_s = robot.now_s, time.monotonic() - begin_s
        found.frames, found.commands, found.resent = robot.frames, robot.commands, robot.resent
        progress(found)
    for name, child in robot.children.items():
        _check_alive(child)
        found.census[name].sample(child.process.pid, robot.now_s)
    robot.ask_what_was_refused()
    found.refused = robot.refused
    found.ended = {name: child.terminate() for name, child in robot.children.items()}
    return found


def _check_alive(child: Child) -> None:
    if (code := child.process.poll()) is not None:
        raise child.error(f"ended with {code}")


def play(robot: Robot, kind: str, rng: random.Random) -> Played:
    """One fault, and good pictures until the robot drives again."""
    fault, begin_s, interrupted = FAULTS[kind], robot.now_s, robot.interrupted
    robot.fault, robot.stood = kind, False
    fault.play(robot, rng, rng.uniform(_FIRST_SHORTEST_S, fault.longest_s))
    lasted_s, stood = robot.now_s - begin_s, robot.stood
    robot.paced = fault.paced_recovery
    recovery_s, wheels_s = drive(robot)
    robot.paced, robot.fault = False, ""
    disturbed = robot.interrupted != interrupted
    return Played(kind, begin_s, lasted_s, stood, recovery_s, wheels_s, disturbed)


def drive(robot: Robot) -> tuple[float, float]:
    """Good pictures until the robot tracks and moves, and its wheels too: after how long [robot s], [wall s]."""
    robot.show_good()
    first_s, first_wall_s = robot.now_s, time.monotonic()
    while not robot.tracking and robot.now_s - first_s < RECOVERED_WITHIN_S:
        robot.show_good()
    recovery_s = robot.now_s - first_s
    while not robot.base_driving and robot.now_s - first_s < RECOVERED_WITHIN_S:
        robot.show_good()
    if not robot.base_driving:
        robot.violations.append(f"{robot.fault}: the wheels do not drive, at {robot.now_s:.1f} s of robot time")
    return recovery_s, time.monotonic() - first_wall_s

"""A commander in place of a coordinator, pilotfish-base in dry run, a bridge, and a subscriber of /cmd_vel: each in a
process of its own."""

from __future__ import annotations

import itertools
import signal
import sys
import time
from collections.abc import Callable
from typing import Any

from ros_graphs import Graph, Heard

from build_tree import ROOT
from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, find_executable

WITHIN_S = 20.0
SPEED_MPS = 0.3
TWISTS = {"ros1": "geometry_msgs/msg/Twist", "ros2": "geometry_msgs/msg/TwistStamped"}  # the bridges' defaults
ZEROS = 10  # in a row: the robot stands
_numbers = itertools.count()


def now_us() -> int:
    """CLOCK_BOOTTIME."""
    return time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000


def twist_of(heard: Heard) -> Any:
    """Of a Twist or a TwistStamped."""
    return getattr(heard.message, "twist", heard.message)


def moves(heard: Heard) -> bool:
    """Whether the wheels would turn."""
    return (twist_of(heard).linear.x, twist_of(heard).angular.z) != (0.0, 0.0)


class Chain:
    """As a context manager: bridge and subscriber. ``driving()`` adds a base and a commander."""

    def __init__(self, graph: Graph, url: str, *options: str, ros_name: str | None = None) -> None:
        self.graph, self.url, self.topic = graph, url, graph.topic("cmd_vel")
        self.listener = graph.listen(self.topic, ros_name or TWISTS[graph.name])
        self.bridge = graph.bridge("cmd-vel", "robot1", "--topic", self.topic, "--lcm-url", url, *options)
        self.base: Child | None = None
        self.commander: Child | None = None

    def driving(self) -> Chain:
        """At the commanded speed, from standing."""
        self.listener.forget()
        self.wait(lambda heard: len(heard) >= ZEROS and not any(map(moves, heard[-ZEROS:])), "zeros")
        self.listener.forget()
        if self.base is None:
            config = shipped.path("config/base.yaml")
            base = [find_executable(BASE), "--config", config, "--driver", "dry_run", "--lcm-url", self.url]
            self.base = Child(base, self.graph.folder, f"base{next(_numbers)}")
        if self.commander is None:
            program = [sys.executable, ROOT / "tests" / "base" / "commander.py", self.url, "robot1", str(SPEED_MPS)]
            self.commander = Child(program, self.graph.folder, f"commander{next(_numbers)}")
        self.reach_speed()
        return self

    def reach_speed(self) -> None:
        """Waits for the commanded speed."""
        self.wait(lambda heard: bool(heard) and twist_of(heard[-1]).linear.x == SPEED_MPS, "the commanded speed")

    def wait(self, condition: Callable[[list[Heard]], bool], what: str) -> None:
        """Until the condition holds for what has been heard."""
        self.bridge.wait_until(lambda: condition(self.listener.heard()), WITHIN_S, what)

    def end_drivers(self) -> None:
        """Neither base nor commander."""
        for child in filter(None, (self.commander, self.base)):
            child.process.send_signal(signal.SIGCONT)
            child.terminate()
        self.base = self.commander = None

    def zeros_after(self, event_us: int) -> int:
        """Waits for ``ZEROS`` zeros in a row; how long after the event the first of them came [us]."""

        def standing(heard: list[Heard]) -> bool:
            return len(heard) >= ZEROS and heard[-ZEROS].at_us > event_us and not any(map(moves, heard[-ZEROS:]))

        self.wait(standing, "zeros")
        heard = self.listener.heard()
        last_motion = max(k for k, each in enumerate(heard) if moves(each))
        return heard[last_motion + 1].at_us - event_us

    def __enter__(self) -> Chain:
        return self

    def __exit__(self, *_: object) -> None:
        self.end_drivers()
        self.bridge.terminate()
        self.listener.terminate()

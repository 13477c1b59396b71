"""Leader intents on their way down a chain: each robot announces what it is about to drive, and when."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from pilotfish import coordinator, core
from pilotfish.errors import UsageError

MAX_DELAY_S = 1.0


@dataclass(frozen=True)
class Network:
    """What an announcement meets between two robots. ``delay_s`` 0 is the same period of the camera: a robot's answer
    to its picture is there before the next robot answers to its own."""

    delay_s: float = 0.0
    loss: float = 0.0

    def __post_init__(self) -> None:
        for key, value, most in (("delay_s", self.delay_s, MAX_DELAY_S), ("loss", self.loss, 1.0)):
            if not 0.0 <= value <= most:
                raise UsageError(f"{key}: {value:g} is not allowed: 0 to {most:g}")


@dataclass
class Announcements:
    """From one robot to the one behind it, in order; what is lost is a function of the seed."""

    network: Network
    seed: int
    _underway: deque[tuple[float, int, core.Twist]] = field(default_factory=deque)
    _random: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self._random = np.random.default_rng(self.seed)

    def send(self, now_s: float, utime: int, twist: core.Twist) -> None:
        """At ``now_s``: a robot will have this twist at ``utime`` [us]."""
        if self._random.random() >= self.network.loss:
            self._underway.append((now_s + self.network.delay_s, utime, twist))

    def deliver(self, now_s: float, to: coordinator.Coordinator) -> None:
        """What has arrived by ``now_s``."""
        while self._underway and self._underway[0][0] <= now_s + 1e-9:
            _, utime, twist = self._underway.popleft()
            to.set_leader_intent(utime, twist)


def listening(config: coordinator.CoordinatorConfig) -> None:
    """``config`` feeds forward what its leader announces."""
    control = config.control
    intent = control.leader_intent
    intent.feed_forward = True
    control.leader_intent = intent
    config.control = control

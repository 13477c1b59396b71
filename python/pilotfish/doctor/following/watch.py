"""What was received of one robot while it was watched. Data; what it means is said in evidence.py and causes.py."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from pilotfish.lcmtypes.pilotfish import base_t, command_t, observation_t, status_t
from pilotfish.watching import ImageHead, Kind, Message, watch

_SAMPLES = 12  # pictures kept for looking at
_SAMPLE_EVERY_S = 0.4
_MOST = 64  # other robots, and channels of pictures, that are remembered


@dataclass
class Images:
    """Pictures of one channel: when and how large, and a few of them whole."""

    heads: list[tuple[float, int, int, int]] = field(default_factory=list)  # arrival [s], utime [us], width, height
    samples: list[ImageHead] = field(default_factory=list)
    _last_sample_s: float = -1e9

    def add(self, arrival_s: float, head: ImageHead) -> None:
        """Remembers the picture's data; its pixels only now and then."""
        self.heads.append((arrival_s, head.utime, head.width, head.height))
        if arrival_s - self._last_sample_s >= _SAMPLE_EVERY_S and len(self.samples) < _SAMPLES:
            self._last_sample_s = arrival_s
            self.samples.append(head)


@dataclass
class Watched:
    """Everything of ``robot``, with the arrival on this process's monotonic clock [s]."""

    robot: str
    seconds: float
    start_s: float = 0.0
    statuses: list[tuple[float, status_t]] = field(default_factory=list)
    commands: list[tuple[float, command_t]] = field(default_factory=list)
    observations: list[tuple[float, observation_t]] = field(default_factory=list)
    bases: list[tuple[float, base_t]] = field(default_factory=list)
    images: dict[str, Images] = field(default_factory=dict)  # of all channels, whoever they are meant for
    unreadable: dict[str, int] = field(default_factory=dict)  # channel -> messages of no known version
    others: set[str] = field(default_factory=set)  # other robots that have a coordinator
    other_bases: set[str] = field(default_factory=set)  # other robots that have a pilotfish-base

    def add(self, message: Message) -> None:
        """Files a message."""
        if message.kind is Kind.image and (message.channel in self.images or len(self.images) < _MOST):
            self.images.setdefault(message.channel, Images()).add(message.arrival_s, message.value)
        elif message.robot != self.robot.lower():
            if message.kind in (Kind.status, Kind.command) and len(self.others) < _MOST:
                self.others.add(message.robot)
            elif message.kind is Kind.base and len(self.other_bases) < _MOST:
                self.other_bases.add(message.robot)
        elif message.kind is Kind.unreadable:
            self.unreadable[message.channel] = self.unreadable.get(message.channel, 0) + 1
        else:
            lists = {
                Kind.status: self.statuses,
                Kind.command: self.commands,
                Kind.observation: self.observations,
                Kind.base: self.bases,
            }
            lists[message.kind].append((message.arrival_s, message.value))

    @classmethod
    def of(cls, robot: str, seconds: float, messages: Iterable[Message]) -> Watched:
        """From messages that were received within ``seconds``."""
        import time

        watched = cls(robot, seconds, start_s=time.monotonic())
        for message in messages:
            watched.add(message)
        return watched


def watch_robot(robot: str, url: str, seconds: float, on_time: Callable[[float], None]) -> Watched:
    """Listens to the bus. SilentRobotError if there is none."""
    return Watched.of(robot, seconds, watch(url, seconds, on_time))

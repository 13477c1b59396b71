"""The same pictures, in turn, to a liblcm that only answers and to a pilotfish-coordinator: how long until the command?

Four arms have a bus each and 30 pictures a second each, a quarter of a period apart: both receivers raw, both JPEG. The
clock runs from just before publish() to the kernel's time stamp of the first command that names the picture.
"""

from __future__ import annotations

import math
import os
import select
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import lcm
from receiver import Received, Receiver

from bench.common import wire
from bench.common.processes import process, real_time, work
from pilotfish import data, sim
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.harness.ports import private_lcm_url

RATE_HZ = 30.0
WARM_UP = 60  # pictures before those that count: until the leader is followed and the memory is there
# Below all that is measured: on one core the sender, once publish() has returned, must not hold the receivers up.
SENDER_PRIORITY = 5


@dataclass(frozen=True)
class Condition:
    words: str
    receiver_cores: frozenset[int]  # empty: any
    sender_cores: frozenset[int]
    busy_loops: int = 0


_FIRST, _LAST = frozenset({0}), frozenset({(os.cpu_count() or 1) - 1})
CONDITIONS = {
    "idle": Condition("idle", frozenset(), frozenset()),
    "pinned": Condition("receiver on one core", _FIRST, _LAST),
    "one-core": Condition("all on one core", _FIRST, _FIRST),
    "busy": Condition("4 busy loops", frozenset(), frozenset(), busy_loops=4),
}


@dataclass(frozen=True)
class Delays:
    """Of one arm."""

    receiver: str  # "bare" or "pilotfish"
    picture: str  # "raw" or "JPEG"
    sent: int
    milliseconds: list[float]  # of those that were answered
    tracking: int  # of the answers
    other_commands: int  # between them
    looked_ms: list[float]  # what the coordinator says of itself
    inside_ms: list[float]
    first_ms: float  # of the very first picture, in which the leader had to be found


class _Arm:
    def __init__(self, receiver: str, picture: str, pictures: list[bytearray], url: str) -> None:
        self.receiver, self.picture = receiver, picture
        self.answers, self._out, self._pictures = Receiver(url), lcm.LCM(url), pictures
        self._sent_ns: dict[int, int] = {}
        self._first_ms = 0.0

    def show(self, number: int) -> None:
        message = self._pictures[number % len(self._pictures)]
        utime = time.clock_gettime_ns(time.CLOCK_MONOTONIC) // 1000
        message[8:16] = utime.to_bytes(8, "big")  # behind the fingerprint
        encoded = bytes(message)
        self._sent_ns[utime] = time.clock_gettime_ns(time.CLOCK_REALTIME)  # the clock of the kernel's stamps
        self._out.publish("ROBOT1_IMAGE", encoded)

    def begin(self) -> None:
        """What was received so far is forgotten, but for the first answer."""
        self._first_ms = next(iter(self._answered()), math.inf)
        self._sent_ns.clear()
        self.answers.received = Received()

    def _answered(self) -> list[float]:
        answers_ns = self.answers.received.answers_ns
        return [(answers_ns[utime] - sent_ns) * 1e-6 for utime, sent_ns in self._sent_ns.items() if utime in answers_ns]

    def delays(self) -> Delays:
        received, found = self.answers.received, self._answered()
        return Delays(
            self.receiver,
            self.picture,
            len(self._sent_ns),
            found,
            received.tracking,
            received.other_commands,
            received.looked_ms,
            received.inside_ms,
            self._first_ms,
        )


def measure(condition: Condition, frames: int, bare_transport: Path) -> list[Delays]:
    """`frames` pictures to each arm. Raises HarnessError if a receiver does not start."""
    pictures = moving_leader()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        for _ in range(condition.busy_loops):
            stack.enter_context(process(work))
        arms = []
        coordinator = [find_executable(COORDINATOR), "--config", data.path("config/line.yaml"), "--lcm-url"]
        for picture in pictures:
            for receiver, command in (("bare", [bare_transport]), ("pilotfish", coordinator)):
                url, name = private_lcm_url(), f"{receiver}-{picture}"
                child = stack.enter_context(Child([*_on(condition.receiver_cores), *command, url], Path(folder), name))
                child.wait_until(lambda child=child: "ready" in child.stdout(), 20.0, "being ready")
                arms.append(_Arm(receiver, picture, pictures[picture], url))
                stack.callback(arms[-1].answers.close)
        stack.enter_context(_on_cores(condition.sender_cores))
        stack.callback(real_time, 0)
        real_time(SENDER_PRIORITY)
        _show(arms, frames)
        return [arm.delays() for arm in arms]


def moving_leader() -> dict[str, list[bytearray]]:
    """Encoded pictures of two seconds of a leader that drives and then goes back, so that they can be repeated without
    a leap. On its way back it is seen half a period beside where it was seen before: a picture that was shown a moment
    ago is refused without a look at it, as of a camera that is frozen."""
    world = sim.World(sim.load_scenario(str(data.path("scenarios/line.yaml"))))
    robot = next(r.name for r in world.scenario.robots if r.follows)
    images = []
    for k in range(120):
        world.advance_to(k / (2 * RATE_HZ))
        images.append(world.capture(robot).image.copy())
    there_and_back = [*images[0::2], *images[::-2]]
    return {
        name: [bytearray(wire.encode_image(image, utime=0, jpeg=jpeg)) for image in there_and_back]
        for name, jpeg in (("raw", False), ("JPEG", True))
    }


def _show(arms: list[_Arm], frames: int) -> None:
    """To every arm at the camera's rate, without a pause behind the first ones. A turn that comes late moves the later
    ones; nothing is made up for."""
    receivers = {arm.answers.fileno(): arm.answers for arm in arms}
    turn_s = 1.0 / RATE_HZ / len(arms)
    due_s = time.monotonic()
    for number in range(WARM_UP + frames):
        for arm in arms:
            if number == WARM_UP:
                arm.begin()
            arm.show(number)
            due_s = max(due_s + turn_s, time.monotonic())
            _listen(receivers, due_s)
    _listen(receivers, due_s + 0.5)


def _listen(receivers: dict[int, Receiver], until_s: float) -> None:
    while (seconds := until_s - time.monotonic()) > 0:
        for ready in select.select(list(receivers), [], [], seconds)[0]:
            receivers[ready].listen()


def _on(cores: frozenset[int]) -> list[str]:
    return ["taskset", "-c", ",".join(map(str, sorted(cores)))] if cores else []


@contextmanager
def _on_cores(cores: frozenset[int]) -> Iterator[None]:
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, cores or before)
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)

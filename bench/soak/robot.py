"""A real pilotfish-coordinator and a real pilotfish-base that obeys it, and a camera for them in lock-step.

Robot time passes with the pictures' stamps: the next picture is shown when the last one has been answered. Where stamps
say nothing (they go back, leap by more than an hour, repeat, or no picture can be read), the coordinator's time passes
as the wall's does, so there the camera's rate is kept.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import urlparse

import lcm
import yaml
from pictures import Message, Pictures

from bench.common.configuration import shipped_coordinator
from pilotfish import bus, data, operating
from pilotfish.core import Status
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, COORDINATOR, find_executable
from pilotfish.harness.ports import private_lcm_url

NAME = "robot1"
FORGED_SESSION = 0x666F72676564  # of a base_t that is not the base's
RULE_S = 0.1  # nothing moves on a measurement that is older
LEAP_US = 3_600_000_000  # between two stamps: the simulated clock does not accept more
INTERRUPTION_S = 0.2  # of the wall: this script did not run for so long
_YOUNG_S = 3.5  # so long a pilotfish-base makes place for another, also for a forged one
_ANSWER_TIMEOUT_S = 0.5  # of the wall: then the picture, or its answer, was lost
_GIVE_UP = 20
_REMEMBERED = 1000  # stamps


class Robot:
    """Use as a context manager. `now_s` is robot time."""

    def __init__(self, folder: Path, rate_hz: float, pictures: Pictures) -> None:
        self.folder, self.rate_hz, self.period_s = folder, rate_hz, 1.0 / rate_hz
        self.pictures = pictures
        self.url = private_lcm_url()
        self.now_s = self.last_good_s = 0.0
        self.clock_us = 1_700_000_000_000_000  # what the camera's clock shows more than robot time
        self.paced = False  # show every picture at the camera's rate
        self.fault = ""  # what is going on, for the record
        self.violations: list[str] = []
        self.frames = self.commands = self.resent = 0
        self.interrupted = 0  # this script did not run for a while
        self.counter = 0  # of the last setpoint that was sent
        # what was received last
        self.session = self.base_session = 0
        self.status, self.tracking, self.moving = Status.searching, False, False
        self.base_driving = self.base_stopped = False
        self.said = ""  # the last command's status and reason
        self.stood = False  # a zero was received since this was set to false
        self.refused: dict[str, dict[str, int]] = {}  # what each process has counted
        self._answered, self._awaited = False, 0
        self._shown_at_s: dict[int, float] = {}
        self.last_stamp = 0
        self._last_good = pictures.good[0]
        self._by_the_wall = False
        self._next_wall_s = self._last_wall_s = time.monotonic()

    def __enter__(self) -> Robot:
        with ExitStack() as stack:
            key_file = self.folder / "key"
            operating.new_key(key_file)
            base_config, config = self._base_config(key_file), self._coordinator_config(key_file)
            command = [find_executable(BASE), "--config", base_config, "--driver", "dry_run", "--lcm-url", self.url]
            base = stack.enter_context(Child(command, self.folder, "base"))
            command = [find_executable(COORDINATOR), "--config", config, "--lcm-url", self.url, "--simulated-time"]
            self.coordinator = stack.enter_context(Child(command, self.folder, "coordinator"))
            self.coordinator.wait_until(lambda: "ready:" in self.coordinator.stdout(), 20.0, "being ready")
            self.children = {"coordinator": self.coordinator, "base": base}
            self.key = bus.load_key(str(key_file))
            self.out = lcm.LCM(self.url)
            self.authorised_bus = bus.Bus(self.url)  # with the key
            self.authorised_bus.set_key(self.key)
            self.unauthorised_bus = bus.Bus(self.url)  # without
            self.receiver = bus.Bus(self.url)
            self.receiver.set_key(self.key)
            self.receiver.on_command(NAME, self._on_command)
            self.receiver.on_base(NAME, self._on_base)
            self.datagrams = stack.enter_context(_Datagrams(self.url))
            self._wait(lambda: self.session != 0 and self.base_session != 0, "both send")
            grown_up_s = time.monotonic() + _YOUNG_S
            self._wait(lambda: time.monotonic() > grown_up_s, "some seconds")
            self._children = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._children.close()

    def now_us(self, later_s: float = 0.0) -> int:
        """By the camera's clock."""
        return self.clock_us + round((self.now_s + later_s) * 1e6)

    def show_good(self) -> None:
        """The next picture of the leader, with the right stamp."""
        self._last_good = self.pictures.good[self.frames % len(self.pictures.good)]
        self.show(self._last_good, good=True)

    def show_again(self) -> None:
        """The last picture of the leader, as a frozen camera does."""
        self.show(self._last_good)

    def show(self, message: Message, *, good: bool = False, utime: int | None = None, answered: bool = True) -> None:
        """A picture a period after the last one."""
        stamp = self.now_us(self.period_s) if utime is None else utime
        plausible = answered and 0 < stamp - self.last_stamp <= LEAP_US
        self._pass(self.period_s, by_the_wall=self.paced or not plausible)
        if good:
            self.last_good_s = self.now_s
        self.frames += 1
        self.send(message, stamp, answered=answered)

    def send(self, message: Message, stamp: int, *, answered: bool = True) -> None:
        """Now; and waits for the answer, if there is to be one."""
        self.last_stamp = stamp
        self._shown_at_s[stamp] = self.now_s
        while len(self._shown_at_s) > _REMEMBERED:
            del self._shown_at_s[next(iter(self._shown_at_s))]
        encoded = message.stamped(stamp)
        self._answered, self._awaited = False, stamp
        for _ in range(_GIVE_UP):
            self.out.publish("ROBOT1_IMAGE", encoded)
            if not answered:
                self._receive(0.001)
                return
            end_s = time.monotonic() + _ANSWER_TIMEOUT_S
            while not self._answered and (left_s := end_s - time.monotonic()) > 0:
                self._receive(left_s)
            if self._answered:
                return
            self.resent += 1
        raise self.coordinator.error(f"a picture is not answered ({self.fault or 'no fault'})")

    def rest(self, duration_s: float) -> None:
        """No pictures, in the wall's time: the coordinator's clock stands still, only its commands go on."""
        end_s = self.now_s + duration_s
        while (left_s := end_s - self.now_s) > 1e-9:
            self._pass(min(left_s, self.period_s), by_the_wall=True)

    def _pass(self, duration_s: float, *, by_the_wall: bool) -> None:
        self._by_the_wall = by_the_wall
        wall_s = time.monotonic()
        self._next_wall_s = max(self._next_wall_s + duration_s, wall_s) if by_the_wall else wall_s
        while (left_s := self._next_wall_s - time.monotonic()) > 0:
            self._receive(left_s)
        self.now_s += duration_s

    def _receive(self, at_most_s: float) -> None:
        """In small pieces, so that a longer time in here can only mean that this script was not running."""
        wait_s = min(at_most_s, 0.02)
        self.receiver.handle(max(int(wait_s * 1e3), 1))
        now_s = time.monotonic()
        self.interrupted += now_s - self._last_wall_s > wait_s + INTERRUPTION_S
        self._last_wall_s = now_s

    def _wait(self, condition: Callable[[], bool], what: str) -> None:
        end_s = time.monotonic() + 10.0
        while not condition():
            self.receiver.handle(20)
            if time.monotonic() > end_s:
                raise self.coordinator.error(f"not within 10 s: {what}")

    def _on_command(self, report: bus.CommandReport) -> None:
        if self.session == 0:
            self.session = report.session
        if report.session != self.session:
            return
        self.commands += 1
        self.status = report.status
        self.said = f"{report.status.name}, {report.reason.name}"
        self.moving = report.command.linear_mps != 0.0 or report.command.angular_radps != 0.0
        self.stood = self.stood or not self.moving
        self.tracking = self.moving and report.status == Status.tracking
        if report.utime == self._awaited:
            self._answered = True
        if not self.moving:
            return
        # In lock-step what is received belongs to the picture it answers; where nothing answers, to now.
        at_s = self.now_s if self._by_the_wall else self._shown_at_s.get(report.utime, self.now_s)
        age_s = at_s - self.last_good_s
        if age_s > RULE_S + 1e-6:
            what = f"{report.status.name} on a measurement {age_s:.3f} s old"
            self.violations.append(f"{self.fault or 'no fault'}: {what}, at {self.now_s:.1f} s of robot time")

    def _on_base(self, report: bus.BaseReport) -> None:
        if report.session == FORGED_SESSION:
            return
        self.base_session = report.session
        self.base_driving = report.state == bus.BaseReport.State.driving
        self.base_stopped = report.stopped
        self.refused["base"] = report.rejected

    def ask_what_was_refused(self) -> None:
        """Of the coordinator: it takes a second, in which no pictures are shown."""
        counters: dict[str, int] = {}
        asker = bus.Bus(self.url)
        asker.on_status(NAME, lambda report: counters.update(report.rejected))
        end_s = time.monotonic() + 1.0  # not all counters fit into one message
        while time.monotonic() < end_s:
            asker.handle(50)
        self.refused["coordinator"] = counters

    def _coordinator_config(self, key_file: Path) -> Path:
        """The shipped configuration, with a key, at the camera's rate, and listening to the leader's announcements."""
        config = shipped_coordinator()
        config |= {"frame_rate_hz": self.rate_hz, "key_file": str(key_file), "leader_intent_from": "leader"}
        file = self.folder / "coordinator.yaml"
        file.write_text(yaml.safe_dump(config))
        return file

    def _base_config(self, key_file: Path) -> Path:
        config = yaml.safe_load(data.path("config/base.yaml").read_text())
        config["key_file"] = str(key_file)
        file = self.folder / "base.yaml"
        file.write_text(yaml.safe_dump(config))
        return file


class _Datagrams:
    """Any bytes to the bus's port."""

    def __init__(self, url: str) -> None:
        parsed = urlparse(url)
        self.to = (parsed.hostname, parsed.port)

    def __enter__(self) -> _Datagrams:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def send(self, *datagrams: bytes) -> None:
        for datagram in datagrams:
            self.socket.sendto(datagram, self.to)

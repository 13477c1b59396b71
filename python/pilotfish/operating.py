"""An operator's requests to a coordinator: stop, resume, set the setpoint. Over LCM, until its status shows them.

Who may send what is in ``docs/operating-guide.md`` ("Who may command"): a stop is accepted from anyone; everything else
has to name the coordinator's session, which its status says, and a counter that rises. Counters are microseconds of the
wall clock here, so that they rise from one call to the next.
"""

from __future__ import annotations

import math
import os
import secrets
import threading
import time
import weakref
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from pilotfish.bus import BaseReport, Bus, BusError, Key, SetpointReport, StatusReport, channel, load_key
from pilotfish.core import Setpoint
from pilotfish.errors import ConfigError, OperatorError, SilentRobotError, UsageError

WITHIN_S = 3.0
_SEND_EVERY_S = 0.05
_MIN_STOPS = 3  # a datagram may be lost
_BASE_ANSWERS_WITHIN_S = 0.3  # pilotfish-base publishes its state 20 times a second or more

# What the counters of a status mean to whoever has just asked for something.
_REFUSALS = {
    "setpoint_mac_wrong": "its key is not yours (--key FILE: the coordinator's key_file)",
    "setpoint_wrong_session": "it has started anew in between: try again",
    "setpoint_replayed": "it has received a higher counter: is the clock of another operator ahead?",
    "setpoint_too_near": "the distance is below its stop distance (safety.stop_distance_m)",
    "setpoint_out_of_bounds": "the distance or the bearing is out of bounds",
    "setpoint_not_finite": "the distance or the bearing is no number",
    "setpoint_corrupt": "it did not understand the message: is it of another version?",
}


def new_key(path: Path) -> None:
    """Writes a key of random bytes that only its owner may read. Never over an old one."""
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError as error:
        raise ConfigError(
            f"{path} is there already: a key that is in use must not be lost; remove it, if you mean it"
        ) from error
    try:
        with os.fdopen(descriptor, "w") as file:
            file.write(secrets.token_hex(32) + "\n")
    except OSError:  # a full disk: half a key is none
        path.unlink(missing_ok=True)
        raise


class Operator:
    """A connection to one robot's coordinator. Each request returns the status that shows it.

    Raises SilentRobotError if no coordinator answers, and OperatorError if one does not comply.
    """

    def __init__(self, robot: str, *, lcm_url: str = "", key: Key | None = None, key_file: Path | None = None) -> None:
        try:
            channel(robot, "STATUS")
        except ValueError as error:
            raise UsageError(str(error)) from error
        try:
            if key_file is not None:
                key = load_key(str(key_file))
            self._bus = Bus(lcm_url)
            self._bus.on_status(robot, _weakly(self._on_status))
            self._bus.on_base(robot, _weakly(self._on_base))
        except BusError as error:
            raise SilentRobotError(str(error)) from error
        except ValueError as error:
            raise ConfigError(str(error)) from error
        if key is not None:
            self._bus.set_key(key)
        self.robot = robot
        self.status: StatusReport | None = None  # the last one received
        self.base: BaseReport | None = None  # the last one received from the wheels' process
        self.sent = 0  # messages, by the last request
        self._statuses = self._bases = 0
        self._rejected: dict[str, int] = {}
        self._counter = 0
        self._cancelled = threading.Event()

    def cancel(self) -> None:
        """From another thread: nothing but stops is sent from now on, because a resume that is still being sent must
        not end a stop that was asked for behind it."""
        self._cancelled.set()

    def listen(self, within_s: float = WITHIN_S) -> StatusReport:
        """The next status."""
        received = self._statuses
        self._wait(lambda: self._statuses > received, within_s)
        if self._statuses == received:
            raise SilentRobotError(self._no_reply_message(within_s))
        return self._status()

    def stop(self, within_s: float = WITHIN_S) -> StatusReport:
        """Sends from the first moment, also to a coordinator that does not answer; at least three times.

        Until the coordinator shows it, and the wheels (pilotfish-base), if they answer.
        """
        self.sent, received, bases = 0, self._statuses, self._bases
        wheels_stopped = lambda: self.base is None or (self._bases > bases and self._wheels_stopped())  # noqa: E731
        shows_it = lambda: self._statuses > received and not self._status().setpoint.run and wheels_stopped()  # noqa: E731
        give_up = time.monotonic() + within_s
        while self.sent < _MIN_STOPS or (not shows_it() and time.monotonic() < give_up):
            kept = self.status.setpoint if self.status else Setpoint()
            self._send(Setpoint.unchecked(distance_m=kept.distance_m, bearing_rad=kept.bearing_rad, run=False))
            self._wait(shows_it, _SEND_EVERY_S if self.sent >= _MIN_STOPS else 0.01)
        if self._statuses == received:
            only_wheels = self._bases > bases and self._wheels_stopped()
            answer = "only its wheels have confirmed" if only_wheels else "none was confirmed"
            raise SilentRobotError(f"{self.sent} stops were sent, and {answer}: {self._no_reply_message(within_s)}")
        if not shows_it():
            raise OperatorError(f"{self.sent} stops were sent in {within_s:g} s, and {self._says()}")
        return self._status()

    def resume(self, within_s: float = WITHIN_S) -> StatusReport:
        """Ends a stop; what was kept before is kept again.

        Raises OperatorError also if the wheels (pilotfish-base), which hold stops of their own, stay stopped: they are
        not asked again here, because between two messages another operator may have stopped the robot.
        """
        kept = self.listen(within_s).setpoint
        status = self._ask(Setpoint(distance_m=kept.distance_m, bearing_rad=kept.bearing_rad, run=True), within_s)
        received = self._bases
        self._wait(lambda: self._bases > received and not self._wheels_stopped(), _BASE_ANSWERS_WITHIN_S)
        if self._bases > received and self._wheels_stopped():
            raise OperatorError(
                f"the coordinator of {self.robot} runs, but its wheels stay stopped: ask once more; {self._says()}"
            )
        return status

    def set_setpoint(
        self, *, distance_m: float | None = None, bearing_rad: float | None = None, within_s: float = WITHIN_S
    ) -> StatusReport:
        """Sets the setpoint; None: unchanged. A robot that has been stopped stays stopped."""
        for name, number in (("distance_m", distance_m), ("bearing_rad", bearing_rad)):
            if number is not None and not math.isfinite(number):
                raise OperatorError(f"{name}: {number} is not a finite number")
        kept = self.listen(within_s).setpoint
        asked = Setpoint.unchecked(  # the coordinator says why not
            distance_m=kept.distance_m if distance_m is None else distance_m,
            bearing_rad=kept.bearing_rad if bearing_rad is None else bearing_rad,
            run=kept.run,
        )
        return self._ask(asked, within_s)

    def _ask(self, setpoint: Setpoint, within_s: float) -> StatusReport:
        before = self._status()
        if before.session == 0:
            raise OperatorError(f"the coordinator of {self.robot} does not say its session: is it of an older version?")
        rejected_before, complete = dict(self._rejected), "others" not in self._rejected
        self.sent, first = 0, None
        values = _values(setpoint)
        shows_it = lambda: first is not None and self._accepted(first) and _values(self._status().setpoint) == values  # noqa: E731
        give_up = time.monotonic() + within_s
        while not shows_it() and time.monotonic() < give_up:
            # Another operator has sent a setpoint as well: to ask once more could end a stop.
            if self._stopped_since(before) or (first is not None and self._accepted(first)):
                raise OperatorError(f"{self.robot} has received another setpoint in between; {self._says()}")
            if self._cancelled.is_set():
                raise OperatorError(f"cancelled before {self.robot} confirmed it; {self._says()}")
            counter = self._send(setpoint)
            first = first or counter
            self._wait(shows_it, _SEND_EVERY_S)
        if shows_it():
            return self._status()
        risen = [n for n, count in self._rejected.items() if count > rejected_before.get(n, 0 if complete else count)]
        reasons = [_REFUSALS[name] for name in risen if name in _REFUSALS]
        if not reasons and not setpoint.run:  # as a stop it was accepted
            reasons = ["a robot that is stopped takes over only what it could keep (bounds, stop distance, key)"]
        because = f"refused, because {'; '.join(reasons)}" if reasons else f"not confirmed within {within_s:g} s"
        raise OperatorError(f"{because}; {self._says()}")

    def _stopped_since(self, before: StatusReport) -> bool:
        now = self._status()
        return before.setpoint.run and not now.setpoint.run and now.session == before.session

    def _wheels_stopped(self) -> bool:
        return self.base is not None and self.base.stopped

    def _accepted(self, counter: int) -> bool:
        return self._status().setpoint_counter >= counter

    def _send(self, setpoint: Setpoint) -> int:
        session, last = (self.status.session, self.status.setpoint_counter) if self.status else (0, 0)
        self._counter = max(time.time_ns() // 1000, self._counter + 1, last + 1)
        report = SetpointReport(utime=time.time_ns() // 1000, session=session, counter=self._counter, setpoint=setpoint)
        try:
            self._bus.publish_setpoint(self.robot, report)
        except ValueError as error:
            raise OperatorError(str(error)) from error
        self.sent += 1
        return self._counter

    def _on_status(self, status: StatusReport) -> None:
        if self.status is not None and status.session != self.status.session:
            self._rejected.clear()
        self.status = status
        self._statuses += 1
        self._rejected |= status.rejected

    def _on_base(self, base: BaseReport) -> None:
        self.base = base
        self._bases += 1

    def _wait(self, condition: Callable[[], bool], timeout_s: float) -> None:
        deadline = time.monotonic() + timeout_s
        while not condition() and (left_s := deadline - time.monotonic()) > 0:
            self._bus.handle(max(1, int(left_s * 1000)))

    def _status(self) -> StatusReport:
        assert self.status is not None
        return self.status

    def _no_reply_message(self, within_s: float) -> str:
        return (
            f"no coordinator of {self.robot} answers on {self._bus.url} within {within_s:g} s; "
            "is pilotfish-coordinator running with that --name and --lcm-url?"
        )

    def _says(self) -> str:
        wheels = f"; its wheels say: {self.base.text or self.base.state.name}" if self.base else ""
        return f"{self.robot} says: {describe(self._status())}{wheels}"


def describe(status: StatusReport) -> str:
    """A status in one line: "tracking, keeps 1.10 m at -10.0 deg" """
    why = f": {status.reason.text}" if status.reason.text else ""
    kept = f"{status.setpoint.distance_m:.2f} m at {math.degrees(status.setpoint.bearing_rad):.1f} deg"
    return f"{status.status.name}{why}, {'keeps' if status.setpoint.run else 'would keep'} {kept}"


def _weakly(method: Callable[[Any], None]) -> Callable[[Any], None]:
    """The bus keeps its handlers; if one kept the operator, neither would ever go, nor the bus's descriptors."""
    reference = weakref.WeakMethod(method)

    def handle(report: Any) -> None:
        if (alive := reference()) is not None:
            alive(report)

    return handle


def _values(setpoint: Setpoint) -> Iterable[float]:
    return setpoint.distance_m, setpoint.bearing_rad, setpoint.run

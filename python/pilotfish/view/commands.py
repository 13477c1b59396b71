"""STOP, resume and setpoints of a page, through pilotfish.operating: sent until the robot confirms."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pilotfish.bus import Bus, BusError
from pilotfish.errors import PilotfishError
from pilotfish.operating import WITHIN_S, Operator, describe
from pilotfish.view.limits import SetpointLimits

ACTIONS = ("stop", "resume", "setpoint")
_STOPS, _OTHERS = 8, 4  # at once; each has a connection to the bus
_ANY = SetpointLimits()
MOST_REQUESTS = _STOPS + _OTHERS


@dataclass(frozen=True)
class Outcome:
    """What became of a request, for the page."""

    action: str
    confirmed: bool
    text: str
    sent: int  # messages
    run: bool | None = None  # whether the robot that confirmed it runs

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


class Commander:
    """Commands one bus's robots. A stop never waits for anything: it has threads of its own, and cancels what else is
    being sent to its robot, so that a resume that is still under way does not end it."""

    def __init__(self, lcm_url: str, key_file: Path | None = None, within_s: float = WITHIN_S) -> None:
        self._url, self._key_file, self._within_s = lcm_url, key_file, within_s
        self._stops = ThreadPoolExecutor(_STOPS, thread_name_prefix="stop")
        self._others = ThreadPoolExecutor(_OTHERS, thread_name_prefix="operate")
        self._under_way: dict[str, Operator] = {}
        self._busy: set[str] = set()
        self._spare = self._spare_buses()  # their descriptors are a stop's, should there be no others

    def close(self) -> None:
        """Waits for nothing: stops that are being sent are sent to their end, the rest is cancelled."""
        for operator in tuple(self._under_way.values()):
            operator.cancel()
        for executor in (self._stops, self._others):
            executor.shutdown(wait=False)

    async def do(self, robot: str, action: str, values: Mapping[str, Any], limits: SetpointLimits = _ANY) -> Outcome:
        """One of ACTIONS. Never raises for what a robot or a page does wrong: the outcome says so."""
        loop = asyncio.get_running_loop()
        if action == "stop":
            if (other := self._under_way.get(robot)) is not None:
                other.cancel()
            return await loop.run_in_executor(self._stops, self._stop, robot)
        if action not in ACTIONS:
            return Outcome(action, False, f"there is no {action!r}: {', '.join(ACTIONS)}", 0)
        try:
            distance_m, bearing_rad = (_number(values, name) for name in ("distance_m", "bearing_rad"))
        except ValueError as error:
            return Outcome(action, False, str(error), 0)
        if action == "setpoint" and distance_m is None and bearing_rad is None:
            return Outcome(action, False, "nothing to change: distance_m, bearing_rad or both", 0)
        if action == "setpoint" and (refused := limits.refusal(distance_m, bearing_rad)):
            return Outcome(action, False, refused, 0)
        if robot in self._busy:
            return Outcome(action, False, "another request is still being sent; try again when it is confirmed", 0)
        self._busy.add(robot)
        try:
            operator = Operator(robot, lcm_url=self._url, key_file=self._key_file)
            self._under_way[robot] = operator
            request = (
                (lambda: operator.resume(self._within_s))
                if action == "resume"
                else (
                    lambda: operator.set_setpoint(
                        distance_m=distance_m, bearing_rad=bearing_rad, within_s=self._within_s
                    )
                )
            )
            return await loop.run_in_executor(self._others, _outcome, action, operator, request)
        except PilotfishError as error:
            return Outcome(action, False, str(error), 0)
        finally:
            self._busy.discard(robot)
            self._under_way.pop(robot, None)

    def _stop(self, robot: str) -> Outcome:
        outcome = self._sent_stop(robot)
        if not self._spare:
            with contextlib.suppress(BusError):
                self._spare = self._spare_buses()
        return outcome

    def _sent_stop(self, robot: str) -> Outcome:
        try:
            operator = self._stopper(robot)
        except PilotfishError as error:
            return Outcome("stop", False, str(error), 0)
        return _outcome("stop", operator, lambda: operator.stop(self._within_s))

    def _stopper(self, robot: str) -> Operator:
        try:
            return Operator(robot, lcm_url=self._url)  # needs no key
        except PilotfishError:
            self._spare = []
            return Operator(robot, lcm_url=self._url)

    def _spare_buses(self) -> list[Bus]:
        """Two: a bus that is being opened needs more descriptors than one that is open and receives nothing."""
        return [Bus(self._url) for _ in range(2)]


def _outcome(action: str, operator: Operator, request: Any) -> Outcome:
    try:
        status = request()
    except PilotfishError as error:
        return Outcome(action, False, str(error), operator.sent)
    return Outcome(action, True, describe(status), operator.sent, run=bool(status.setpoint.run))


def _number(values: Mapping[str, Any], name: str) -> float | None:
    value = values.get(name)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError(f"{name}: {value!r} is not a finite number")
    return float(value)

"""From a coordinator to ROS: NAME_STATUS as diagnostics, NAME_OBSERVATION as the leader's pose."""

from __future__ import annotations

import select
import struct
import time
from collections.abc import Callable
from typing import Any

import lcm

from pilotfish.bus import channel
from pilotfish.errors import ConfigError
from pilotfish.lcmtypes.pilotfish.observation_t import observation_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t
from pilotfish.ros.conversions import LeaderPose, leader_pose
from pilotfish.ros.diagnosis import Diagnosis, diagnose, silent

_EVERY_S = 1.0  # the usual rate of /diagnostics
_SILENT_S = 2.0
_MOST_AT_ONCE = 100  # messages, so that a flood holds up no diagnosis


class ReportOutlet:
    """``handle`` calls ``on_diagnosis`` once a second and when level or message change, and ``on_leader`` for every
    picture in which the leader was measured."""

    def __init__(
        self,
        robot: str,
        lcm_url: str,
        on_diagnosis: Callable[[Diagnosis], None],
        on_leader: Callable[[LeaderPose], None],
    ) -> None:
        self._robot, self._on_diagnosis, self._on_leader = robot, on_diagnosis, on_leader
        self._latest: Diagnosis | None = None
        self._published: Diagnosis | None = None
        self._heard_s = time.monotonic()
        self._due_s = self._heard_s + _SILENT_S
        try:
            status, observation = channel(robot, "STATUS"), channel(robot, "OBSERVATION")
            self._lcm = lcm.LCM(lcm_url) if lcm_url else lcm.LCM()
        except ValueError as error:
            raise ConfigError(str(error)) from error
        except RuntimeError as error:
            raise ConfigError(f"{lcm_url or '$LCM_DEFAULT_URL'}: not a bus that LCM can open") from error
        self._lcm.subscribe(status, self._on_status)
        self._lcm.subscribe(observation, self._on_observation)

    def handle(self, timeout_ms: int) -> None:
        """Waits up to ``timeout_ms`` for messages, then handles those that have come."""
        # Not lcm's own wait: a signal ends that with an error.
        for k in range(_MOST_AT_ONCE):
            if not select.select([self._lcm], [], [], 0.0 if k else timeout_ms / 1000)[0]:
                break
            self._lcm.handle()
        now_s = time.monotonic()
        if now_s - self._heard_s >= _SILENT_S:
            self._latest = silent(self._robot, _SILENT_S)
        if self._latest and (now_s >= self._due_s or self._differs(self._latest)):
            self._on_diagnosis(self._latest)
            self._published, self._due_s = self._latest, now_s + _EVERY_S

    def _differs(self, diagnosis: Diagnosis) -> bool:
        last = self._published
        return last is None or (last.level, last.message) != (diagnosis.level, diagnosis.message)

    def _on_status(self, _: str, data: bytes) -> None:
        if (status := _decoded(status_t, data)) is not None:
            self._latest, self._heard_s = diagnose(status), time.monotonic()

    def _on_observation(self, _: str, data: bytes) -> None:
        observation = _decoded(observation_t, data)
        if observation is not None and (pose := leader_pose(observation)) is not None:
            self._on_leader(pose)


def _decoded(kind: Any, data: bytes) -> Any:
    try:
        return kind.decode(data)
    except (ValueError, struct.error, IndexError):
        return None  # of another version, or damaged; pilotfish-coordinator counts such, this only passes on

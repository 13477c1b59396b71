"""One row a frame, from the messages that speak of it: a call of the core (black box), an observation, a status, a
command.

They come in about this order, from different threads, and any of them may be missing. A row is complete when all have
come that a frame has, or when eight newer frames have begun.

Status, reason and command are those that left. On a busy computer they are not always those that the core had decided,
which only a black box knows: a measurement that has become too old meanwhile is answered with zeros.
"""

from __future__ import annotations

import math
from collections import OrderedDict, deque
from dataclasses import dataclass, field
from typing import Any

from pilotfish.logs.clock import RunClock
from pilotfish.logs.columns import CORNERS, NO_FRAME, NONE, STOP_REQUESTED, TRACKING

_OPEN = 8
_ANSWERS_KEPT = 64
_OF_STATUS = (
    *("error_change_m", "output", "feed_forward_weight", "leader_radial_mps", "leader_tangential_mps"),
    *("leader_turn_rate_radps", "drive_latency_s", "drive_latency_sigma_s", "drive_lag_s", "drive_lag_sigma_s"),
)
_LEADER = ("leader_radial_mps", "leader_tangential_mps", "leader_turn_rate_radps")


@dataclass
class FrameRow:
    """A row of the table "frames" and the rows of "tags" that belong to it."""

    values: dict[str, Any]
    tags: list[dict[str, Any]] = field(default_factory=list)
    heard: set[str] = field(default_factory=set)


class FrameRows:
    """Joins one robot's messages to rows; ``finished`` gives what is complete, in the order of the frames."""

    def __init__(self, clock: RunClock) -> None:
        self._clock = clock
        self._open: deque[FrameRow] = deque()
        self._answers: OrderedDict[int, Any] = OrderedDict()  # by the frame's stamp
        self._simulated = False
        self._last_utime: int | None = None  # of the last finished row

    def step(self, log_utime: int, message: Any) -> None:
        """A call of the core with a frame."""
        row = self._row(message.utime, "STEP", log_utime, message.now_us)
        row.values |= {
            "arrival_us": message.now_us,
            "known_age_s": message.known_age_us * 1e-6,
            "coarse_search": bool(message.coarse_search),
            "measured": bool(message.measurement),
            "status": message.status,
            "reason": message.reason,
            "command_linear_mps": message.command_linear_mps,
            "command_angular_radps": message.command_angular_radps,
        }
        if message.measurement:
            seen = message.measurement[0]
            row.values |= _seen(seen) | {"found_by": seen.found_by, "heading_ambiguity": seen.heading_ambiguity}
            row.tags = [_tag(tag) for tag in seen.tags]

    def observation(self, log_utime: int, message: Any) -> None:
        """What went over the bus of the same; without a black box the only source."""
        if self._is_no_frame(message):
            return
        row = self._row(message.utime, "OBSERVATION", log_utime)
        row.values["latency_s"] = message.latency_s
        if "STEP" in row.heard:
            return
        row.values |= {"measured": bool(message.detected), "reason": message.reason}
        if message.detected:
            row.values |= _seen(message)
            row.tags = [_tag(tag) for tag in message.tags]

    def status(self, log_utime: int, message: Any) -> None:
        """The law's intermediate results."""
        if self._is_no_frame(message):
            return
        row = self._row(message.utime, "STATUS", log_utime)
        values = row.values
        values |= {
            "status": message.status,  # as it was answered: the core's own may have come too late to be sent
            "reason": message.reason,
            "setpoint_distance_m": message.setpoint_distance_m,
            "setpoint_bearing_rad": message.setpoint_bearing_rad,
            "setpoint_run": bool(message.setpoint_run),
            "loop_latency_s": message.latency_s,
            "latency_from_exposure": bool(message.latency_from_exposure),
            "processing_ms": message.processing_ms,
            "frame_rate_hz": message.frame_rate_hz,
            "missed_deadlines": message.missed_deadlines,
            "clock_epochs": message.clock_epochs,
            "leader_index": message.leader_index,
            "leader_changes": message.leader_changes,
            "ego_motion": message.ego_motion,
            "leader_intent": message.leader_intent,
            "session": message.session,
        }
        if message.status != TRACKING:
            return  # the law has not been asked: its zeros mean nothing
        values["error_m"] = message.error_m
        values |= {name: getattr(message, name) for name in _OF_STATUS}
        if message.feed_forward_weight == 0.0:
            for name in _LEADER:
                del values[name]  # zeros that mean nothing

    def command(self, message: Any) -> None:
        """The first command that names a frame answers it; what is sent between frames repeats its stamp, and says that
        no frame came."""
        self._simulated = self._simulated or bool(getattr(message, "simulated", False))
        if message.utime not in self._answers and message.reason != NO_FRAME:
            self._answers[message.utime] = message
            while len(self._answers) > _ANSWERS_KEPT:
                self._answers.popitem(last=False)

    def finished(self, *, at_end: bool = False) -> list[FrameRow]:
        """What is complete by now; everything at the end, or before a gap."""
        done = []
        while self._open and (at_end or len(self._open) > _OPEN or self._is_complete(self._open[0])):
            done.append(self._finish(self._open.popleft()))
        return done

    def _is_no_frame(self, message: Any) -> bool:
        """Reports between frames repeat the stamp of the last one, and so does the very last report of a program."""
        repeats = message.utime == self._last_utime and all(
            row.values["utime_us"] != message.utime for row in self._open
        )
        return message.reason == NO_FRAME or (message.reason == STOP_REQUESTED and repeats)

    def _row(self, utime: int, kind: str, log_utime: int, arrival_us: int = NONE) -> FrameRow:
        for row in reversed(self._open):
            if row.values["utime_us"] == utime and kind not in row.heard:
                row.heard.add(kind)
                return row
        t_s = self._clock.of_frame(utime, log_utime, arrival_us, simulated=self._simulated)
        row = FrameRow({"t_s": t_s, "utime_us": utime, "log_utime_us": log_utime}, heard={kind})
        self._open.append(row)
        return row

    def _is_complete(self, row: FrameRow) -> bool:
        answered = "STEP" in row.heard or row.values["utime_us"] in self._answers
        return answered and {"OBSERVATION", "STATUS"} <= row.heard

    def _finish(self, row: FrameRow) -> FrameRow:
        values = row.values
        self._last_utime = values["utime_us"]
        answer = self._answers.get(values["utime_us"])
        if answer is not None:  # what left, also where the core had decided otherwise: a busy computer sends a zero
            values |= {"command_linear_mps": answer.linear_mps, "command_angular_radps": answer.angular_radps}
            if "STATUS" not in row.heard:
                values |= {"status": answer.status, "reason": answer.reason}
        if "error_m" not in values and "distance_m" in values and "setpoint_distance_m" in values:
            values["error_m"] = values["setpoint_distance_m"] - values["distance_m"]
        values["tag_count"] = len(row.tags)
        for tag in row.tags:
            tag |= {"t_s": values["t_s"], "utime_us": values["utime_us"]}
        return row


def _seen(message: Any) -> dict[str, Any]:
    """Of a measurement_t or an observation_t: the same names."""
    sigmas = [math.sqrt(message.covariance[i][i]) if message.covariance[i][i] >= 0 else math.nan for i in range(3)]
    named = (
        "distance_m",
        "bearing_rad",
        "heading_rad",
        "reprojection_error_px",
        "ambiguity_ratio",
        "min_decision_margin",
    )
    return {name: getattr(message, name) for name in named} | dict(
        zip(("distance_sigma_m", "bearing_sigma_rad", "heading_sigma_rad"), sigmas, strict=True)
    )


def _tag(tag: Any) -> dict[str, Any]:
    corners = [number for corner in tag.corners_px for number in corner]
    said = {"id": tag.id, "hamming": tag.hamming, "decision_margin": tag.decision_margin}
    return said | dict(zip(CORNERS, corners, strict=True))

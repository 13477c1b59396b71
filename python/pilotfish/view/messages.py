"""Bytes from the bus to plain values for the page. What cannot be read raises MalformedError; NaN becomes None."""

from __future__ import annotations

import math
from typing import Any

from pilotfish.core import Reason
from pilotfish.lcmtypes.pilotfish import base_t, command_t, observation_t, status_t
from pilotfish.stage_words import stage_words

MAX_MESSAGE_BYTES = 16384  # of the four below; the longest that a coordinator sends has 1400
MAX_TAGS = 12
_MAX_TEXT = 300
STATUS_NAMES = ("searching", "tracking", "coasting", "lost", "stopped", "invalid_input")
_REASONS = {int(reason): reason for reason in Reason.__members__.values()}
BASE_STATES = ("waiting", "driving", "stopped", "fault")

Values = dict[str, Any]


class MalformedError(ValueError):
    """Bytes that are no message of this type and version."""


def decode(kind: str, data: bytes) -> Values:
    """A message on a channel that ends in ``kind``: STATUS, OBSERVATION, COMMAND or BASE."""
    if len(data) > MAX_MESSAGE_BYTES:
        raise MalformedError(f"{len(data)} bytes")
    message_type, read = _READERS[kind]
    try:
        return read(message_type.decode(data))
    except Exception as error:  # lcm-gen's decoders raise whatever the bytes lead to
        raise MalformedError(f"{type(error).__name__}: {error}") from error


def finite(value: float) -> float | None:
    """JSON has no NaN and no infinity, and a page must not show one as a number."""
    return value if math.isfinite(value) else None


def _name(names: tuple[str, ...], number: int) -> str:
    return names[number] if 0 <= number < len(names) else f"unknown ({number})"


def _reason(number: int) -> tuple[str, str]:
    """Name and text of a reason."""
    reason = _REASONS.get(number)
    return (reason.name, reason.text) if reason is not None else (f"reason_{number}", f"reason {number}")


def _said(text: str, otherwise: str) -> str:
    """Of "lost: no tag of the leader's body in the picture (saw id 20)" what stands behind the status, for people: it
    has the numbers of the reason. A sender without it: the reason's own text."""
    return text.partition(": ")[2][:_MAX_TEXT] or otherwise


def _status(message: status_t) -> Values:
    reason, text = _reason(message.reason)
    text = _said(message.text, text)
    numbers = (
        *("error_m", "error_change_m", "output", "feed_forward_weight", "leader_radial_mps", "leader_tangential_mps"),
        *("leader_turn_rate_radps", "frame_rate_hz", "processing_ms", "latency_s", "drive_latency_s"),
        *("drive_latency_sigma_s", "drive_lag_s", "drive_lag_sigma_s", "configured_latency_s"),
        *("setpoint_distance_m", "setpoint_bearing_rad"),
    )
    values: Values = {name: finite(getattr(message, name)) for name in numbers}
    return values | {
        "utime_us": message.utime,
        "status": _name(STATUS_NAMES, message.status),
        "reason": reason,
        "text": text,
        "session": str(message.session),
        "setpoint_run": bool(message.setpoint_run),
        "latency_from_exposure": bool(message.latency_from_exposure),
        "missed_deadlines": message.missed_deadlines,
        "clock_epochs": message.clock_epochs,
        "leader_index": message.leader_index,
        "leader_changes": message.leader_changes,
        "stages": [
            {
                "name": stage.name[:12],
                "words": stage_words(stage.name[:12]),
                "counts": list(stage.counts),
                "max_ms": finite(stage.max_ms),
            }
            for stage in message.stages[:6]
        ],
        "rejected": {counter.name[:24]: counter.count for counter in message.rejected[:24]},
        "strengths": [finite(strength) for strength in message.strengths],
    }


def _observation(message: observation_t) -> Values:
    reason, text = _reason(message.reason)
    numbers = ("distance_m", "bearing_rad", "heading_rad", "reprojection_error_px", "ambiguity_ratio")
    values: Values = {name: finite(getattr(message, name)) for name in (*numbers, "min_decision_margin", "latency_s")}
    pose = [[finite(number) for number in row] for row in message.camera_from_leader]
    return (
        values
        | {
            "utime_us": message.utime,
            "detected": bool(message.detected)
            and values["distance_m"] is not None
            and values["bearing_rad"] is not None,
            "reason": reason,
            "text": text,
            "sigma": [_root(message.covariance[k][k]) for k in range(3)],  # of distance [m], bearing, heading [rad]
            "camera_from_leader": pose if all(number is not None for row in pose for number in row) else None,
            "tags": [
                {"id": tag.id, "hamming": tag.hamming, "corners_px": [list(corner) for corner in tag.corners_px]}
                for tag in message.tags[:MAX_TAGS]
                if all(math.isfinite(number) for corner in tag.corners_px for number in corner)
            ],
        }
    )


def _root(variance: float) -> float | None:
    return math.sqrt(variance) if math.isfinite(variance) and variance >= 0 else None


def _command(message: command_t) -> Values:
    reason, text = _reason(message.reason)
    return {
        "utime_us": message.utime,
        "session": str(message.session),
        "linear_mps": finite(message.linear_mps),
        "angular_radps": finite(message.angular_radps),
        "simulated": bool(message.simulated),
        "status": _name(STATUS_NAMES, message.status),
        "reason": reason,
        "text": text,
    }


def _base(message: base_t) -> Values:
    numbers = ("linear_mps", "angular_radps", "measured_linear_mps", "measured_angular_radps")
    values: Values = {name: finite(getattr(message, name)) for name in numbers}
    return values | {
        "measured": bool(message.measured),
        "stopped": bool(message.stopped),
        "state": _name(BASE_STATES, message.state),
        "text": message.text[:80],
        "session": str(message.session),
        "rejected": {counter.name[:24]: counter.count for counter in message.rejected[:24]},
    }


_READERS = {
    "STATUS": (status_t, _status),
    "OBSERVATION": (observation_t, _observation),
    "COMMAND": (command_t, _command),
    "BASE": (base_t, _base),
}

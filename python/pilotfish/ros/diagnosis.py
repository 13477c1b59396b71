"""NAME_STATUS as a diagnostic_msgs/DiagnosticStatus."""

from __future__ import annotations

from dataclasses import dataclass

from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t

OK, WARN, ERROR, STALE = range(4)  # of diagnostic_msgs/DiagnosticStatus

_LEVELS = {
    command_t.STATUS_TRACKING: OK,
    command_t.STATUS_STOPPED: OK,  # as an operator wanted it
    command_t.STATUS_SEARCHING: WARN,
    command_t.STATUS_COASTING: WARN,
    command_t.STATUS_LOST: ERROR,
    command_t.STATUS_INVALID_INPUT: ERROR,
}
# With their units in the names, as on the wire.
_NUMBERS = (
    "error_m",
    "feed_forward_weight",
    "frame_rate_hz",
    "processing_ms",
    "latency_s",
    "drive_latency_s",
    "drive_lag_s",
    "setpoint_distance_m",
    "setpoint_bearing_rad",
    "missed_deadlines",
)


@dataclass(frozen=True)
class Diagnosis:
    """The content of one DiagnosticStatus; ``level`` is one of OK, WARN, ERROR, STALE."""

    level: int
    message: str
    values: tuple[tuple[str, str], ...]


def diagnose(status: status_t) -> Diagnosis:
    """What a coordinator's status says. Its counters of refusals are values named ``rejected.NAME``."""
    values = [(name, f"{getattr(status, name):.6g}") for name in _NUMBERS]
    values += [(f"rejected.{counter.name}", str(counter.count)) for counter in status.rejected]
    return Diagnosis(_LEVELS.get(status.status, ERROR), status.text, tuple(values))


def silent(robot: str, seconds: float) -> Diagnosis:
    """When no status comes any more."""
    return Diagnosis(STALE, f"no {robot.upper()}_STATUS for {seconds:.0f} s: is pilotfish-coordinator running?", ())

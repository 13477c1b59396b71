"""The tables of a run, column by column: the only place that says their names, types, units and meaning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pilotfish import core

NONE = -1  # of an integer or a word: nothing is known


@dataclass(frozen=True)
class Column:
    """One column. ``kind``: "float" (NaN: not known), "int" (-1: not known), "bool", "word" (a code of ``words``,
    -1: none) or "text"."""

    name: str
    kind: str
    unit: str
    text: str
    words: tuple[str, ...] = ()

    @property
    def missing(self) -> Any:
        """What stands in a row that says nothing about this column."""
        return {"float": float("nan"), "int": NONE, "bool": False, "word": NONE, "text": ""}[self.kind]

    def word(self, code: int) -> str:
        """The word of a code; what a newer program may have written as "unknown (CODE)"."""
        if code == NONE:
            return ""
        return self.words[code] if 0 <= code < len(self.words) else f"unknown ({code})"


def _words(enumeration: Any) -> tuple[str, ...]:
    members = {int(member.value): name for name, member in enumeration.__members__.items()}
    return tuple(members.get(code, f"unknown ({code})") for code in range(max(members) + 1))


STATUS_WORDS, REASON_WORDS, FOUND_BY_WORDS = _words(core.Status), _words(core.Reason), _words(core.FoundBy)
EGO_MOTION_WORDS = ("commanded", "odometry")
LEADER_INTENT_WORDS = ("silent", "probation", "agrees", "used", "suspended")
TRACKING = STATUS_WORDS.index("tracking")
NO_FRAME, STOP_REQUESTED = REASON_WORDS.index("no_frame"), REASON_WORDS.index("stop_requested")


def _float(name: str, unit: str, text: str) -> Column:
    return Column(name, "float", unit, text)


def _int(name: str, unit: str, text: str) -> Column:
    return Column(name, "int", unit, text)


_T_S = _float("t_s", "s", "time since the recording began; it follows the stamps of the frames")
_LOGGED = _int("log_utime_us", "us", "wall clock of the computer that recorded")
_STATUS = Column("status", "word", "", "what the coordinator was doing", STATUS_WORDS)
_REASON = Column("reason", "word", "", "why", REASON_WORDS)

FRAMES = (
    _T_S,
    _int("utime_us", "us", "exposure of the frame, on the clock that stamps the images"),
    _LOGGED,
    _int("arrival_us", "us", "arrival of the frame, on the coordinator's monotonic clock; a black box knows it"),
    _float("known_age_s", "s", "what is known to have passed from the exposure to the arrival; a black box knows it"),
    Column("measured", "bool", "", "the leader was measured in this very frame"),
    _STATUS,
    _REASON,
    _float("distance_m", "m", "d, between the two base origins"),
    _float("bearing_rad", "rad", "theta of the leader's base origin, positive: to the left"),
    _float("heading_rad", "rad", "psi, the leader's heading relative to the coordinator's, filtered"),
    _float("distance_sigma_m", "m", "standard deviation of distance_m"),
    _float("bearing_sigma_rad", "rad", "standard deviation of bearing_rad"),
    _float("heading_sigma_rad", "rad", "standard deviation of heading_rad"),
    _float("heading_ambiguity", "", "probability of the other heading; a black box knows it"),
    _float("reprojection_error_px", "px", "RMS over all corners used"),
    _float("ambiguity_ratio", "", "error of the worse planar solution over the better one's"),
    _float("min_decision_margin", "gray levels", "least decision margin of the tags used"),
    Column("found_by", "word", "", "where the tags were found; a black box knows it", FOUND_BY_WORDS),
    Column("coarse_search", "bool", "", "searched at half the resolution; a black box knows it"),
    _int("tag_count", "", "tags used"),
    _float("command_linear_mps", "m/s", "forward speed of the command that answers this frame, as it was sent"),
    _float("command_angular_radps", "rad/s", "turn rate of the same command, positive: to the left"),
    _float("setpoint_distance_m", "m", "d_p"),
    _float("setpoint_bearing_rad", "rad", "theta_pd"),
    Column("setpoint_run", "bool", "", "the operator lets it drive"),
    _float("error_m", "m", "e = d_p - d, positive: too close"),
    _float("error_change_m", "m", "ec: change of e over one control period"),
    _float("output", "", "u of the fuzzy law, in its universe -1 to 1"),
    _float("feed_forward_weight", "", "share of the feed-forward in the command; 0: the law as published"),
    _float("leader_radial_mps", "m/s", "the leader's own speed along the line of sight, positive: away"),
    _float("leader_tangential_mps", "m/s", "the leader's own speed across it, positive: to the left"),
    _float("leader_turn_rate_radps", "rad/s", "the leader's turn rate, positive: to the left"),
    Column("ego_motion", "word", "", "where the own motion is taken from", EGO_MOTION_WORDS),
    Column("leader_intent", "word", "", "how the leader intent is used", LEADER_INTENT_WORDS),
    _float("latency_s", "s", "from the frame's arrival to the report of this frame"),
    _float("loop_latency_s", "s", "to the command, median of the last frames, as the coordinator measures it"),
    Column("latency_from_exposure", "bool", "", "loop_latency_s counts from the exposure; else from the arrival"),
    _float("processing_ms", "ms", "computing time of this frame"),
    _float("frame_rate_hz", "Hz", "as the coordinator measures it"),
    _float("drive_latency_s", "s", "from the exposure to the wheels, as it is used: configured, or identified"),
    _float("drive_latency_sigma_s", "s", "standard deviation of its identification"),
    _float("drive_lag_s", "s", "time constant of the wheels' speed control, as it is used"),
    _float("drive_lag_sigma_s", "s", "standard deviation of its identification"),
    _int("missed_deadlines", "", "commands that left later than they were due, since the program's start"),
    _int("clock_epochs", "", "how often the clock of the images was set, since the program's start"),
    _int("leader_index", "", "who is followed: 0 the configured leader, 1 the first of alternatives.leaders, ..."),
    _int("leader_changes", "", "how often that has changed, since the program's start"),
    _int("session", "", "the coordinator's, another one with every start"),
)
CORNERS = tuple(f"{axis}{corner}_px" for corner in range(4) for axis in "uv")
TAGS = (
    _T_S,
    _int("utime_us", "us", "exposure of the frame in which the tag was seen"),
    _int("id", "", "of the tag"),
    _int("hamming", "", "corrected bits"),
    _float("decision_margin", "gray levels", "mean contrast of the bits"),
    *(
        _float(name, "px", "corner: bottom left, bottom right, top right, top left, as one reads it")
        for name in CORNERS
    ),
)
COMMANDS = (
    _T_S,
    _LOGGED,
    _int("utime_us", "us", "exposure of the frame that this answers; of the last one, when none came"),
    _int("session", "", "the sender's"),
    _int("counter", "", "one more with every command of a session"),
    _STATUS,
    _REASON,
    _float("linear_mps", "m/s", "forward speed"),
    _float("angular_radps", "rad/s", "turn rate, positive: to the left"),
)
WHEELS = (
    _T_S,
    _LOGGED,
    _float("linear_mps", "m/s", "the wheels' command, after all limits"),
    _float("angular_radps", "rad/s", "the same, turn rate"),
    _float("measured_linear_mps", "m/s", "by the wheels' encoders"),
    _float("measured_angular_radps", "rad/s", "by the wheels' encoders"),
    Column("stopped", "bool", "", "a stop is latched"),
    Column("state", "word", "", "what the wheels' process was doing", ("waiting", "driving", "stopped", "fault")),
)
POSES = (
    _T_S,
    _int("utime_us", "us", "for which the pose holds"),
    _float("x_m", "m", "position in the local frame"),
    _float("y_m", "m", "position in the local frame"),
    _float("heading_rad", "rad", "direction of the base's x axis in the local frame"),
)
INTENTS = (
    _T_S,
    _int("utime_us", "us", "for which the twist holds"),
    _float("linear_mps", "m/s", "forward speed that the robot announces"),
    _float("angular_radps", "rad/s", "turn rate that the robot announces"),
)
ODOMETRY = (
    _T_S,
    _int("utime_us", "us", "for which the twist holds"),
    _float("linear_mps", "m/s", "forward speed by the robot's own odometry, as the coordinator was given it"),
    _float("angular_radps", "rad/s", "turn rate, likewise"),
)
EVENTS = (
    _T_S,
    _LOGGED,
    Column("kind", "text", "", "start, begin, status, setpoint, stop, resume, gap, damage, counter or configuration"),
    Column("text", "text", "", "what happened, in words"),
)
TABLES: dict[str, tuple[Column, ...]] = {
    "frames": FRAMES,
    "tags": TAGS,
    "commands": COMMANDS,
    "wheels": WHEELS,
    "poses": POSES,
    "odometry": ODOMETRY,
    "intents": INTENTS,
    "events": EVENTS,
}

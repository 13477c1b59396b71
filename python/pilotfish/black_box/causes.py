"""Where two computations of the same frame part, in words: which input, or which stage of the law.

The coordinator publishes with every frame what it saw (observation_t) and the law's intermediate results (status_t),
and its black box keeps both. So a command that differs is traced: is the measurement that is replayed the one that was
published, and which intermediate result is the first that differs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pilotfish import core
from pilotfish.black_box.bits import same_bits
from pilotfish.coordinator import HeldCommand

# In the order in which they are computed, with the fields of status_t that show them.
STAGES = (
    ("the distance error e", ("error_m",)),
    ("the change ec of the distance error", ("error_change_m",)),
    ("the identification of the drive", ("drive_latency_s", "drive_lag_s")),
    ("the estimate of the leader's motion", ("leader_radial_mps", "leader_tangential_mps", "leader_turn_rate_radps")),
    ("the weight of the feed-forward", ("feed_forward_weight",)),
    ("the output u of the fuzzy law", ("output",)),
)
Answer = tuple[core.Status, core.Reason, core.Twist]
_MEASURED = ("distance_m", "bearing_rad", "heading_rad")


def input_cause(published: Any, measurement: Any | None) -> str | None:
    """An observation_t against the measurement_t of the same frame: the input that is not as it was; None if it is."""
    if bool(published.detected) != (measurement is not None):
        return "the input: whether the leader was measured is not recorded as it was published"
    if measurement is None:
        return None
    for name in _MEASURED:
        was, now = getattr(published, name), getattr(measurement, name)
        if not same_bits(was, now):
            return f"the input: {name} was published as {was!r} and is recorded as {now!r}"
    return None


def stage_cause(status: Any, values: Mapping[str, Any]) -> str:
    """A status_t against step_values() of the same frame: the first stage that differs."""
    for stage, names in STAGES:
        for name in names:
            was, now = getattr(status, name), values.get(name) or 0.0  # nothing goes over the wire as 0
            if not same_bits(was, now):
                return f"the first stage that differs is {stage}: {name} was {was!r}, is now {now!r}"
    return "all intermediate results of the law agree; what differs is behind them: heading controller, limits, safety"


def observation_cause(was: core.Observation | None, now: core.Observation | None) -> str:
    """What vision saw otherwise."""
    if was is None or now is None:
        return "the leader was " + ("not measured then, and is now" if was is None else "measured then, and is not now")
    ids, ids_now = [tag.id for tag in was.tags], [tag.id for tag in now.tags]
    if ids != ids_now:
        return f"other tags were used: {ids} then, {ids_now} now"
    if was.found_by != now.found_by:
        return f"the tags were found by {was.found_by.name} then, by {now.found_by.name} now"
    off_px = max((float(np.abs(a.corners_px - b.corners_px).max()) for a, b in zip(was.tags, now.tags, strict=True)))
    if off_px > 0.0:
        return f"the corners of the tags differ, by {off_px:.3g} px at most"
    for name in _MEASURED:
        if not same_bits(getattr(was.measured, name), getattr(now.measured, name)):
            return f"the same corners gave another pose: {name} of this frame alone differs"
    for name in _MEASURED:
        if not same_bits(getattr(was, name), getattr(now, name)):
            return f"this frame's pose agrees; {name} of the filter over the frames differs"
    return "distance, bearing and heading agree; a covariance or a figure of quality differs"


def answer_cause(was: Answer, now: Answer) -> str:
    """What of an answer differs."""
    if was[0] != now[0]:
        return f"the status: {was[0].name} then, {now[0].name} now"
    if was[1] != now[1]:
        return f"the reason: {was[1].name} then, {now[1].name} now"
    parts = [
        f"the {what} by {now_value - was_value:.3g} {unit}"
        for what, unit, was_value, now_value in (
            ("forward speed", "m/s", was[2].linear_mps, now[2].linear_mps),
            ("turn rate", "rad/s", was[2].angular_radps, now[2].angular_radps),
        )
        if not same_bits(was_value, now_value)
    ]
    return " and ".join(parts) or "nothing"


def held_cause(was: HeldCommand, now: HeldCommand) -> str:
    """What of a held command differs."""
    for name in ("run", "ever_measured", "holding", "utime", "from_us", "until_us"):
        if getattr(was, name) != getattr(now, name):
            return f"{name}: {getattr(was, name)} then, {getattr(now, name)} now"
    same = (core.Status.tracking, core.Reason.none)
    return answer_cause((*same, was.command), (*same, now.command))

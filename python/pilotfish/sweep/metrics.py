"""The figures of one run that a campaign keeps, and how a run came out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pilotfish.metrics import MIN_SETTLED_S, Metrics, evaluate, steady_window
from pilotfish.recording import Recording


@dataclass(frozen=True)
class Metric:
    """A column of the results."""

    name: str
    unit: str  # as axes show it
    text: str
    of: Callable[[Recording, Metrics], float | None]
    missing: str = ""  # why a run that was simulated may not have it


def _largest_mm(run: Recording, _: Metrics) -> float:
    return 1e3 * float(np.abs(run.distance_error_m[steady_window(run.time_s)]).max())


_STEADY = "over the last quarter of the run"
METRICS = {
    metric.name: metric
    for metric in (
        Metric("rms_distance_mm", "mm", f"RMS distance error, {_STEADY}", lambda _, m: 1e3 * m.rms_error_m),
        Metric(
            "steady_distance_mm", "mm", f"mean distance error, {_STEADY}", lambda _, m: 1e3 * m.steady_state_error_m
        ),
        Metric("max_distance_mm", "mm", f"largest distance error, {_STEADY}", _largest_mm),
        Metric("overshoot_mm", "mm", "how far inside the distance it came", lambda _, m: 1e3 * m.overshoot_m),
        Metric(
            "settling_s",
            "s",
            "until it stayed within 50 mm of its steady state; missing if it did not",
            lambda _, m: m.settling_time_s,
            missing="a run has it only if its distance stayed within 50 mm of its steady state for the last quarter of "
            f"the run and for at least {MIN_SETTLED_S:g} s",
        ),
        Metric("rms_bearing_deg", "°", f"RMS bearing error, {_STEADY}", lambda _, m: m.rms_bearing_error_deg),
        Metric("mean_bearing_deg", "°", f"mean bearing error, {_STEADY}", lambda _, m: m.mean_bearing_error_deg),
        Metric("rms_jerk_mps3", "m/s³", "RMS jerk of the command, of the whole run", lambda _, m: m.rms_jerk_mps3),
        Metric("tracked_percent", "%", "of the delivered pictures", lambda _, m: 100.0 * m.frames_detected_ratio),
        Metric(
            "min_distance_m",
            "m",
            "smallest distance between the turning centres",
            lambda run, _: float(run.true_distance_m.min()),
        ),
    )
}

OK, COLLISION, LOST, ERROR, DIED = "ok", "collision", "leader_lost", "error", "worker_died"
OUTCOMES = {
    OK: "it followed to the end",
    COLLISION: "the robots came nearer to each other than `collision_distance_m`",
    LOST: "for the last `lost_after_s` of the run, or longer, the leader was not measured",
    ERROR: "it could not be simulated; no figures",
    DIED: "it ended its worker, four times; no figures",
}


def figures(recording: Recording, names: tuple[str, ...]) -> dict[str, float | None]:
    """The metrics of those names; None where the run has no such figure."""
    evaluated = evaluate(recording)
    return {name: METRICS[name].of(recording, evaluated) for name in names}


def outcome(recording: Recording, collision_distance_m: float, lost_after_s: float) -> tuple[str, str]:
    """One of OUTCOMES, and the reason in words."""
    near = np.flatnonzero(recording.true_distance_m < collision_distance_m)
    if near.size:
        first = near[0]
        return COLLISION, f"{recording.true_distance_m[first]:.3f} m apart after {recording.time_s[first]:.2f} s"
    tracked = np.flatnonzero(recording.status == "tracking")
    last_s = recording.time_s[tracked[-1]] if tracked.size else recording.time_s[0]
    if recording.time_s[-1] - last_s >= lost_after_s - 1e-9:
        return LOST, f"not measured after {last_s:.2f} s" if tracked.size else "never measured"
    return OK, ""

"""What a run amounts to: distance error, settling, bearing error, frames detected.

Notation: e(t) = d_p - d(t) is the distance error (positive: too close), b(t) = theta(t) - theta_pd the
bearing error, both of the TRUE relative pose, so that an error of the camera is not mistaken for success.

The *steady window* W is the last quarter of the run. Figures "after settling" are taken over W and not from
the settling time on, because a run that has just entered the band still creeps, and that would leak into the
steady-state error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.recording import FloatArray, Recording

SETTLING_BAND_M = 0.05
STEADY_FRACTION = 0.25
MIN_SETTLED_S = 2.0


@dataclass(frozen=True)
class Metrics:
    """The figures of one run; see ``evaluate``."""

    duration_s: float
    initial_distance_m: float
    final_distance_m: float
    initial_error_m: float
    final_error_m: float
    steady_state_error_m: float
    rms_error_m: float
    settling_time_s: float | None  # None: not settled
    overshoot_m: float
    mean_bearing_error_deg: float
    rms_bearing_error_deg: float
    frames_detected_ratio: float
    rms_jerk_mps3: float

    @property
    def settled(self) -> bool:
        """Whether the distance came to its steady state and stayed there."""
        return self.settling_time_s is not None


def evaluate(recording: Recording) -> Metrics:
    """All figures of a run whose setpoint is known."""
    meta = recording.meta
    if not np.isfinite([meta.distance_setpoint_m, meta.bearing_setpoint_rad]).all():
        raise ValueError(
            "the recording does not say its setpoint: give it with "
            "recording.with_meta(distance_setpoint_m=..., bearing_setpoint_rad=...)"
        )
    time_s, error_m = recording.time_s, recording.distance_error_m
    steady = steady_window(time_s)
    bearing_deg = np.degrees(recording.bearing_error_rad)
    return Metrics(
        duration_s=float(time_s[-1] - time_s[0]),
        initial_distance_m=float(recording.true_distance_m[0]),
        final_distance_m=float(recording.true_distance_m[-1]),
        initial_error_m=float(error_m[0]),
        final_error_m=float(error_m[-1]),
        steady_state_error_m=steady_state_error_m(time_s, error_m),
        rms_error_m=_rms(error_m[steady]),
        settling_time_s=settling_time_s(time_s, error_m),
        overshoot_m=overshoot_m(error_m),
        mean_bearing_error_deg=float(bearing_deg[steady].mean()),
        rms_bearing_error_deg=_rms(bearing_deg[steady]),
        frames_detected_ratio=frames_detected_ratio(recording),
        rms_jerk_mps3=rms_jerk_mps3(recording),
    )


def steady_window(time_s: FloatArray) -> np.ndarray:
    """Mask (N,) of W = { t : t >= t_0 + 3/4 (t_end - t_0) }."""
    start_s = time_s[0] + (1.0 - STEADY_FRACTION) * (time_s[-1] - time_s[0])
    return time_s >= start_s - 1e-9


def steady_state_error_m(time_s: FloatArray, error_m: FloatArray) -> float:
    """The steady-state error: mean of e over the steady window W [m]."""
    return float(error_m[steady_window(time_s)].mean())


def settling_time_s(time_s: FloatArray, error_m: FloatArray, band_m: float = SETTLING_BAND_M) -> float | None:
    """Time from the start of the run after which |e(t) - steady-state error| <= band_m for good [s].

    The band lies around the steady-state error and not around zero: behind a moving leader the published law
    keeps one by construction, so a band around zero would say nothing about the transient. The time is that
    of the first sample of the last unbroken stretch inside the band; None if that stretch does not cover the
    whole steady window, or is shorter than MIN_SETTLED_S (whoever passes through the band is inside as well).
    """
    outside = np.flatnonzero(np.abs(error_m - steady_state_error_m(time_s, error_m)) > band_m)
    first = 0 if outside.size == 0 else int(outside[-1]) + 1
    if first > int(np.flatnonzero(steady_window(time_s))[0]) or time_s[-1] - time_s[first] < MIN_SETTLED_S:
        return None
    return float(time_s[first] - time_s[0])


def overshoot_m(error_m: FloatArray) -> float:
    """How far inside the distance d_p the robot came: max(0, max_t e(t)) [m], start included."""
    return float(max(0.0, error_m.max()))


def frames_detected_ratio(recording: Recording) -> float:
    """Share of the delivered frames in which the leader was measured (status "tracking"); 0 if none was
    delivered."""
    delivered = recording.delivered
    return float((recording.status[delivered] == "tracking").mean()) if delivered.any() else 0.0


def rms_jerk_mps3(recording: Recording) -> float:
    """RMS over the whole run of the second difference of the commanded speed over the frame period squared [m/s3]."""
    period_s = float(np.median(np.diff(recording.time_s))) if len(recording) > 2 else np.inf
    return _rms(np.diff(recording.command_linear_mps, 2) / period_s**2) if len(recording) > 2 else 0.0


def _rms(values: FloatArray) -> float:
    """sqrt(mean(x^2)), about zero: a steady-state error counts."""
    return float(np.sqrt(np.mean(np.square(values))))

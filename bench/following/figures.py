"""What is measured of one run, by scenario. Errors are of the true relative pose; e = d_p - d, positive: too close."""

from __future__ import annotations

import numpy as np

from pilotfish.metrics import rms_jerk_mps3
from pilotfish.recording import Recording

# When the start is over and errors begin to count, by scenario [s]; a settled law has nothing left of it then.
SETTLED_S = {"stop_dead": 5.0, "start": 3.0, "reverse": 3.0}
STOP_S = 10.0
OCCLUDED_S = (15.0, 16.0)
BAND_M = 0.05
HALF_VIEW_RAD = np.arctan(320.0 / 600.0)  # 640 px at f = 600 px; the camera looks straight ahead
HALF_LEADER_M = 0.15
REFERENCE_SPEED_MPS, LATENCY_S, LAG_S, ACCELERATION_MPS2 = 0.2, 1.0 / 30.0, 0.1, 1.0


def physical_limit_m() -> float:
    """How much nearer no law can help to come behind a leader that stops dead: it goes on for latency and lag and then
    brakes, v (latency + lag) + v^2 / 2a. The time until the next exposure is not in it."""
    v = REFERENCE_SPEED_MPS
    return v * (LATENCY_S + LAG_S) + v**2 / (2.0 * ACCELERATION_MPS2)


def figures_of(scenario: str, run: Recording) -> dict[str, float]:
    """Named numbers in mm, degrees, seconds and m/s3."""
    time_s = run.time_s - run.time_s[0]
    error_mm, bearing_deg = 1000.0 * run.distance_error_m, np.degrees(run.bearing_error_rad)
    counts = time_s >= SETTLED_S.get(scenario, 8.0)
    figures = {
        "rms error [mm]": _rms(error_mm[counts]),
        "peak error [mm]": float(np.abs(error_mm[counts]).max()),
        "rms bearing [deg]": _rms(bearing_deg[counts]),
        "peak bearing [deg]": float(np.abs(bearing_deg[counts]).max()),
        "rms jerk [m/s3]": rms_jerk_mps3(run),
        "frames not measured": float(np.sum(run.status != "tracking")),
        "frames out of picture": float(np.sum(~_in_picture(run))),
    }
    if scenario in ("line", "circle"):
        figures["steady-state error [mm]"] = float(abs(error_mm[counts].mean()))
        figures["settling [s]"] = _last_outside_s(time_s, error_mm)
        figures["overshoot [mm]"] = max(0.0, float(error_mm.max()))
    if scenario == "stop_dead":
        stopped = time_s >= STOP_S
        closest_s = time_s[stopped][np.argmax(error_mm[stopped])]
        figures["closest approach [mm]"] = float(error_mm[stopped].max())
        # On the way back to d_p: how far beyond it.
        figures["reversal [mm]"] = max(0.0, float(-error_mm[time_s >= closest_s].min()))
    if scenario == "occlusion":
        hidden = (time_s >= OCCLUDED_S[0] + 0.1 + 1e-6) & (time_s < OCCLUDED_S[1] - 1e-6)
        after = time_s >= OCCLUDED_S[1] - 1e-6
        commands = np.hypot(run.command_linear_mps, run.command_angular_radps)
        figures["command 100 ms after [m/s]"] = float(np.abs(commands[hidden]).max())
        figures["back within 50 mm [s]"] = _last_outside_s(time_s[after] - OCCLUDED_S[1], error_mm[after])
    return figures


def _in_picture(run: Recording) -> np.ndarray:
    """Whether a disc around the leader's origin that holds its rear tag lies between the edges of the picture."""
    half_width_rad = np.arctan(HALF_LEADER_M / run.true_distance_m)
    return np.abs(run.true_bearing_rad) + half_width_rad <= HALF_VIEW_RAD


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _last_outside_s(time_s: np.ndarray, error_mm: np.ndarray) -> float:
    """From when on |e| <= 50 mm for good, about zero and not about a steady-state error; infinite if it is not."""
    outside = np.flatnonzero(np.abs(error_mm) > 1000.0 * BAND_M)
    if not outside.size:
        return 0.0
    return float(time_s[outside[-1] + 1]) if outside[-1] + 1 < len(time_s) else float("inf")

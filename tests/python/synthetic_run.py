"""A run written down by formula, so that every figure of it can be computed by hand."""

from __future__ import annotations

import numpy as np

from pilotfish.recording import Meta, Recording

DISTANCE_SETPOINT_M = 1.0
BEARING_SETPOINT_RAD = np.radians(-10.0)


def synthetic_run(time_s, error_m, bearing_error_rad=None, status=None, delivered=None, **meta) -> Recording:
    """A leader driving along x at 0.2 m/s; the robot behind it, at the distance that gives error_m."""
    time_s, error_m = np.asarray(time_s, dtype=float), np.asarray(error_m, dtype=float)
    n = len(time_s)
    distance_m = DISTANCE_SETPOINT_M - error_m
    bearing_rad = BEARING_SETPOINT_RAD + (np.zeros(n) if bearing_error_rad is None else bearing_error_rad)
    leader_x_m = 2.0 + 0.2 * time_s
    return Recording(
        meta=Meta(
            **{
                "robot": "robot1",
                "leader": "leader",
                "scenario": "synthetic",
                "profile": "paper",
                "distance_setpoint_m": DISTANCE_SETPOINT_M,
                "bearing_setpoint_rad": float(BEARING_SETPOINT_RAD),
            }
            | meta
        ),
        time_s=time_s,
        utime_us=np.round(1e6 * time_s).astype(np.int64),
        x_m=leader_x_m - distance_m,
        y_m=np.zeros(n),
        heading_rad=-bearing_rad,
        linear_mps=np.full(n, 0.2),
        angular_radps=np.zeros(n),
        leader_x_m=leader_x_m,
        leader_y_m=np.zeros(n),
        leader_heading_rad=np.zeros(n),
        leader_linear_mps=np.full(n, 0.2),
        true_distance_m=distance_m,
        true_bearing_rad=bearing_rad,
        true_heading_rad=bearing_rad,
        command_linear_mps=np.full(n, 0.2),
        command_angular_radps=np.zeros(n),
        status=np.full(n, "tracking") if status is None else np.asarray(status),
        delivered=np.ones(n, dtype=bool) if delivered is None else np.asarray(delivered),
        measured_distance_m=distance_m + 0.001,
        measured_bearing_rad=bearing_rad,
        measured_heading_rad=bearing_rad,
    )


def exponential_run(seconds: float = 20.0, rate_hz: float = 30.0, **kwargs) -> Recording:
    """e(t) = -0.1 - 1.3 exp(-t / 1.5): from 2.4 m down to 1.1 m, in the manner of the paper's Fig. 6."""
    time_s = np.arange(round(seconds * rate_hz) + 1) / rate_hz
    return synthetic_run(time_s, -0.1 - 1.3 * np.exp(-time_s / 1.5), **kwargs)

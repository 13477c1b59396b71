"""Where the leader was measured while it was watched, and how it stood in the camera's frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

_PART = 5  # first and last fifth of the measurements


@dataclass(frozen=True)
class Sight:
    """Medians of the pictures in which the leader was measured; NaN without any.

    ``up_in_camera``, ``origin_in_camera_m``: the leader's own upward axis (unit vector) and its base origin in the
    camera's frame (x right, y down, z forward).
    """

    measured: int = 0  # pictures
    bearing_first_rad: float = math.nan  # positive: to the left
    bearing_last_rad: float = math.nan
    up_in_camera: tuple[float, float, float] = (math.nan, math.nan, math.nan)
    origin_in_camera_m: tuple[float, float, float] = (math.nan, math.nan, math.nan)


def sight(observations: Sequence[tuple[float, Any]]) -> Sight:
    """Of observation_t with their arrivals."""
    seen = [observation for _, observation in observations if observation.detected]
    bearings = [observation.bearing_rad for observation in seen if math.isfinite(observation.bearing_rad)]
    poses = np.array([observation.camera_from_leader for observation in seen], dtype=float).reshape(-1, 3, 4)
    poses = poses[np.isfinite(poses).all(axis=(1, 2))]
    if not bearings or not len(poses):
        return Sight()
    part = max(1, len(bearings) // _PART)
    up, origin = np.median(poses[:, :, 2], axis=0), np.median(poses[:, :, 3], axis=0)
    length = float(np.linalg.norm(up))
    return Sight(
        measured=len(poses),
        bearing_first_rad=median(bearings[:part]),
        bearing_last_rad=median(bearings[-part:]),
        up_in_camera=_three(up / length) if length > 0.1 else Sight.up_in_camera,
        origin_in_camera_m=_three(origin),
    )


def _three(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z

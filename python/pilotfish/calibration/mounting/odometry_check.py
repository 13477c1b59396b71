"""What the robot's odometry is worth, beside what its camera saw: the scales of its turns and of its ways."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.mounting.drive import Drive
from pilotfish.calibration.mounting.phases import Odometry


@dataclass(frozen=True)
class OdometryScales:
    """Odometry's turn over the true one, and its way over the true one; None where there was no such part."""

    turn: float | None
    way: float | None


def odometry_scales(odometry: Odometry, utime: np.ndarray, drive: Drive) -> OdometryScales:
    """Slopes of straight lines through (seen, odometry) of the pictures at ``utime`` (N,) [us] of a Drive."""
    said = odometry.at(utime)
    turn, straight = drive.turning, ~drive.turning
    way = None
    if straight.any():
        ahead = drive.path[straight]
        x_y = said[straight, :2] - said[straight, :2].mean(axis=0)
        direction = np.linalg.svd(x_y, full_matrices=False)[2][0]
        way = abs(_slope(ahead, x_y @ direction))
    return OdometryScales(_slope(drive.path[turn], said[turn, 2]) if turn.any() else None, way)


def _slope(seen: np.ndarray, said: np.ndarray) -> float:
    seen = seen - seen.mean()
    return float(seen @ (said - said.mean()) / (seen @ seen))

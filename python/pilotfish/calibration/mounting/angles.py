"""Pan, tilt and roll of ``core.CameraMounting`` from a rotation: the inverse of ``CameraMounting.bMc``."""

from __future__ import annotations

import math

import numpy as np

# Columns: the camera's right, down and forward in the base frame when all angles are zero.
LOOKING_AHEAD = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def pan_tilt_roll(R_bc: np.ndarray) -> np.ndarray:
    """(3,) [rad] of a (3, 3) rotation from the camera's to the base frame.

    R_bc = Rz(pan) Ry(-tilt) Rx(roll) LOOKING_AHEAD. With M = R_bc LOOKING_AHEAD^T the first column is
    (cos pan cos tilt, sin pan cos tilt, sin tilt), the last row (sin tilt, cos tilt sin roll, cos tilt cos roll).
    A camera that looks straight up or down has only the sum of pan and roll; roll is 0 then.
    """
    M = R_bc @ LOOKING_AHEAD.T
    tilt = math.asin(float(np.clip(M[2, 0], -1.0, 1.0)))
    if abs(M[2, 0]) > 1.0 - 1e-9:
        return np.array([math.atan2(-M[0, 1], M[1, 1]), tilt, 0.0])
    return np.array([math.atan2(M[1, 0], M[0, 0]), tilt, math.atan2(M[2, 1], M[2, 2])])

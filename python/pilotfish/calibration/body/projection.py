"""The camera model of ``pilotfish.core.CameraModel`` for many points at once, with its derivative."""

from __future__ import annotations

import numpy as np

from pilotfish.core import CameraModel

NEAREST_M = 1e-3  # what is nearer, or behind the camera, is projected as if it were here: far off, and finite


def project(camera: CameraModel, points_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(..., 3) points in the camera frame to (..., 2) pixels and (..., 2, 3) derivatives [px/m].

    With r2 = x^2 + y^2 and radial(r2) = 1 + k1 r2 + k2 r2^2 + k3 r2^3 the model is written out in
    include/pilotfish/core/camera_model.hpp; the derivative differentiates it term by term.
    """
    depth = np.maximum(points_m[..., 2], NEAREST_M)
    x, y = points_m[..., 0] / depth, points_m[..., 1] / depth
    r2 = x * x + y * y
    radial = 1.0 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3))
    slope = 2.0 * (camera.k1 + r2 * (2.0 * camera.k2 + 3.0 * r2 * camera.k3))  # d radial / dx = slope x
    p1, p2 = camera.p1, camera.p2
    pixels = np.stack(
        [
            camera.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + camera.cx,
            camera.fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + camera.cy,
        ],
        axis=-1,
    )
    cross = slope * x * y + 2 * (p1 * x + p2 * y)
    du_dx = camera.fx * (radial + slope * x * x + 2 * p1 * y + 6 * p2 * x)
    dv_dy = camera.fy * (radial + slope * y * y + 6 * p1 * y + 2 * p2 * x)
    du_dy, dv_dx = camera.fx * cross, camera.fy * cross
    derivative = np.stack(
        [
            np.stack([du_dx, du_dy, -(du_dx * x + du_dy * y)], axis=-1),
            np.stack([dv_dx, dv_dy, -(dv_dx * x + dv_dy * y)], axis=-1),
        ],
        axis=-2,
    )
    return pixels, derivative / depth[..., None, None]

"""The camera model of ``pilotfish.core.CameraModel`` for many points at once, with its derivative."""

from __future__ import annotations

import numpy as np

from pilotfish.core import CameraModel, Lens

NEAREST_M = 1e-3  # what is nearer, or behind the camera, is projected as if it were here: far off, and finite
_ON_AXIS = 1e-6  # of the radius on the plane Z = 1: nearer, what a fisheye bends is of the order of its square


def project(camera: CameraModel, points_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(..., 3) points in the camera frame to (..., 2) pixels and (..., 2, 3) derivatives [px/m].

    The models are written out in include/pilotfish/core/camera_model.hpp.
    """
    depth = np.maximum(points_m[..., 2], NEAREST_M)
    x, y = points_m[..., 0] / depth, points_m[..., 1] / depth
    bend = _kannala_brandt if camera.lens == Lens.kannala_brandt else _brown_conrady
    bent_x, bent_y, xx, xy, yy = bend(camera, x, y)
    pixels = np.stack([camera.fx * bent_x + camera.cx, camera.fy * bent_y + camera.cy], axis=-1)
    du_dx, du_dy, dv_dx, dv_dy = camera.fx * xx, camera.fx * xy, camera.fy * xy, camera.fy * yy
    derivative = np.stack(
        [
            np.stack([du_dx, du_dy, -(du_dx * x + du_dy * y)], axis=-1),
            np.stack([dv_dx, dv_dy, -(dv_dx * x + dv_dy * y)], axis=-1),
        ],
        axis=-2,
    )
    return pixels, derivative / depth[..., None, None]


def _brown_conrady(camera: CameraModel, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
    """x', y', dx'/dx, dx'/dy (which is dy'/dx), dy'/dy. With r2 = x^2 + y^2 and radial(r2) = 1 + k1 r2 + k2 r2^2 +
    k3 r2^3 the derivative differentiates the model term by term."""
    r2 = x * x + y * y
    radial = 1.0 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3))
    slope = 2.0 * (camera.k1 + r2 * (2.0 * camera.k2 + 3.0 * r2 * camera.k3))  # d radial / dx = slope x
    p1, p2 = camera.p1, camera.p2
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        radial + slope * x * x + 2 * p1 * y + 6 * p2 * x,
        slope * x * y + 2 * (p1 * x + p2 * y),
        radial + slope * y * y + 6 * p1 * y + 2 * p2 * x,
    )


def _kannala_brandt(camera: CameraModel, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
    """The same of a fisheye: with scale = td / r, d(x', y')/d(x, y) = scale I + (d td/dr - scale) p p^T / r^2."""
    r = np.maximum(np.hypot(x, y), _ON_AXIS)
    t = np.arctan(r)
    k = np.array([1.0, camera.k1, camera.k2, camera.k3, camera.k4])
    powers = t[..., None] ** np.arange(0, 10, 2)
    scale = t * (powers @ k) / r
    slope = (powers @ (k * np.arange(1, 10, 2))) / (1.0 + r * r)
    across = (slope - scale) / (r * r)
    return x * scale, y * scale, scale + across * x * x, across * x * y, scale + across * y * y

"""A ``CameraModel`` for many points at once, and its inverse: written out once more, so that pictures for rehearsals
share no code with the fits that look at them.

Both models are OpenCV's. With x = X / Z, y = Y / Z, r^2 = x^2 + y^2 Brown and Conrady's lens has

    x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
    y' = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y

and Kannala and Brandt's, with theta the angle from the optical axis, the radius
theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8). A pixel is (fx x' + cx, fy y' + cy).
"""

from __future__ import annotations

import numpy as np

from pilotfish.core import CameraModel, Lens
from pilotfish.errors import ConfigError

_ITERATIONS = 60
_INVERTED_TO = 1e-6  # of the focal length: a thousandth of a pixel at f = 1000 px
_TINY = 1e-12


def project(camera: CameraModel, points_c: np.ndarray) -> np.ndarray:
    """(..., 3) points in the camera's frame [m] to (..., 2) pixels. Points behind a pinhole lens get pixels without
    meaning."""
    x, y, z = np.moveaxis(np.asarray(points_c, dtype=float), -1, 0)
    if camera.lens == Lens.kannala_brandt:
        across = np.hypot(x, y)
        scale = _bent(camera, np.arctan2(across, z)) / np.maximum(across, _TINY)
        x, y = np.where(across > _TINY, x * scale, 0.0), np.where(across > _TINY, y * scale, 0.0)
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            x, y = _distorted(camera, x / z, y / z)
    return np.stack([camera.fx * x + camera.cx, camera.fy * y + camera.cy], axis=-1)


def directions(camera: CameraModel, pixels: np.ndarray) -> np.ndarray:
    """(..., 2) pixels to the (..., 3) directions from which they are lit: unit vectors of a fisheye, (x, y, 1) of a
    pinhole. ConfigError if the lens cannot be inverted there."""
    pixels = np.asarray(pixels, dtype=float)
    x_d, y_d = (pixels[..., 0] - camera.cx) / camera.fx, (pixels[..., 1] - camera.cy) / camera.fy
    if camera.lens == Lens.kannala_brandt:
        return _fisheye_directions(camera, x_d, y_d)
    x, y = x_d.copy(), y_d.copy()
    off = np.inf
    for _ in range(_ITERATIONS):  # x = x_d - (what the lens adds at x): a contraction for a lens that bends mildly
        x_e, y_e = _distorted(camera, x, y)
        x, y = x + x_d - x_e, y + y_d - y_e
        off = max(np.abs(x_e - x_d).max(initial=0.0), np.abs(y_e - y_d).max(initial=0.0))
        if not off > _INVERTED_TO / 10:
            break
    _check_inverted(off)
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def _fisheye_directions(camera: CameraModel, x_d: np.ndarray, y_d: np.ndarray) -> np.ndarray:
    radius = np.hypot(x_d, y_d)
    theta = radius.copy()
    for _ in range(_ITERATIONS):
        theta = theta + radius - _bent(camera, theta)
    _check_inverted(np.abs(_bent(camera, theta) - radius).max(initial=0.0))
    if theta.max(initial=0.0) > np.pi:
        raise ConfigError("camera: this fisheye would look behind itself: take a narrower view (--fov-deg)")
    across = np.sin(theta) / np.maximum(radius, _TINY)
    return np.stack([x_d * across, y_d * across, np.cos(theta)], axis=-1)


def _check_inverted(off: float) -> None:
    if not off < _INVERTED_TO:
        raise ConfigError(
            "camera.distortion: this lens bends so strongly that two directions come to one pixel, or nearly so: take "
            "smaller coefficients, a narrower view, or a fisheye"
        )


def _bent(camera: CameraModel, theta: np.ndarray) -> np.ndarray:
    t2 = theta * theta
    return theta * (1.0 + t2 * (camera.k1 + t2 * (camera.k2 + t2 * (camera.k3 + t2 * camera.k4))))


def _distorted(camera: CameraModel, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    r2 = x * x + y * y
    radial = 1.0 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3))
    return (
        x * radial + 2.0 * camera.p1 * x * y + camera.p2 * (r2 + 2.0 * x * x),
        y * radial + camera.p1 * (r2 + 2.0 * y * y) + 2.0 * camera.p2 * x * y,
    )

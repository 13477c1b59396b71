"""A lens in another library's model."""

from __future__ import annotations

import numpy as np

from pilotfish import core


def visp_coefficients(camera: core.CameraModel, step_px: int = 16) -> tuple[float, float]:
    """(kud, kdu) of vpCameraParameters that come nearest to the lens over the frame.

    ViSP's model has one coefficient each way, with r the radius on the plane Z = 1:
        distorted = undistorted (1 + kud r_undistorted^2),   undistorted = distorted (1 + kdu r_distorted^2).
    Both are linear in the coefficient: with a = undistorted and b = distorted of a grid of pixels, least squares gives
        kud = sum (b - a) . a r_a^2 / sum (r_a^3)^2,   kdu = sum (a - b) . b r_b^2 / sum (r_b^3)^2.
    """
    columns, rows = np.meshgrid(np.arange(0, camera.width, step_px), np.arange(0, camera.height, step_px))
    pixels = np.stack([columns.ravel(), rows.ravel()], axis=1).astype(float)
    distorted = (pixels - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    undistorted = np.array([camera.normalize(pixel) for pixel in pixels])
    return _coefficient(undistorted, distorted), _coefficient(distorted, undistorted)


def _coefficient(a: np.ndarray, b: np.ndarray) -> float:
    """The k for which a (1 + k r_a^2) comes nearest to b."""
    cubic = a * (a**2).sum(axis=1, keepdims=True)
    return float(((b - a) * cubic).sum() / (cubic**2).sum())

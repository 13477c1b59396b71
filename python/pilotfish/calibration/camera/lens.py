"""The two lenses that are fitted, both exactly as OpenCV has them.

- ``pinhole``: Brown and Conrady's k1, k2, p1, p2, k3: the model of ``pilotfish.core.CameraModel``.
- ``fisheye``: Kannala and Brandt's: theta = atan2(hypot(X, Y), Z) becomes theta (1 + k1 theta^2 + ... + k4 theta^8).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.extras import require

MODELS = ("pinhole", "fisheye")
DISTORTION_NAMES = {"pinhole": ("k1", "k2", "p1", "p2", "k3"), "fisheye": ("k1", "k2", "k3", "k4")}


@dataclass(frozen=True)
class Lens:
    """Intrinsics of a camera: fx, fy, cx, cy [px] and the ``distortion`` of ``model``, in DISTORTION_NAMES' order."""

    model: str
    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of all parameters, in the order of ``values``."""
        return ("fx", "fy", "cx", "cy", *DISTORTION_NAMES[self.model])

    @property
    def values(self) -> np.ndarray:
        """(8,) or (9,): fx, fy, cx, cy and the distortion."""
        return np.array([self.fx, self.fy, self.cx, self.cy, *self.distortion])

    @property
    def matrix(self) -> np.ndarray:
        """(3, 3), OpenCV's camera matrix."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def project(self, points_m: np.ndarray, rotation: np.ndarray, translation_m: np.ndarray) -> np.ndarray:
        """(P, 3) points of a body at (rotation vector (3,), translation (3,)) in the camera's frame, to (P, 2) px."""
        return self.project_with_derivatives(points_m, rotation, translation_m)[0]

    def project_with_derivatives(
        self, points_m: np.ndarray, rotation: np.ndarray, translation_m: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Pixels (P, 2), their derivative by ``values`` (2 P, 8 or 9), and by the pose (2 P, 6)."""
        cv2 = require("cv2", "calibrate")
        points = np.ascontiguousarray(points_m, dtype=float).reshape(-1, 1, 3)
        r, t = (np.asarray(each, dtype=float).reshape(3, 1) for each in (rotation, translation_m))
        k = np.asarray(self.distortion, dtype=float)
        if self.model == "pinhole":
            pixels, J = cv2.projectPoints(points, r, t, self.matrix, k)
            pose, by_lens = J[:, :6], J[:, 6 : 10 + len(k)]
        else:  # columns: f, c, k, rotation, translation, skew
            pixels, J = cv2.fisheye.projectPoints(points, r, t, self.matrix, k)
            pose, by_lens = J[:, 8:14], J[:, :8]
        return pixels.reshape(-1, 2), by_lens, pose


def lens_of(model: str, size: tuple[int, int], matrix: np.ndarray, distortion: np.ndarray) -> Lens:
    """A Lens from OpenCV's camera matrix and distortion; ``size``: (width, height)."""
    wanted = len(DISTORTION_NAMES[model])
    k = tuple(float(value) for value in np.ravel(distortion)[:wanted])
    return Lens(model, *size, *(float(matrix[i, j]) for i, j in ((0, 0), (1, 1), (0, 2), (1, 2))), k)

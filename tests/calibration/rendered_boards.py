"""Calibration boards as a camera sees them, drawn by ``pilotfish.calibration.rehearsal``; and the two lenses, point by
point and in no words of the product's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.board import Board
from pilotfish.calibration.rehearsal import PictureFlaws, board_poses, render_board
from pilotfish.core import CameraModel, Lens


@dataclass(frozen=True)
class TrueCamera:
    """What the calibration is to find. ``distortion``: k1, k2, p1, p2, k3."""

    width: int = 640
    height: int = 480
    fx: float = 602.0
    fy: float = 598.5
    cx: float = 324.3
    cy: float = 236.1
    distortion: tuple[float, ...] = (-0.3, 0.1, 0.0, 0.0, 0.0)

    names = ("k1", "k2", "p1", "p2", "k3")
    lens = Lens.brown_conrady

    def project(self, points_c):
        """(..., 3) to (..., 2) px."""
        x, y = points_c[..., 0] / points_c[..., 2], points_c[..., 1] / points_c[..., 2]
        k1, k2, p1, p2, k3 = self.distortion
        r2 = x * x + y * y
        radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
        x_d = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        y_d = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        return np.stack([self.fx * x_d + self.cx, self.fy * y_d + self.cy], axis=-1)

    @property
    def model(self):
        """The same as the product describes it."""
        size = {"width": self.width, "height": self.height, "lens": self.lens}
        values = {name: getattr(self, name) for name in ("fx", "fy", "cx", "cy")}
        return CameraModel(**size, **values, **dict(zip(self.names, self.distortion, strict=True)))


@dataclass(frozen=True)
class TrueFisheye(TrueCamera):
    """Kannala and Brandt's: ``distortion`` is k1 to k4 of theta + k1 theta^3 + k2 theta^5 + ..."""

    fx: float = 250.0
    fy: float = 249.0
    distortion: tuple[float, ...] = (-0.02, 0.004, -0.001, 0.0)

    names = ("k1", "k2", "k3", "k4")
    lens = Lens.kannala_brandt

    def project(self, points_c):
        x, y, z = np.moveaxis(np.asarray(points_c, dtype=float), -1, 0)
        radius = np.hypot(x, y)
        theta = np.arctan2(radius, z)
        bent = theta * (1 + sum(k * theta ** (2 * (i + 1)) for i, k in enumerate(self.distortion)))
        scale = np.where(radius > 1e-12, bent / np.maximum(radius, 1e-12), 1.0)
        return np.stack([self.fx * x * scale + self.cx, self.fy * y * scale + self.cy], axis=-1)


def poses(board: Board, camera: TrueCamera, count: int, seed: int, **where):
    """As ``board_poses``."""
    return board_poses(board, camera.model, count, seed, **where)


def render(board, camera, pose, *, noise_sigma=2.0, blur_px=0.5, seed=1, motion_px=0.0):
    """(H, W) uint8."""
    return render_board(board, camera.model, pose, PictureFlaws(noise_sigma, blur_px, motion_px), seed=seed)


def corners_seen(board, camera, pose):
    """((columns - 1) (rows - 1), 2) px, without noise."""
    return camera.project(board.corners_m() @ pose.R.T + pose.t_m)

"""Calibration boards as a camera sees them: drawn by a homography and a lens, nothing of the code under test in it.

The lens is written out here once more, point by point, and inverted by fixed-point iteration; what it shows of the
board is sampled several times a pixel and averaged, which is what a sensor does.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import cv2
import numpy as np

from pilotfish.calibration.board import Board

SUPERSAMPLING = 3  # samples per pixel along each axis
TEXTURE_PX = 48  # per square: more than any view here shows of one


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

    def project(self, points_c):
        """(..., 3) to (..., 2) px."""
        x, y = points_c[..., 0] / points_c[..., 2], points_c[..., 1] / points_c[..., 2]
        x, y = _distorted(x, y, self.distortion)
        return np.stack([self.fx * x + self.cx, self.fy * y + self.cy], axis=-1)


@dataclass(frozen=True)
class TrueFisheye(TrueCamera):
    """Kannala and Brandt's: ``distortion`` is k1 to k4 of theta + k1 theta^3 + k2 theta^5 + ..."""

    fx: float = 250.0
    fy: float = 249.0
    distortion: tuple[float, ...] = (-0.02, 0.004, -0.001, 0.0)

    def project(self, points_c):
        x, y, z = np.moveaxis(np.asarray(points_c, dtype=float), -1, 0)
        radius = np.hypot(x, y)
        theta = np.arctan2(radius, z)
        bent = theta * (1 + sum(k * theta ** (2 * (i + 1)) for i, k in enumerate(self.distortion)))
        scale = np.where(radius > 1e-12, bent / np.maximum(radius, 1e-12), 1.0)
        return np.stack([self.fx * x * scale + self.cx, self.fy * y * scale + self.cy], axis=-1)


def _distorted(x, y, distortion):
    k1, k2, p1, p2, k3 = distortion
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    return x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y


def _undistorted(x_d, y_d, distortion):
    x, y = x_d.copy(), y_d.copy()
    for _ in range(25):
        x_e, y_e = _distorted(x, y, distortion)
        x, y, before = x + x_d - x_e, y + y_d - y_e, x
        if np.abs(x - before).max() < 1e-12:  # of a hundred-millionth of a pixel
            break
    return x, y


@functools.lru_cache(maxsize=4)
def _rays(camera):
    """x and y at z = 1 of what every sample of the sensor sees. In rows that stay in the processor's cache."""
    n = SUPERSAMPLING
    u = (np.arange(camera.width * n) + 0.5) / n - 0.5
    v = (np.arange(camera.height * n) + 0.5) / n - 0.5
    x, y = np.empty((2, len(v), len(u)), np.float32)
    for rows in _bands(len(v)):
        x_d, y_d = np.meshgrid((u - camera.cx) / camera.fx, (v[rows] - camera.cy) / camera.fy)
        x[rows], y[rows] = _undistorted(x_d, y_d, camera.distortion)
    return x, y


def _bands(height):
    """Some rows at a time, a multiple of SUPERSAMPLING."""
    step = 8 * SUPERSAMPLING
    return [slice(top, min(top + step, height)) for top in range(0, height, step)]


def rotation(axis_angle_rad):
    return cv2.Rodrigues(np.asarray(axis_angle_rad, dtype=float))[0]


def poses(board: Board, camera: TrueCamera, count: int, seed: int, *, tilt_deg=(10.0, 40.0), spread=0.9, share=0.6):
    """(R, t) of ``count`` views: the board's middle anywhere in the middle ``spread`` of the picture, tilted by
    ``tilt_deg`` about any axis across the line of sight, its width about ``share`` of the picture's.

    Views that put a corner of the outline outside of the picture are drawn again.
    """
    rng = np.random.default_rng(seed)
    width_m, height_m = board.size_m
    outline = np.array([[x, y, 0.0] for x in (0, width_m) for y in (0, height_m)])
    result = []
    while len(result) < count:
        about = rng.uniform(0, 2 * np.pi)
        tilt = np.radians(rng.uniform(*tilt_deg))
        R = rotation([0, 0, rng.uniform(-0.5, 0.5)]) @ rotation(tilt * np.array([np.cos(about), np.sin(about), 0.0]))
        depth = camera.fx * width_m / (share * rng.uniform(0.75, 1.25) * camera.width)
        middle_px = [
            camera.cx + spread * camera.width * rng.uniform(-0.5, 0.5),
            camera.cy + spread * camera.height * rng.uniform(-0.5, 0.5),
        ]
        middle = np.array(
            [(middle_px[0] - camera.cx) / camera.fx * depth, (middle_px[1] - camera.cy) / camera.fy * depth, depth]
        )
        t = middle - R @ np.array([width_m / 2, height_m / 2, 0.0])
        seen = outline @ R.T + t
        pixels = camera.project(seen)
        inside = (pixels > -0.05 * camera.width).all() and (pixels < [camera.width * 1.05, camera.height * 1.05]).all()
        if inside and (seen[:, 2] > 0.05).all():
            result.append((R, t))
    return result


@functools.lru_cache(maxsize=4)
def _page(board):
    return 30.0 + 190.0 / 255.0 * texture(board).astype(np.float32)


def texture(board: Board) -> np.ndarray:
    """The board on white paper with a margin of one square, ``TEXTURE_PX`` a square."""
    size = (board.columns * TEXTURE_PX, board.rows * TEXTURE_PX)
    if board.kind == "charuco":
        dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary))
        drawn = cv2.aruco.CharucoBoard((board.columns, board.rows), board.square_m, board.marker_m, dictionary)
        inner = drawn.generateImage(size, marginSize=0)
    else:
        black = (np.add.outer(np.arange(board.rows), np.arange(board.columns)) % 2) == 0
        inner = np.kron(np.where(black, 0, 255).astype(np.uint8), np.ones((TEXTURE_PX, TEXTURE_PX), np.uint8))
    page = np.full((inner.shape[0] + 2 * TEXTURE_PX, inner.shape[1] + 2 * TEXTURE_PX), 255, np.uint8)
    page[TEXTURE_PX:-TEXTURE_PX, TEXTURE_PX:-TEXTURE_PX] = inner
    return page


def render(board, camera, pose, *, noise_sigma=2.0, blur_px=0.5, seed=1, motion_px=0.0):
    """(H, W) uint8: black is 30, white 220, the wall behind 120."""
    R, t = pose
    n = SUPERSAMPLING
    x, y = _rays(camera)
    # A ray s (x, y, 1) meets the board where R q + t has no third coordinate in the board's frame.
    H = np.linalg.inv(np.column_stack([R[:, 0], R[:, 1], t])).astype(np.float32)
    page = _page(board)
    per_m = TEXTURE_PX / board.square_m
    picture = np.empty((camera.height, camera.width), np.float32)
    for rows in _bands(len(x)):
        at_x, at_y = x[rows], y[rows]
        w = H[2, 0] * at_x + H[2, 1] * at_y + H[2, 2]
        q_x, q_y = ((H[i, 0] * at_x + H[i, 1] * at_y + H[i, 2]) / w for i in (0, 1))
        map_x, map_y = (((q + board.square_m) * per_m - 0.5).astype(np.float32) for q in (q_x, q_y))
        fine = cv2.remap(page, map_x, map_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=120.0)
        fine[w <= 0] = 120.0
        picture[rows.start // n : rows.stop // n] = fine.reshape(-1, n, camera.width, n).mean(axis=(1, 3))
    if blur_px:
        picture = cv2.GaussianBlur(picture, (0, 0), blur_px)
    if motion_px:
        picture = cv2.blur(picture, (max(1, round(motion_px)), 1))
    noise = np.random.default_rng(seed).normal(0.0, noise_sigma, picture.shape)
    return np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)


def corners_seen(board, camera, pose):
    """((columns - 1) (rows - 1), 2) px, without noise."""
    R, t = pose
    return camera.project(board.corners_m() @ R.T + t)

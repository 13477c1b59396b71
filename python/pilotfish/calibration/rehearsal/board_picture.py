"""Calibration boards as a camera sees them: drawn by a homography and a lens.

What the lens shows of the board is sampled several times a pixel and averaged, which is what a sensor does.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.board import Board
from pilotfish.calibration.rehearsal.lens import directions
from pilotfish.core import CameraModel
from pilotfish.extras import require

SUPERSAMPLING = 3  # samples per pixel along each axis
BLACK, WHITE, WALL = 30.0, 220.0, 120.0  # gray levels of the print, and of what is behind the board
_TEXTURE_PX = 48  # a square has a multiple of it in the drawing, at least half of what the largest view shows of it
_FAR_PX = 3e4  # in the drawing: farther outside is outside


@dataclass(frozen=True)
class BoardPose:
    """Where a board is: ``R`` (3, 3) and ``t_m`` (3,) take its frame (origin in its top left corner, x right, y down)
    to the camera's."""

    R: np.ndarray
    t_m: np.ndarray


@dataclass(frozen=True)
class PictureFlaws:
    """What lies between a board and its picture: ``noise_sigma`` in gray levels, ``blur_px`` of the Gaussian blur,
    ``motion_px`` of a motion along the rows."""

    noise_sigma: float = 2.0
    blur_px: float = 0.5
    motion_px: float = 0.0


def board_texture(board: Board, square_px: int = _TEXTURE_PX) -> np.ndarray:
    """(H, W) uint8: the board, white 255, on paper with a margin of one square."""
    if board.kind == "charuco":
        from pilotfish.calibration.camera.detector import opencv_board

        inner = opencv_board(board).generateImage((board.columns * square_px, board.rows * square_px), marginSize=0)
    else:
        black = (np.add.outer(np.arange(board.rows), np.arange(board.columns)) % 2) == 0
        inner = np.kron(np.where(black, 0, 255).astype(np.uint8), np.ones((square_px, square_px), np.uint8))
    return np.pad(inner, square_px, constant_values=255)


def render_board(
    board: Board, camera: CameraModel, pose: BoardPose, flaws: PictureFlaws | None = None, *, seed: int = 1
) -> np.ndarray:
    """(H, W) uint8: what ``camera`` sees of the board at ``pose``; ``seed``: of the noise. ConfigError for a lens that
    cannot be inverted; MissingPackageError without OpenCV."""
    cv2 = require("cv2", "calibrate")
    flaws = flaws or PictureFlaws()
    n = SUPERSAMPLING
    x, y, z = _samples(camera)
    # A ray s (x, y, z) meets the board where R q + t has no third coordinate in the board's frame:
    # [R1 R2 t] (q_x, q_y, 1) = s (x, y, z), so the inverse of that matrix gives (q_x, q_y, 1) / s; in front: s > 0.
    H = np.linalg.inv(np.column_stack([pose.R[:, 0], pose.R[:, 1], pose.t_m])).astype(np.float32)
    w = H[2, 0] * x + H[2, 1] * y + H[2, 2] * z
    square_px = _square_px(board, camera)
    per_m = square_px / board.square_m
    maps = []
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for row in H[:2]:
            q = (row[0] * x + row[1] * y + row[2] * z) / w
            place = (q + np.float32(board.square_m)) * np.float32(per_m) - np.float32(0.5)
            maps.append(np.clip(np.nan_to_num(place, nan=_FAR_PX), -_FAR_PX, _FAR_PX).astype(np.float32))
    fine = cv2.remap(_page(board, square_px), *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=WALL)
    fine[w <= 0] = WALL
    picture = fine.reshape(camera.height, n, camera.width, n).mean(axis=(1, 3))
    if flaws.blur_px:
        picture = cv2.GaussianBlur(picture, (0, 0), flaws.blur_px)
    if flaws.motion_px:
        picture = cv2.blur(picture, (max(1, round(flaws.motion_px)), 1))
    noise = np.random.default_rng(seed).normal(0.0, flaws.noise_sigma, picture.shape)
    return np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)


@functools.lru_cache(maxsize=2)
def _samples(camera: CameraModel) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x, y and z (H n, W n) of the direction that lights each sample of the sensor."""
    n = SUPERSAMPLING
    u, v = np.meshgrid(
        (np.arange(camera.width * n) + 0.5) / n - 0.5,
        (np.arange(camera.height * n) + 0.5) / n - 0.5,
    )
    x, y, z = np.moveaxis(directions(camera, np.stack([u, v], axis=-1)), -1, 0)
    return tuple(np.ascontiguousarray(each, dtype=np.float32) for each in (x, y, z))


@functools.lru_cache(maxsize=4)
def _page(board: Board, square_px: int) -> np.ndarray:
    return (BLACK + (WHITE - BLACK) / 255.0 * board_texture(board, square_px)).astype(np.float32)


def _square_px(board: Board, camera: CameraModel) -> int:
    """Of a board that fills the picture's width a square has width / columns pixels."""
    return _TEXTURE_PX * max(1, int(np.ceil(camera.width / board.columns / (2 * _TEXTURE_PX))))

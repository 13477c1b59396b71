"""Poses of a board that cover a camera's picture: large, and tilted to all sides."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from pilotfish.calibration.board import Board
from pilotfish.calibration.camera.coverage import CELLS
from pilotfish.calibration.rehearsal.board_picture import BoardPose
from pilotfish.calibration.rehearsal.lens import directions, project
from pilotfish.core import CameraModel, Lens
from pilotfish.errors import ConfigError

_OUTSIDE = {"charuco": 0.05, "chessboard": -0.02}  # by which part of the picture's sides a corner of the board may be
_TRIES = 2000  # for one view
_NEAREST_M = 0.05


def board_poses(
    board: Board,
    camera: CameraModel,
    count: int,
    seed: int,
    *,
    tilt_deg: tuple[float, float] = (10.0, 40.0),
    spread: float = 0.9,
    share: float = 0.6,
    candidates: int = 1,
) -> list[BoardPose]:
    """``count`` views: the board's middle anywhere in the middle ``spread`` of the picture, tilted by ``tilt_deg``
    about any axis across the line of sight, its width about ``share`` of the picture's.

    Views that put a corner of the outline outside of the picture are drawn again: a chessboard has to be whole, of a
    ChArUco board a twentieth may be missing. Of several ``candidates`` the one is taken whose corners show most of what
    no view before has shown. ConfigError if no such view is found.
    """
    rng = np.random.default_rng(seed)
    corners = board.corners_m()
    seen_in = np.zeros(CELLS, dtype=int)
    result: list[BoardPose] = []
    while len(result) < count:
        drawn = [_pose(board, camera, rng, tilt_deg, spread, share) for _ in range(candidates)]
        cells = [_cells(camera, corners @ pose.R.T + pose.t_m) for pose in drawn]
        # A cell that k views have shown is worth 1 / (1 + k)^2.
        best = int(np.argmax([(1.0 / (1.0 + seen_in[cell]) ** 2).sum() for cell in cells]))
        seen_in[cells[best]] += 1
        result.append(drawn[best])
    return result


def _pose(
    board: Board,
    camera: CameraModel,
    rng: np.random.Generator,
    tilt_deg: tuple[float, float],
    spread: float,
    share: float,
) -> BoardPose:
    width_m, height_m = board.size_m
    outline = np.array([[x, y, 0.0] for x in (0, width_m / 2, width_m) for y in (0, height_m / 2, height_m)])
    size = np.array([camera.width, camera.height])
    margin = _OUTSIDE[board.kind] * size
    for _ in range(_TRIES):
        about = rng.uniform(0, 2 * np.pi)
        tilt = np.radians(rng.uniform(*tilt_deg))
        R = rotation([0, 0, rng.uniform(-0.5, 0.5)]) @ rotation(tilt * np.array([np.cos(about), np.sin(about), 0.0]))
        width_px = share * rng.uniform(0.75, 1.25) * camera.width
        middle_px = np.array(
            [
                camera.cx + spread * camera.width * rng.uniform(-0.5, 0.5),
                camera.cy + spread * camera.height * rng.uniform(-0.5, 0.5),
            ]
        )
        if camera.lens == Lens.kannala_brandt:
            # The board faces the camera from where it is, or it could not be seen at the edge of a wide view; its
            # width is seen under width_px / f, which holds for a radius f theta.
            ahead = directions(camera, middle_px)
            R = facing(ahead) @ R
            middle = ahead * width_m / 2 / np.tan(min(width_px / camera.fx, 0.9 * np.pi) / 2)
        else:
            depth = camera.fx * width_m / width_px
            middle = depth * np.array([*((middle_px - [camera.cx, camera.cy]) / [camera.fx, camera.fy]), 1.0])
        pose = BoardPose(R, middle - R @ np.array([width_m / 2, height_m / 2, 0.0]))
        seen = outline @ pose.R.T + pose.t_m
        pixels = project(camera, seen)
        in_front = camera.lens == Lens.kannala_brandt or (seen[:, 2] > _NEAREST_M).all()
        if in_front and (pixels > -margin).all() and (pixels < size + margin).all():
            return pose
    raise ConfigError(
        f"board: {board.columns} x {board.rows} squares cannot be placed in a picture of {camera.width}x"
        f"{camera.height} px with a share of {share:g} of its width: take a smaller --share"
    )


def _cells(camera: CameraModel, points_c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the picture's cells in which some of the points are."""
    pixels = project(camera, points_c)
    inside = ((pixels > 0) & (pixels < [camera.width - 1, camera.height - 1])).all(axis=1)
    places = (pixels[inside] * CELLS / [camera.width, camera.height]).astype(int)
    column, row = np.unique(places, axis=0).T
    return column, row


def rotation(vector_rad: np.ndarray | list[float]) -> np.ndarray:
    """(3, 3): the turn about this axis by its length."""
    return Rotation.from_rotvec(vector_rad).as_matrix()


def facing(ahead: np.ndarray) -> np.ndarray:
    """(3, 3): the shortest turn that takes the optical axis to the unit vector ``ahead``."""
    across = float(np.hypot(ahead[0], ahead[1]))
    angle = np.arctan2(across, ahead[2])
    return rotation([-ahead[1] / across * angle, ahead[0] / across * angle, 0.0]) if across else np.eye(3)

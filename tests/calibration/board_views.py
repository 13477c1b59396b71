"""Views of a board without pictures: its corners projected by the true camera, with white noise."""

from __future__ import annotations

import numpy as np
from rendered_boards import corners_seen, poses

from pilotfish.calibration.board import Board
from pilotfish.calibration.camera import BoardView

CHARUCO = Board("charuco", 8, 6, 0.03, 0.022, "DICT_4X4_100")
CHESSBOARD = Board("chessboard", 9, 7, 0.03)
SIZE = (640, 480)


def views_of(board, camera, count, seed, *, sigma_px=0.05, blur_px=0.5, **where):
    rng = np.random.default_rng(seed)
    result = []
    for number, pose in enumerate(poses(board, camera, count, seed, **where)):
        corners = corners_seen(board, camera, pose)
        ids = np.flatnonzero(((corners > 0) & (corners < [camera.width - 1, camera.height - 1])).all(axis=1))
        seen = corners[ids] + rng.normal(0.0, sigma_px, (len(ids), 2))
        result.append(BoardView(str(number), ids, board.corners_m()[ids], seen, blur_px))
    return result

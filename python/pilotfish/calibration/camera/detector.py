"""The corners of a board in a picture: found by OpenCV, located by ``corner_fit``."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pilotfish.calibration.board import Board
from pilotfish.calibration.camera import views
from pilotfish.calibration.camera.corner_fit import WINDOW_SHARE, fit_corners
from pilotfish.calibration.camera.diagnosis import why_no_charuco, why_no_chessboard
from pilotfish.calibration.camera.views import BoardView, Rejected
from pilotfish.extras import require

MIN_CORNERS = 6
MIN_SHARE = 0.2  # of the board's corners
MAX_OFF_SQUARES = 0.35  # median distance from the best homography; a fisheye bends a board by less


class BoardDetector:
    """Finds one kind of board. MissingPackageError without OpenCV."""

    def __init__(self, board: Board) -> None:
        self._cv2 = require("cv2", "calibrate")
        self.board = board
        self._corners_m = board.corners_m()
        self._needed = max(MIN_CORNERS, int(np.ceil(MIN_SHARE * len(self._corners_m))))
        self._find: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, float | None]] = self._find_chessboard
        if board.kind == "charuco":
            self._charuco = self._cv2.aruco.CharucoDetector(opencv_board(board))
            self._find = self._find_charuco

    def detect(self, image: np.ndarray, name: str = "", *, diagnose: bool = True) -> BoardView | Rejected:
        """The board in (H, W) uint8 ``image``. With ``diagnose`` a rejection says, where that can be found out, what
        was seen instead; that takes longer."""
        ids, starts_px, marker_share = self._find(image)
        return self._located(image, name, ids, starts_px, marker_share, diagnose)

    def rough(self, image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """OpenCV's corners alone, quickly: ids (P,) and pixels (P, 2), both empty if they are too few."""
        ids, corners_px, _ = self._find(image)
        if len(ids) < self._needed or not _spread(ids, self.board.inner_corners[0]):
            return np.zeros(0, dtype=int), np.zeros((0, 2))
        return ids, corners_px

    def _located(
        self,
        image: np.ndarray,
        name: str,
        ids: np.ndarray,
        starts_px: np.ndarray,
        marker_share: float | None,
        diagnose: bool,
    ) -> BoardView | Rejected:
        if len(ids) == 0:
            return self._refused(image, name, diagnose)
        if len(ids) < self._needed or not _spread(ids, self.board.inner_corners[0]):
            if diagnose and (other := self._other_board(image)):
                return Rejected(name, *other)
            return self._few(name, len(ids))
        if self._off_squares(ids, starts_px) > MAX_OFF_SQUARES:
            return Rejected(name, views.OTHER_BOARD, "the corners do not lie as on the board of the file")
        edges_px, known = _edges(ids, starts_px, self.board.inner_corners)
        ids, starts_px, edges_px = ids[known], starts_px[known], edges_px[known]
        clear = WINDOW_SHARE
        if self.board.marker_m is not None:
            clear = (1.0 - self.board.marker_m / self.board.square_m) / 2.0
        found = fit_corners(image, starts_px, edges_px, clear)
        ids, corners_px = ids[found.fitted], found.corners_px[found.fitted]
        if len(ids) < self._needed or not _spread(ids, self.board.inner_corners[0]):
            return self._few(name, len(ids))
        blur_px = float(np.median(found.sigma_px[found.fitted], axis=0).max())
        return BoardView(name, ids, self._corners_m[ids], corners_px, blur_px, marker_share)

    def _few(self, name: str, count: int) -> Rejected:
        wanted = f"{self._needed} of {len(self._corners_m)} are needed, in two rows and columns or more"
        return Rejected(name, views.FEW_CORNERS, f"{count} corners; {wanted}")

    def _refused(self, image: np.ndarray, name: str, diagnose: bool) -> Rejected:
        other = self._other_board(image) if diagnose else None
        return Rejected(name, *(other or (views.NO_BOARD, "no board was found")))

    def _other_board(self, image: np.ndarray) -> tuple[str, str] | None:
        if self.board.kind == "charuco":
            return why_no_charuco(self._cv2, self.board, opencv_board, image, self._needed)
        return why_no_chessboard(self._cv2, self.board, image)

    def _find_charuco(self, image: np.ndarray) -> tuple[np.ndarray, np.ndarray, float | None]:
        corners, ids, markers, _ = self._charuco.detectBoard(image)
        if ids is None or len(ids) < 4:
            count = 0 if ids is None else len(ids)
            return np.arange(count), np.zeros((count, 2)), None
        ids, corners = np.asarray(ids).ravel(), np.asarray(corners, dtype=float).reshape(-1, 2)
        order = np.argsort(ids)
        ids, corners = ids[order], corners[order]
        return ids, corners, self._marker_share(ids, corners, markers)

    def _marker_share(self, ids: np.ndarray, corners_px: np.ndarray, markers: object) -> float | None:
        """The markers' sides as a part of the squares', both on the board: a homography takes the pixels there."""
        if not markers or not _spread(ids, self.board.inner_corners[0]):
            return None
        to_board, _ = self._cv2.findHomography(corners_px, self._corners_m[ids, :2])
        if to_board is None:
            return None
        quads = np.asarray([np.asarray(m, dtype=float).reshape(4, 2) for m in markers])
        on_board = self._cv2.perspectiveTransform(quads.reshape(-1, 1, 2), to_board).reshape(-1, 4, 2)
        sides = np.linalg.norm(on_board - np.roll(on_board, 1, axis=1), axis=2)
        return float(np.median(sides) / self.board.square_m)

    def _find_chessboard(self, image: np.ndarray) -> tuple[np.ndarray, np.ndarray, float | None]:
        along, down = self.board.inner_corners
        found, corners = self._cv2.findChessboardCornersSB(image, (along, down))
        if not found or corners is None or len(corners) != along * down:
            return np.zeros(0, dtype=int), np.zeros((0, 2)), None
        grid = np.asarray(corners, dtype=float).reshape(down, along, 2)
        right, below = (np.nanmean(np.diff(grid, axis=axis), axis=(0, 1)) for axis in (1, 0))
        if right[0] * below[1] - right[1] * below[0] < 0:  # numbered as if seen from behind
            grid = grid[:, ::-1]
        return np.arange(along * down), grid.reshape(-1, 2), None

    def _off_squares(self, ids: np.ndarray, corners_px: np.ndarray) -> float:
        to_board, _ = self._cv2.findHomography(corners_px, self._corners_m[ids, :2])
        if to_board is None:
            return np.inf
        on_board = self._cv2.perspectiveTransform(corners_px.reshape(-1, 1, 2), to_board).reshape(-1, 2)
        return float(np.median(np.linalg.norm(on_board - self._corners_m[ids, :2], axis=1)) / self.board.square_m)


def opencv_board(board: Board, *, legacy: bool = False) -> object:
    """The cv2.aruco.CharucoBoard that a ChArUco ``board`` is."""
    aruco = require("cv2", "calibrate").aruco
    dictionary = aruco.getPredefinedDictionary(getattr(aruco, board.dictionary))
    drawn = aruco.CharucoBoard((board.columns, board.rows), board.square_m, board.marker_m, dictionary)
    drawn.setLegacyPattern(legacy)
    return drawn


def _spread(ids: np.ndarray, along: int) -> bool:
    """Whether the corners lie in two rows and two columns or more: on one line they say nothing of a plane."""
    return len(np.unique(ids // along)) > 1 and len(np.unique(ids % along)) > 1


def _edges(ids: np.ndarray, corners_px: np.ndarray, inner: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """The board's x and y there, one square long [px] (N, 2, 2), from the neighbours; (N,) whether there are any.

    From neighbours, not from a homography of the whole board: a fisheye bends it too much.
    """
    along, down = inner
    grid = np.full((down + 2, along + 2, 2), np.nan)
    row, column = ids // along + 1, ids % along + 1
    grid[row, column] = corners_px
    edges = np.empty((len(ids), 2, 2))
    for k, (dr, dc) in enumerate(((0, 1), (1, 0))):
        after, before = grid[row + dr, column + dc], grid[row - dr, column - dc]
        central, forward, backward = (after - before) / 2.0, after - corners_px, corners_px - before
        edges[:, k] = np.where(np.isfinite(central), central, np.where(np.isfinite(forward), forward, backward))
    known = np.isfinite(edges).all(axis=(1, 2))
    cross = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    lengths = np.linalg.norm(edges, axis=2)
    return edges, known & (np.abs(cross) > 0.1 * lengths.prod(axis=1)) & (lengths.min(axis=1) > 4.0)

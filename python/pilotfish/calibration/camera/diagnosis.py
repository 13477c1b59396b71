"""What a picture shows instead of the board that it should: another size, a mirror image, an older layout."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np

from pilotfish.calibration.board import SQUARES, Board
from pilotfish.calibration.camera import views

MIN_MARKERS = 4


def why_no_charuco(
    cv2: ModuleType, board: Board, opencv_board: Callable[..., object], image: np.ndarray, needed: int
) -> tuple[str, str] | None:
    """(why, detail) of a picture in which ``board`` was not found; None if there is nothing like it there."""
    if _charuco_corners(cv2, opencv_board(board), image[:, ::-1].copy()) >= needed:
        detail = (
            "the picture is mirrored: switch the camera's mirroring off (or hold the board itself, not its reflection)"
        )
        return views.MIRRORED, detail
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary))
    _, ids, _ = cv2.aruco.ArucoDetector(dictionary).detectMarkers(image)
    if ids is None or len(ids) < MIN_MARKERS:
        return None
    if _charuco_corners(cv2, opencv_board(board, legacy=True), image) >= needed:
        detail = "the board has the layout of OpenCV before 4.6 (a white square at the top left): print it anew"
        return views.OTHER_BOARD, detail
    told = f"the board of the file has {board.columns} x {board.rows} squares and markers 0 to {board.marker_count - 1}"
    highest = int(np.max(ids))
    if highest >= board.marker_count:
        return views.OTHER_BOARD, f"marker {highest} was seen; {told}"
    return views.OTHER_BOARD, f"{len(ids)} markers were seen, but not where they should be; {told}: count its squares"


def why_no_chessboard(cv2: ModuleType, board: Board, image: np.ndarray) -> tuple[str, str] | None:
    """The same for a chessboard, whose squares OpenCV can count."""
    flags = cv2.CALIB_CB_LARGER | cv2.CALIB_CB_EXHAUSTIVE
    smallest = SQUARES[0] - 1
    found, _, meta = cv2.findChessboardCornersSBWithMeta(image, (smallest, smallest), flags)
    if not found or meta is None:
        return None
    # OpenCV counts from any side; said as the file counts: the longer one first, or last.
    along, down = sorted(meta.shape[:2], reverse=board.columns >= board.rows)
    if {along, down} == set(board.inner_corners):
        return None
    seen, told = f"{along + 1} x {down + 1}", f"{board.columns} x {board.rows}"
    if max(along, down) > max(board.inner_corners) or min(along, down) > min(board.inner_corners):
        return (
            views.OTHER_BOARD,
            f"a chessboard of {seen} squares was seen; the board of the file has {told}: count them",
        )
    detail = (
        f"only {seen} of {told} squares were found: all of it must be in the picture, if the file counts them right"
    )
    return views.FEW_CORNERS, detail


def _charuco_corners(cv2: ModuleType, drawn: object, image: np.ndarray) -> int:
    _, ids, _, _ = cv2.aruco.CharucoDetector(drawn).detectBoard(image)
    return 0 if ids is None else len(ids)

"""A calibration board on one page, its parameters below it."""

from __future__ import annotations

import math

import numpy as np

from pilotfish.calibration.board import DICTIONARIES, Board
from pilotfish.errors import UsageError
from pilotfish.extras import require
from pilotfish.printing.outline import outline
from pilotfish.printing.page import FOOTER_M, Page, Shape, furniture, printable_m
from pilotfish.printing.paper import Paper
from pilotfish.printing.quantities import millimetres

_WHITE_M = 0.0025  # around the board, besides the margin of the paper
_TITLE_M = 0.0045  # above the ruler


def board_pages(board: Board, paper: Paper) -> list[Page]:
    """One page, the paper turned if the board fits better so. UsageError if it does not fit, with the largest squares
    that do; MissingPackageError if a ChArUco board's markers cannot be had because OpenCV is missing."""
    rooms = {turned: _room_m(turned) for turned in (paper, paper.turned)}
    fits = {turned: min(room[0] / board.columns, room[1] / board.rows) for turned, room in rooms.items()}
    best = max(fits, key=lambda turned: fits[turned])
    if fits[best] < board.square_m - 1e-9:
        raise UsageError(
            f"--square: {board.columns} x {board.rows} squares of {millimetres(board.square_m)} need"
            f" {millimetres(board.size_m[0])} x {millimetres(board.size_m[1])} and do not fit on {paper.name};"
            f" the largest squares that do are {millimetres(math.floor(fits[best] * 1e4) / 1e4)}"
        )
    left, top, _, _ = printable_m(best)
    room = rooms[best]
    corner = np.array([left + _WHITE_M, top + _WHITE_M]) + (np.array(room) - board.size_m) / 2
    pattern = Shape(tuple(corner + loop for loop in _loops_m(board)))
    return [Page(best, [*furniture(best, subtitle=board_title(board)), pattern])]


def board_title(board: Board) -> str:
    """Its parameters in one line, as they stand below it."""
    name = {"charuco": "ChArUco board", "chessboard": "Chessboard"}[board.kind]
    text = f"{name}: {board.columns} x {board.rows} squares of {millimetres(board.square_m)}"
    if board.marker_m is not None:
        text += f", markers of {millimetres(board.marker_m)}, {board.dictionary}"
    return text


def marker_cells(dictionary: str, marker_id: int) -> np.ndarray:
    """(N, N) bool, True where a marker is black, its black border of one cell included."""
    aruco = require("cv2", "calibrate").aruco
    side = DICTIONARIES[dictionary][0] + 2
    markers = aruco.getPredefinedDictionary(getattr(aruco, dictionary))
    return aruco.generateImageMarker(markers, marker_id, side, borderBits=1) == 0


def _loops_m(board: Board) -> list[np.ndarray]:
    """All that is black, from the board's top left corner: the squares, and the markers in the middle of the white
    ones."""
    row, column = np.mgrid[: board.rows, : board.columns]
    is_black = (row + column) % 2 == 0
    loops = [loop * board.square_m for loop in outline(is_black)]
    if board.kind == "charuco":
        for marker_id, (y, x) in enumerate(np.argwhere(~is_black)):
            cells = marker_cells(board.dictionary, marker_id)
            first = (np.array([x, y]) + 0.5) * board.square_m - board.marker_m / 2
            loops += [first + loop * board.marker_m / len(cells) for loop in outline(cells)]
    return loops


def _room_m(paper: Paper) -> tuple[float, float]:
    left, top, right, bottom = printable_m(paper)
    return right - left - 2 * _WHITE_M, bottom - top - 2 * _WHITE_M - FOOTER_M - _TITLE_M

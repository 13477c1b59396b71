"""A board in a few words on the command line: ``charuco:8x6:30mm:22mm``, ``chessboard:9x7:25mm``, or its file."""

from __future__ import annotations

import re

from pilotfish.calibration.board import Board, read_board
from pilotfish.errors import ConfigError, UsageError

DEFAULT_DICTIONARY = "DICT_4X4_100"
_UNITS_M = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
_LENGTH = re.compile(r"(\d+(?:\.\d*)?|\.\d+)(mm|cm|m)")
HOW = "charuco:COLUMNSxROWS:SQUARE:MARKER[:DICTIONARY] or chessboard:COLUMNSxROWS:SQUARE, as charuco:8x6:30mm:22mm"


def board_of(text: str) -> Board:
    """The board that ``text`` spells, or that the file of this name holds. PilotfishError."""
    kind, *words = text.split(":")
    if kind not in ("charuco", "chessboard") or not words:
        return read_board(text)
    size = re.fullmatch(r"(\d+)x(\d+)", words[0])
    lengths = [_LENGTH.fullmatch(word) for word in words[1 : 3 if kind == "charuco" else 2]]
    wanted = (3, 4) if kind == "charuco" else (2,)
    if size is None or len(words) not in wanted or not all(lengths):
        raise UsageError(f"--board: '{text}' is not {HOW}; lengths end in mm, cm or m")
    metres = [round(float(m[1]) * _UNITS_M[m[2]], 9) for m in lengths]
    dictionary = None
    if kind == "charuco":
        dictionary = words[3] if len(words) == 4 else DEFAULT_DICTIONARY
    try:
        return Board(kind, int(size[1]), int(size[2]), metres[0], metres[1] if kind == "charuco" else None, dictionary)
    except ConfigError as error:
        raise UsageError(f"--board: {error}") from error


def spelled(board: Board) -> str:
    """The words for ``board`` that ``board_of`` understands: charuco:8x6:30mm:22mm."""
    lengths = [board.square_m] + ([board.marker_m] if board.marker_m is not None else [])
    words = [board.kind, f"{board.columns}x{board.rows}", *(f"{round(length * 1e3, 6):.9g}mm" for length in lengths)]
    if board.dictionary not in (None, DEFAULT_DICTIONARY):
        words.append(board.dictionary)
    return ":".join(words)

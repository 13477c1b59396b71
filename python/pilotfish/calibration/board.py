"""A printed calibration board: what `pilotfish tags --board` prints, and what `pilotfish calibrate` is told of it.

The file has one section::

    board: {kind: charuco, columns: 8, rows: 6, square_m: 0.03, marker_m: 0.022, dictionary: DICT_4X4_100}

Columns and rows count squares, not inner corners. A ChArUco board is the one that OpenCV's
``cv2.aruco.CharucoBoard((columns, rows), square_m, marker_m, dictionary)`` describes in its present layout (not the
legacy one): the top left square is black, and the markers 0, 1, 2, ... stand in the white squares, row by row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pilotfish.errors import ConfigError
from pilotfish.files import read_text
from pilotfish.whole_files import write_whole

KINDS = ("charuco", "chessboard")
DICTIONARIES = {f"DICT_{n}X{n}_{size}": (n, size) for n in (4, 5, 6, 7) for size in (50, 100, 250, 1000)}
"""OpenCV's dictionaries of markers: bits along a side, number of markers."""
SQUARES = (4, 40)  # along either side: OpenCV's chessboard detector needs three inner corners
SQUARE_M = (0.002, 0.5)
# Of the square's side: below, the markers are needlessly hard to read; above, their white ring is too thin.
MARKER_SHARE = (0.4, 0.9)
_KEYS = {
    "charuco": ("kind", "columns", "rows", "square_m", "marker_m", "dictionary"),
    "chessboard": ("kind", "columns", "rows", "square_m"),
}


@dataclass(frozen=True)
class Board:
    """A chessboard, or one with markers in its white squares (ChArUco). ConfigError names key, value and allowed range.

    columns, rows: number of squares; square_m: side of a square; marker_m, dictionary: side of a marker's black square
    and its dictionary's name in OpenCV, of a ChArUco board only, else None.
    """

    kind: str
    columns: int
    rows: int
    square_m: float
    marker_m: float | None = None
    dictionary: str | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise _wrong("kind", self.kind, f"one of {', '.join(KINDS)}")
        _check_count("columns", self.columns)
        _check_count("rows", self.rows)
        _check_length("square_m", self.square_m, SQUARE_M)
        if self.kind == "charuco":
            self._check_markers()
            return
        for key in ("marker_m", "dictionary"):
            if getattr(self, key) is not None:
                raise _wrong(key, getattr(self, key), "nothing: a chessboard has no markers")

    def _check_markers(self) -> None:
        low, high = (share * self.square_m for share in MARKER_SHARE)
        note = f", {MARKER_SHARE[0]:g} to {MARKER_SHARE[1]:g} of square_m"
        _check_length("marker_m", self.marker_m, (low, high), note)
        if self.dictionary not in DICTIONARIES:
            raise _wrong("dictionary", self.dictionary, f"one of {', '.join(DICTIONARIES)}")
        size = DICTIONARIES[self.dictionary][1]
        if self.marker_count > size:
            wanted = f"one with {self.marker_count} markers or more, for {self.columns} x {self.rows} squares"
            raise _wrong("dictionary", self.dictionary, wanted)

    @property
    def marker_count(self) -> int:
        """Of a ChArUco board: one marker in every white square. 0 for a chessboard."""
        return self.columns * self.rows // 2 if self.kind == "charuco" else 0

    @property
    def inner_corners(self) -> tuple[int, int]:
        """Corners at which four squares meet: along a row, along a column. OpenCV's pattern size."""
        return self.columns - 1, self.rows - 1

    @property
    def size_m(self) -> tuple[float, float]:
        """Width and height of all squares together."""
        return self.columns * self.square_m, self.rows * self.square_m

    def corners_m(self) -> np.ndarray:
        """((columns - 1) * (rows - 1), 3): the inner corners row by row from the top left, in the board's frame: origin
        in the board's top left corner, x right, y down, z = 0. OpenCV numbers ChArUco corners in this order."""
        along, down = self.inner_corners
        x, y = np.meshgrid(np.arange(1, along + 1), np.arange(1, down + 1))
        return np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3) * self.square_m


def read_board(path: str | Path) -> Board:
    """The board of a YAML file. MissingFileError if there is none, ConfigError with file, key, value and what is
    allowed."""
    try:
        return _board_of(yaml.safe_load(read_text(path)))
    except yaml.YAMLError as error:
        raise ConfigError(f"{path}: no YAML: {' '.join(str(error).split())}") from error
    except RecursionError as error:
        raise ConfigError(f"{path}: nested too deeply") from error
    except ConfigError as error:
        raise _named(error.key, f"{path}: {error}") from error


def write_board(board: Board, path: str | Path) -> None:
    """Writes what read_board reads. OSError if it cannot be written."""
    write_whole(path, board_text(board))


def board_text(board: Board) -> str:
    """The YAML, in one line, with every digit."""
    values = {key: getattr(board, key) for key in _KEYS[board.kind]}
    return f"board: {yaml.safe_dump(values, default_flow_style=True, sort_keys=False, width=math.inf).strip()}\n"


def _board_of(document: Any) -> Board:
    if not isinstance(document, dict) or set(document) != {"board"}:
        raise _named("board", "board: one section of this name is needed, and nothing else")
    section = document["board"]
    if not isinstance(section, dict):
        raise _wrong("", section, "a section with kind, columns, rows, square_m")
    kind = section.get("kind")
    if kind not in KINDS:
        raise _wrong("kind", kind, f"one of {', '.join(KINDS)}")
    known = _KEYS[kind]
    for key in section:
        if key not in known:
            raise _named(f"board.{key}", f"board.{key}: unknown key of a {kind}; known are {', '.join(known)}")
    for key in known:
        if key not in section:
            raise _named(f"board.{key}", f"board.{key}: is missing")
    return Board(**section)


def _check_count(key: str, value: object) -> None:
    low, high = SQUARES
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise _wrong(key, value, f"a whole number of squares, {low} to {high}")


def _check_length(key: str, value: object, allowed: tuple[float, float], note: str = "") -> None:
    low, high = allowed
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    # 1e-9 m: a share of 0.9 of 0.03 is not exactly 0.027.
    if not is_number or not low - 1e-9 <= value <= high + 1e-9:
        raise _wrong(key, value, f"a length of {low:.6g} to {high:.6g} m{note}")


def _wrong(key: str, value: object, allowed: str) -> ConfigError:
    path = f"board.{key}" if key else "board"
    shown = "missing" if value is None else f"{value!r}"
    return _named(path, f"{path}: {shown}; allowed: {allowed}")


def _named(key: str | None, message: str) -> ConfigError:
    error = ConfigError(message)
    error.key = key
    return error

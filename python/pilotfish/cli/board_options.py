"""A calibration board on the command line, by its numbers: as it is printed, and as it is rendered."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

import typer

if TYPE_CHECKING:
    from pilotfish.calibration.board import Board

_Read = TypeVar("_Read")
COLUMNS, ROWS, SQUARE = 8, 6, "30mm"  # of a board of which nothing else is said
DICTIONARY = "DICT_4X4_100"


def read_option(option: str, parse: Callable[..., _Read], *arguments: object) -> _Read:
    """What ``parse`` makes of the arguments; its ValueError names the option."""
    try:
        return parse(*arguments)
    except ValueError as error:
        raise typer.BadParameter(f"{option}: {error}") from None


def board_from_options(
    kind: str, columns: int, rows: int, square: str, marker: str | None, dictionary: str | None
) -> Board:
    """The board of --board, --columns, --rows, --square, --marker, --dictionary."""
    from pilotfish.calibration.board import SQUARE_M, Board
    from pilotfish.printing import parse_length_m

    square_m = read_option("--square", parse_length_m, square, *SQUARE_M)
    if kind == "chessboard":
        if marker or dictionary:
            raise typer.BadParameter("--marker and --dictionary are for --board charuco: a chessboard has no markers")
        return read_option("--board", Board, kind, columns, rows, square_m)
    # 30 mm squares have markers of 22 mm: their bits are as large as the white ring around them is wide.
    marker_m = read_option("--marker", parse_length_m, marker, *SQUARE_M) if marker else round(square_m * 11 / 15, 6)
    return read_option("--board", Board, kind, columns, rows, square_m, marker_m, dictionary or DICTIONARY)

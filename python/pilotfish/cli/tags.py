"""``pilotfish tags``: sheets to print, at true scale."""

from __future__ import annotations

import math
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.board_options import COLUMNS, ROWS, SQUARE, board_from_options, read_option
from pilotfish.cli.console import friendly_errors, progress, tell_next
from pilotfish.cli.options import between, check_family
from pilotfish.cli.outputs import Output, output_file
from pilotfish.whole_files import check_same

if TYPE_CHECKING:
    from pilotfish.calibration.board import Board
    from pilotfish.core import LeaderBody
    from pilotfish.printing import Page, Paper

SIZE_M = (0.005, 5.0)  # as in core.BodyTag
_ANGLE = between(-360.0, 360.0, "degrees")
_PLACE = (-10.0, 10.0)  # as in core.BodyTag
LOOSE, BODY, SCREEN, BOARD = "Tags", "Sheets for a leader's file", "A leader for a folded sheet", "Calibration boards"


class BoardKind(str, Enum):
    """The calibration boards that can be printed."""

    charuco = "charuco"
    chessboard = "chessboard"


def tags(
    context: typer.Context,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", dir_okay=False, help="The PDF to write.", show_default="tags.pdf, NAME.pdf or board.pdf"
        ),
    ] = None,
    paper: Annotated[
        str, typer.Option(help="A4, Letter, A5, A3, Tabloid, A2, A1, A0, or width x height as 600x300mm.")
    ] = "A4",
    border_cells: Annotated[
        float,
        typer.Option(callback=between(1.0, 8.0, "cells"), help="White border around each tag, in cells; 1 at least."),
    ] = 1.0,
    ids: Annotated[str | None, typer.Option(help="Ids, as 0-2,5.", rich_help_panel=LOOSE)] = None,
    size: Annotated[
        str | None,
        typer.Option(
            help="Side of the black square: 0.16 (metres), 160mm, 16cm.", show_default="0.16", rich_help_panel=LOOSE
        ),
    ] = None,
    family: Annotated[
        str | None,
        typer.Option(help="Of the tags: any of libapriltag's.", show_default="tag36h11", rich_help_panel=LOOSE),
    ] = None,
    body: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Print the tags of this leader YAML.", rich_help_panel=BODY),
    ] = None,
    fold: Annotated[
        bool,
        typer.Option(
            "--fold/--cut",
            help="Keep faces that adjoin on one sheet, to be folded, if it fits; or one sheet a face.",
            rich_help_panel=BODY,
        ),
    ] = True,
    faces: Annotated[
        int | None,
        typer.Option(
            callback=between(1, 12, "faces"),
            help="Tags side by side on one sheet, folded between them.",
            rich_help_panel=SCREEN,
        ),
    ] = None,
    angle_deg: Annotated[
        float,
        typer.Option(
            callback=between(0.0, 180.0, "degrees"),
            help="By which each face turns back from its neighbour.",
            rich_help_panel=SCREEN,
        ),
    ] = 45.0,
    leader: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False,
            help="Write the leader YAML of the folded sheet, or of a single tag.",
            rich_help_panel=SCREEN,
        ),
    ] = None,
    position: Annotated[
        tuple[float, float, float],
        typer.Option(
            help="Middle of the sheet (centre of the middle tag, or middle fold) on the leader: forward, left, up from"
            " the ground between its wheels, in metres.",
            metavar="X Y Z",
            rich_help_panel=SCREEN,
        ),
    ] = (-0.20, 0.0, 0.25),
    facing_deg: Annotated[
        float,
        typer.Option(callback=_ANGLE, help="Where it looks: 0 forward, 90 left, 180 rear.", rich_help_panel=SCREEN),
    ] = 180.0,
    tilt_deg: Annotated[
        float,
        typer.Option(callback=between(-90.0, 90.0, "degrees"), help="Positive: it looks up.", rich_help_panel=SCREEN),
    ] = 0.0,
    board: Annotated[
        BoardKind | None,
        typer.Option(help="Print a calibration board, and its YAML beside it.", rich_help_panel=BOARD),
    ] = None,
    columns: Annotated[int, typer.Option(help="Squares along a row, 4 to 40.", rich_help_panel=BOARD)] = COLUMNS,
    rows: Annotated[int, typer.Option(help="Rows of squares, 4 to 40.", rich_help_panel=BOARD)] = ROWS,
    square: Annotated[str, typer.Option(help="Side of a square.", rich_help_panel=BOARD)] = SQUARE,
    marker: Annotated[
        str | None,
        typer.Option(help="Side of a ChArUco marker.", show_default="11/15 of a square", rich_help_panel=BOARD),
    ] = None,
    dictionary: Annotated[
        str | None,
        typer.Option(help="OpenCV's, of the markers.", show_default="DICT_4X4_100", rich_help_panel=BOARD),
    ] = None,
    replace: Annotated[
        bool, typer.Option("--replace", help="Also a YAML file that is there already and says something else.")
    ] = False,
) -> None:
    """Print tags, the folding sheet of a leader, or a calibration board: a PDF at true scale.

    \b
    Print it at 100 % ("actual size", not "fit to page") and measure the bar of
    100.0 mm at the bottom. Then measure a black square in both directions: what
    you measure is the size that belongs into the leader's file.

    \b
    Tags
      pilotfish tags --ids 0-2,5 --size 0.16
      pilotfish tags --ids 0-29 --size 30mm --paper Letter --out small.pdf
      pilotfish tags --ids 0 --size 0.4 --paper 600x600mm   # for a print shop

    \b
    A leader whose file you have: one sheet that is folded if it fits on the
    paper, else one a face, with letters where edges meet
      pilotfish tags --body data/leaders/three_faces.yaml
      pilotfish tags --body data/leaders/three_faces.yaml --paper 640x260mm

    \b
    A new leader: three tags on a folded sheet, and the file that describes it.
    Say where its middle sits on the robot; look at the result
      pilotfish tags --faces 3 --angle-deg 45 --size 60mm \\
          --position -0.20 0 0.25 --leader my_robot.yaml --out my_robot.pdf
      pilotfish leader show my_robot.yaml --out my_robot.png
      pilotfish tags --ids 7 --size 0.16 --leader my_robot.yaml

    \b
    A calibration board, and its YAML for `pilotfish calibrate`
      pilotfish tags --board charuco --out board.pdf     # and board.yaml
      pilotfish tags --board chessboard --columns 10 --rows 7 --square 25mm
    """
    from pilotfish.calibration.body.leader_file import leader_text
    from pilotfish.extras import require
    from pilotfish.printing import parse_paper

    _refuse_mixed(context, ids is not None, body is not None, faces is not None, board is not None)
    sheet = read_option("--paper", parse_paper, paper)
    _check_suffixes(out, leader)
    if family is not None:
        check_family(family)
    with friendly_errors():
        require("reportlab", "tags")  # said at once
        if board is not None:
            wanted = board_from_options(board.value, columns, rows, square, marker, dictionary)
            _print_board(wanted, sheet, out or Path("board.pdf"), replace)
        elif body is not None:
            _print_body(_load_body(body), sheet, border_cells, fold, out or Path(f"{body.stem}.pdf"))
        elif faces is not None or leader is not None:
            numbers = _ids(ids if ids is not None else f"0-{(faces or 1) - 1}")
            if faces is not None and len(numbers) != faces:
                raise typer.BadParameter(f"--faces {faces} needs {faces} ids, --ids {ids} has {len(numbers)}")
            if faces is None and len(numbers) > 1:
                raise typer.BadParameter(
                    f"--leader: where do {len(numbers)} tags sit? --faces {len(numbers)} puts them on one folded sheet"
                )
            designed = _design(
                numbers, _size(size), family, border_cells, angle_deg, position, facing_deg, tilt_deg, leader
            )
            pdf = out or Path(f"{leader.stem}.pdf" if leader else "tags.pdf")
            target = output_file(leader) if leader else None
            if leader and not replace:
                check_same(leader, leader_text(designed, _leader_remarks(pdf)), "--replace")
            _print_body(designed, sheet, border_cells, fold, pdf)
            if target:
                _write_leader(target, designed, pdf)
        else:
            _print_tags(
                _ids(ids or ""), _size(size), family or "tag36h11", sheet, border_cells, out or Path("tags.pdf")
            )


_OF_BOARDS = ("columns", "rows", "square", "marker", "dictionary")
_OF_SCREENS = ("angle_deg", "position", "facing_deg", "tilt_deg")


def _refuse_mixed(context: typer.Context, ids: bool, body: bool, faces: bool, board: bool) -> None:
    """Options that would be ignored are refused."""
    given = {
        name
        for name in context.params
        if (source := context.get_parameter_source(name)) is not None and source.name == "COMMANDLINE"
    }
    modes = [name for name, chosen in (("--body", body), ("--faces", faces), ("--board", board)) if chosen]
    if len(modes) > 1:
        raise typer.BadParameter(f"{' and '.join(modes)} exclude each other")
    if not modes and not ids:
        raise typer.BadParameter("what is to be printed? --ids, --body, --faces or --board; see --help for examples")
    foreign: tuple[str, ...] = ()
    if board:
        foreign = ("ids", "size", "family", "border_cells", "fold", "leader", *_OF_SCREENS)
    elif body:
        foreign = ("ids", "size", "family", "leader", *_OF_SCREENS, *_OF_BOARDS)
    else:
        foreign = _OF_BOARDS
        if not faces:
            foreign += ("fold", "angle_deg")
            if "leader" not in given:
                foreign += _OF_SCREENS
    if wrong := [f"--{name.replace('_', '-')}" for name in foreign if name in given]:
        what = modes[0] if modes else "--ids without --leader" if "leader" not in given else "--ids without --faces"
        raise typer.BadParameter(f"{', '.join(wrong)} cannot be used with {what}")


def _check_suffixes(out: Path | None, leader: Path | None) -> None:
    """Two files of one name, or a PDF that no viewer opens, are noticed before anything is written."""
    if out is not None and out.suffix.lower() != ".pdf":
        raise typer.BadParameter(f"--out: '{out.name}' does not end in .pdf, which is what is written")
    if leader is not None and leader.suffix.lower() not in {".yaml", ".yml"}:
        raise typer.BadParameter(f"--leader: '{leader.name}' ends neither in .yaml nor in .yml")


def _ids(text: str) -> list[int]:
    from pilotfish.printing import parse_ids

    return read_option("--ids", parse_ids, text)


def _size(text: str | None) -> float:
    from pilotfish.printing import parse_length_m

    return read_option("--size", parse_length_m, "0.16" if text is None else text, *SIZE_M)


def _load_body(file: Path) -> LeaderBody:
    from pilotfish.leader import load_leader

    return load_leader(file)


def _design(
    ids: list[int],
    size_m: float,
    family: str | None,
    border_cells: float,
    angle_deg: float,
    position: tuple[float, float, float],
    facing_deg: float,
    tilt_deg: float,
    leader: Path | None,
) -> LeaderBody:
    from pilotfish.printing import folded_screen

    if not all(_PLACE[0] <= value <= _PLACE[1] for value in position):
        raise typer.BadParameter(f"--position: {position} is not three lengths of {_PLACE[0]:g} to {_PLACE[1]:g} m")
    return folded_screen(
        ids,
        size_m,
        math.radians(angle_deg),
        position_m=position,
        facing_rad=math.radians(facing_deg),
        tilt_rad=math.radians(tilt_deg),
        family=family or "tag36h11",
        border_cells=border_cells,
        name=leader.stem if leader else "leader",
    )


def _print_tags(ids: list[int], size_m: float, family: str, paper: Paper, border_cells: float, out: Path) -> None:
    from pilotfish.printing import loose_tag_pages
    from pilotfish.printing.quantities import millimetres

    pages = loose_tag_pages(ids, size_m, paper, family=family, border_cells=border_cells)
    what = f"{len(ids)} tag{'s' if len(ids) > 1 else ''} of {millimetres(size_m)}"
    _write(pages, out, what)


def _print_body(body: LeaderBody, paper: Paper, border_cells: float, fold: bool, out: Path) -> None:
    from pilotfish.printing import body_pages

    pages = body_pages(body, paper, border_cells=border_cells, fold=fold)
    _write(pages, out, f"{body.name}: {len(body.tags)} tag{'s' if len(body.tags) > 1 else ''}")


def _print_board(board: Board, paper: Paper, out: Path, replace: bool) -> None:
    from pilotfish.calibration.board import board_text, write_board
    from pilotfish.printing import board_pages
    from pilotfish.printing.board_sheet import board_title

    description = out.with_suffix(".yaml")
    pages = board_pages(board, paper)
    target = output_file(description)
    if not replace:
        check_same(description, board_text(board), "--replace")
    _write(pages, out, board_title(board))
    write_board(board, description)
    target.wrote()
    command = ("pilotfish", "calibrate", "camera", "camera:0", "--board", description, "--out", "camera.yaml")
    tell_next("with the printed board", *command)


def _leader_remarks(pdf: Path) -> list[str]:
    return [
        f"Made by `pilotfish tags` with {pdf.name}. It holds if that was printed at 100 %, folded by these angles, and",
        "sits there. All lengths in the leader's base frame: x forward, y left, z up from the ground between the",
        "wheels.",
    ]


def _write_leader(leader: Output, body: LeaderBody, pdf: Path) -> None:
    from pilotfish.calibration.body import write_leader_body

    write_leader_body(leader.file, body, _leader_remarks(pdf))
    leader.wrote()
    tell_next("to look at it", "pilotfish", "leader", "show", leader.file)


def _write(pages: list[Page], out: Path, what: str) -> None:
    from pilotfish.printing import write_pdf

    target = output_file(out)
    with progress("drawing pages") as step:
        write_pdf(pages, out, title=what, on_page=step)
    count = f"{len(pages)} page{'s' if len(pages) > 1 else ''} of {pages[0].paper.name}"
    target.wrote(f"{what} on {count}. Print it at 100 % and measure the bar.")

"""``pilotfish render board``: pictures of a calibration board, and the camera that took them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.board_options import COLUMNS, DICTIONARY, ROWS, SQUARE, board_from_options
from pilotfish.cli.camera_choice import (
    BlurOption,
    CameraFileOption,
    ConfigFileOption,
    DistortionOption,
    FovOption,
    LensOption,
    NoiseOption,
    SeedOption,
    SizeOption,
    chosen_camera,
)
from pilotfish.cli.console import friendly_errors, tell, tell_next
from pilotfish.cli.options import between
from pilotfish.cli.outputs import output_beside
from pilotfish.cli.rendered_out import check_out, write_pictures

if TYPE_CHECKING:
    from pilotfish.calibration.board import Board
    from pilotfish.calibration.rehearsal import BoardPose, PictureFlaws, Shot
    from pilotfish.core import CameraModel

BOARD, POSES = "The board", "How it is held"
_HELD = 3  # pictures of a film in which the board stands still: a view is taken when it does
_FILM_PERIOD_US = 200_000
_CANDIDATES = 12  # poses that are drawn for one view, of which one is taken


def board(
    context: typer.Context,
    out: Annotated[
        Path, typer.Option("--out", "-o", help="A folder for the pictures, or a film, NAME.mp4.", metavar="FOLDER|MP4")
    ],
    views: Annotated[int, typer.Option(min=1, max=500, help="How many.", metavar="N")] = 25,
    board: Annotated[
        str,
        typer.Option(
            help="charuco or chessboard, with the options below; or a board's YAML file, or charuco:8x6:30mm:22mm.",
            rich_help_panel=BOARD,
        ),
    ] = "charuco",
    columns: Annotated[int, typer.Option(help="Squares along a row, 4 to 40.", rich_help_panel=BOARD)] = COLUMNS,
    rows: Annotated[int, typer.Option(help="Rows of squares, 4 to 40.", rich_help_panel=BOARD)] = ROWS,
    square: Annotated[str, typer.Option(help="Side of a square.", rich_help_panel=BOARD)] = SQUARE,
    marker: Annotated[
        str | None,
        typer.Option(help="Side of a ChArUco marker.", show_default="11/15 of a square", rich_help_panel=BOARD),
    ] = None,
    dictionary: Annotated[
        str | None, typer.Option(help="OpenCV's, of the markers.", show_default=DICTIONARY, rich_help_panel=BOARD)
    ] = None,
    tilt_deg: Annotated[
        tuple[float, float],
        typer.Option(
            help="Least and greatest tilt, about any axis across the line of sight.",
            metavar="MIN MAX",
            rich_help_panel=POSES,
        ),
    ] = (10.0, 40.0),
    share: Annotated[
        float | None,
        typer.Option(
            callback=between(0.1, 0.9),
            help="Of the picture's width, that the board's takes, about.",
            show_default="0.6; of a fisheye 0.35",
            rich_help_panel=POSES,
        ),
    ] = None,
    camera: CameraFileOption = None,
    config: ConfigFileOption = None,
    fov_deg: FovOption = None,
    size: SizeOption = None,
    lens: LensOption = None,
    distortion: DistortionOption = None,
    noise: NoiseOption = 2.0,
    blur_px: BlurOption = 0.5,
    seed: SeedOption = 1,
) -> None:
    """Render pictures of a calibration board, to rehearse `pilotfish calibrate camera` without a camera.

    The board is the one that `pilotfish tags --board` prints. It is held in poses that cover the picture, tilted to all
    sides. Beside the pictures stands truth.yaml: the camera, as a calibration file, and where the board was; of a film
    NAME_truth.yaml.

    \b
    Examples: render, calibrate, and compare
      pilotfish render board --out pictures
      pilotfish calibrate camera pictures --board charuco:8x6:30mm:22mm \\
          --truth pictures/truth.yaml --out camera.yaml

    \b
    Another board, another camera, a film
      pilotfish render board --board chessboard --columns 10 --rows 7 \\
          --square 25mm --out pictures
      pilotfish render board --fov-deg 75 --size 1280x720 \\
          --distortion -0.1,0.02 --out pictures
      pilotfish render board --fov-deg 150 --lens fisheye --views 30 --out wide
      pilotfish render board --config robot1/robot1.yaml --out board.mp4
    """
    from pilotfish.calibration.camera.board_spelling import spelled
    from pilotfish.calibration.rehearsal import PictureFlaws, board_poses, outlets, write_true_camera
    from pilotfish.core import Lens
    from pilotfish.extras import require

    low, high = tilt_deg
    if not 0.0 <= low <= high <= 70.0:
        raise typer.BadParameter(f"--tilt-deg: {low:g} {high:g} is not a range within 0 to 70 degrees")
    with friendly_errors():
        require("cv2", "calibrate")
        the_board = _board(context, board, columns, rows, square, marker, dictionary)
        model, _ = chosen_camera(camera, config, fov_deg, size, lens, distortion)
        kind, note = check_out(out, (outlets.FOLDER, outlets.FILM), views, (model.width, model.height))
        truth = outlets.beside(out, "truth.yaml")
        true = output_beside(truth)
        is_fisheye = model.lens == Lens.kannala_brandt
        poses = board_poses(
            the_board,
            model,
            views,
            seed,
            tilt_deg=tilt_deg,
            share=share or (0.35 if is_fisheye else 0.6),
            candidates=_CANDIDATES,
        )
        held = 1 if kind == outlets.FOLDER else _HELD
        shots = _shots(the_board, model, poses, PictureFlaws(noise, blur_px), seed, held)
        count = write_pictures("rendering the board", kind, out, shots, views * held)
        names = [outlets.picture_name(k) if kind == outlets.FOLDER else f"frame {k}" for k in range(count)]
        remarks = [
            f"The camera that took {out.name}, rendered by `pilotfish render board`: what a calibration should find.",
            f"Noise of {noise:g} gray levels, blur of {blur_px:g} px.",
        ]
        named = {name: poses[k // held] for k, name in enumerate(names)}
        write_true_camera(truth, model, named, remarks)
        tell(f"wrote {count} pictures to {out}{note}")
        true.wrote()
        told = board if Path(board).is_file() else spelled(the_board)
        command = ["pilotfish", "calibrate", "camera", out, "--board", told, *(["--model", "fisheye"] * is_fisheye)]
        tell_next("to calibrate and compare", *command, "--truth", truth, "--out", "camera.yaml")


def _board(
    context: typer.Context,
    board: str,
    columns: int,
    rows: int,
    square: str,
    marker: str | None,
    dictionary: str | None,
) -> Board:
    from pilotfish.calibration.camera import board_of

    if board in ("charuco", "chessboard"):
        return board_from_options(board, columns, rows, square, marker, dictionary)
    numbers = ("columns", "rows", "square", "marker", "dictionary")
    sources = {name: context.get_parameter_source(name) for name in numbers}
    given = [f"--{name}" for name, source in sources.items() if source is not None and source.name == "COMMANDLINE"]
    if given:
        raise typer.BadParameter(f"{', '.join(given)}: only with --board charuco or chessboard; {board} has its own")
    if ":" not in board and not Path(board).exists():
        raise typer.BadParameter(
            f"--board: '{board}' is neither charuco nor chessboard, nor a file, nor spelled as charuco:8x6:30mm:22mm"
        )
    return board_of(board)


def _shots(
    board: Board, camera: CameraModel, poses: list[BoardPose], flaws: PictureFlaws, seed: int, held: int
) -> Iterator[Shot]:
    """Each pose ``held`` times, with noise of its own."""
    from pilotfish.calibration.rehearsal import Shot, render_board

    for k in range(len(poses) * held):
        image = render_board(board, camera, poses[k // held], flaws, seed=1_000_003 * seed + k)
        yield Shot((k + 1) * _FILM_PERIOD_US, image)

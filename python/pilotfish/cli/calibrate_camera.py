"""``pilotfish calibrate camera``: from pictures of a printed board to the camera's calibration file."""

from __future__ import annotations

import re
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import friendly_errors, progress, warn, working
from pilotfish.cli.options import between
from pilotfish.cli.outputs import OutputFolder, output_file, writable_folder
from pilotfish.cli.truth_report import OFF_TRUTH, TruthOfCamera, print_differences

if TYPE_CHECKING:
    from pilotfish.calibration.camera import BoardDetector, Found
    from pilotfish.calibration.camera.pictures import Pictures

BAD_CALIBRATION = 65  # exit code: sysexits.h's EX_DATAERR


class LensModel(str, Enum):
    """The lenses that can be fitted."""

    pinhole = "pinhole"
    fisheye = "fisheye"


def camera(
    source: Annotated[
        str, typer.Argument(help="A folder of pictures, a video file, or camera:N for a camera that runs.")
    ],
    board: Annotated[
        str,
        typer.Option(
            help="The board's YAML file, or charuco:8x6:30mm:22mm, chessboard:9x7:25mm (squares, not corners)."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", dir_okay=False, help="The calibration file to write. Without it: report only."),
    ] = None,
    model: Annotated[
        LensModel,
        typer.Option(help="pinhole: k1, k2, p1, p2, k3. fisheye: Kannala and Brandt's, for 120 degrees and more."),
    ] = LensModel.pinhole,
    size: Annotated[
        str, typer.Option(help="Of camera:N: the pictures' width and height.", metavar="WIDTHxHEIGHT")
    ] = "640x480",
    rate_hz: Annotated[
        float, typer.Option(callback=between(1.0, 1000.0, "Hz"), help="Of camera:N: pictures per second.")
    ] = 30.0,
    views: Annotated[
        int, typer.Option(min=4, max=500, help="Of a video or a camera: at most this many views.", metavar="N")
    ] = 40,
    every: Annotated[int, typer.Option(min=1, help="Of a video: look at every N-th frame only.", metavar="N")] = 1,
    report: Annotated[
        Path | None,
        typer.Option(
            file_okay=False, callback=writable_folder, help="Folder for pictures: coverage, residuals, distortion."
        ),
    ] = None,
    anyway: Annotated[bool, typer.Option("--anyway", help="Write the file even if the verdict is 'do again'.")] = False,
    truth: TruthOfCamera = None,
) -> None:
    """Calibrate a camera with a printed board: focal length, principal point, distortion, and what they are worth.

    \b
    What to do
      Print a board (pilotfish tags --board) and glue it to something stiff and
      flat. Measure its squares. Fix focus and zoom; use the size of pictures
      that the robot will use. Take 20 to 40 pictures: the board fills a third
      to two thirds of the picture, and its views together all of it, corners
      included; in most of them it is tilted by 20 to 45 degrees, each time to
      another side. Hold it still: blur moves corners. A ChArUco board may be
      partly outside of the picture, a chessboard must be whole.

    \b
    With camera:N
      Views are taken by themselves when the board is still and held as never
      before. The map shows where it has been, the line below what is missing.
      It ends when the verdict is good; Ctrl-C ends it with what there is.

    \b
    What comes out
      The file that a coordinator reads (camera.calibration), a table with one
      standard deviation of each number, the error of views that took no part
      in the fit, the views that were left out and why, and a verdict: good,
      usable, or do again, with what is missing. Exit code 65: do again.

    \b
    Examples
      pilotfish calibrate camera pictures --board board.yaml --out camera.yaml
      pilotfish calibrate camera camera:0 --board charuco:8x6:30mm:22mm \\
          --out camera.yaml --report calibration
      pilotfish calibrate camera board.mp4 --board chessboard:9x7:25mm \\
          --every 5 --out camera.yaml

    \b
    Rehearsed without a camera
      pilotfish render board --out pictures
      pilotfish calibrate camera pictures --board charuco:8x6:30mm:22mm \\
          --truth pictures/truth.yaml
    """
    from pilotfish.calibration import camera as calibration
    from pilotfish.calibration.camera.calibration_file import check_readable
    from pilotfish.calibration.rehearsal import board_middles, camera_differences, check_comparable, read_true_camera
    from pilotfish.cli.camera_report import print_camera_report, remarks

    width_height = _size(size)
    with friendly_errors():
        target = output_file(out, [Path(source), Path(board), *([truth] if truth else [])]) if out else None
        true_camera = read_true_camera(truth) if truth else None
        the_board = calibration.board_of(board)
        detector = calibration.BoardDetector(the_board)
        pictures = calibration.open_pictures(source, width_height, rate_hz)
        found = _look(pictures, detector, model.value, views, every)
        if true_camera:
            check_comparable(true_camera, found.size, model.value)
        if pictures.kind != calibration.FOLDER:
            calibration.check_film(found)
        with working("fitting") as say:
            result = calibration.calibrate_camera(found.views, found.size, the_board, model=model.value, on_stage=say)
        print_camera_report(found, result)
        if report:
            from pilotfish.calibration.camera.drawings import save_drawings

            drawn = OutputFolder(report)
            for file in save_drawings(result, report):
                drawn.wrote(file)
        bad = result.verdict.grade == calibration.AGAIN
        if target and bad and not anyway:
            warn(f"{target.file} was not written: calibrate again, or add --anyway")
        elif target:
            calibration.write_calibration(target.file, result.lens, remarks(source, the_board, result))
            target.wrote()
        agrees = True
        if truth and true_camera:
            differences = camera_differences(
                check_readable(result.lens), true_camera, board_middles(result, the_board), the_board
            )
            agrees = print_differences(differences, truth)
    if bad:
        raise typer.Exit(BAD_CALIBRATION)
    if not agrees:
        raise typer.Exit(OFF_TRUTH)


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text)
    if not match or not all(16 <= int(side) <= 16384 for side in match.groups()):
        raise typer.BadParameter(f"--size: '{text}' is not WIDTHxHEIGHT with 16 to 16384 pixels each, as 640x480")
    return int(match[1]), int(match[2])


def _look(pictures: Pictures, detector: BoardDetector, model: str, views: int, every: int) -> Found:
    from pilotfish.calibration import camera as calibration
    from pilotfish.cli.camera_live import live_map

    if pictures.kind == calibration.FOLDER:
        with progress("finding the board") as step:
            return calibration.every_picture(pictures, detector, step)
    if pictures.kind == calibration.VIDEO:
        with progress("finding the board") as step:
            return calibration.worthwhile_pictures(
                pictures, detector, wanted=views, every=every, model=model, on_picture=step
            )
    with live_map() as show:
        return calibration.worthwhile_pictures(
            pictures, detector, wanted=views, model=model, until_good=True, on_progress=show
        )

"""What is said about a camera's calibration: on the console, and at the top of its file."""

from __future__ import annotations

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from pilotfish.calibration.board import Board
from pilotfish.calibration.camera import AGAIN, GOOD, CameraCalibration, Found
from pilotfish.cli.console import console, tell, warn

MANY_VIEWS = 30  # of more, only the worst are listed
_COLOURS = {GOOD: "green", AGAIN: "red"}


def remarks(source: str, board: Board, calibration: CameraCalibration) -> list[str]:
    """The comments above a calibration: from what, and how well."""
    lens, sigma = calibration.lens, calibration.known.sigma
    numbers = ", ".join(
        f"{name} {s:.2g}" for name, s, free in zip(lens.names, sigma, calibration.fit.free, strict=True) if free
    )
    lines = [
        f"Calibrated by `pilotfish calibrate camera` from {len(calibration.views)} views of a {board.kind} in "
        f"{source}.",
        f"RMS {calibration.fit.rms_px:.3f} px" + _unseen(calibration) + f"; verdict: {calibration.verdict.grade}.",
        f"One standard deviation: {numbers}.",
        *calibration.verdict.reasons,
    ]
    return [" ".join(line.split()) for line in lines]


def print_camera_report(found: Found, calibration: CameraCalibration) -> None:
    """Parameters, coverage, views, what was left out, and the verdict."""
    console.print(_parameters(calibration))
    console.print("where the board has been (denser: more corners)")
    for line in calibration.coverage.text():
        console.print(f"  |{line}|", markup=False, highlight=False)
    coverage = calibration.coverage
    said = f"{coverage.share:.0%} of the picture's cells; {calibration.tilts.tilted} tilted views"
    console.print(said, soft_wrap=True)
    console.print(_views(calibration))
    if found.outcomes:
        counted = ", ".join(f"{count} {what}" for what, count in found.outcomes.most_common())
        console.print(f"{found.read} pictures: {counted}", soft_wrap=True)
    for each in calibration.rejected:
        tell(f"left out {each.name}: {each.why}: {each.detail}")
    if calibration.dropped_corners:
        console.print(f"{calibration.dropped_corners} single corners did not fit and were left out", soft_wrap=True)
    console.print(
        f"{len(calibration.views)} of {len(found.views)} views used; RMS {calibration.fit.rms_px:.3f} px"
        + _unseen(calibration),
        soft_wrap=True,
    )
    if other := calibration.other:
        console.print(f"as {other.model}: RMS {other.rms_px:.3f} px", soft_wrap=True)
    for note in calibration.verdict.notes:
        warn(note)
    grade = calibration.verdict.grade
    console.print(Text(f"verdict: {grade}", style=f"bold {_COLOURS.get(grade, 'yellow')}"))
    for reason in calibration.verdict.reasons:
        tell(f"  - {reason}")


def _unseen(calibration: CameraCalibration) -> str:
    if calibration.unseen is None:
        return "; too few views to test it on unseen ones"
    return f", of unseen views {calibration.unseen.rms_px:.3f} px ({calibration.unseen.folds}-fold)"


def _parameters(calibration: CameraCalibration) -> Table:
    lens, sigma, free = calibration.lens, calibration.known.sigma, calibration.fit.free
    table = Table(title=f"{lens.model}, {lens.width}x{lens.height} px", box=SIMPLE_HEAD)
    for column in ("", "value", "± (1 sigma)", ""):
        table.add_column(column, justify="right")
    for k, (name, value) in enumerate(zip(lens.names, lens.values, strict=True)):
        if not free[k]:
            table.add_row(name, "0", "-", "not needed")
            continue
        unit = f"px (± {100 * sigma[k] / value:.3f} %)" if k < 2 else "px" if k < 4 else ""
        digits = 3 if k < 4 else 6
        table.add_row(name, f"{value:.{digits}f}", f"{sigma[k]:.{digits}f}", unit)
    return table


def _views(calibration: CameraCalibration) -> Table:
    errors = calibration.fit.view_rms_px
    order = np.arange(len(errors))
    title = "views"
    if len(errors) > MANY_VIEWS:
        order = np.argsort(-errors)[:MANY_VIEWS]
        title = f"the {MANY_VIEWS} views that fit worst, of {len(errors)}"
    table = Table(title=title, box=SIMPLE_HEAD, padding=0)
    for column in ("view", "corners", "RMS px", "unseen px", "tilt °", "blur px"):
        table.add_column(column, justify="left" if column == "view" else "right")
    for k in order:
        view = calibration.views[k]
        unseen = "-" if calibration.unseen is None else f"{calibration.unseen.view_rms_px[k]:.3f}"
        cells = (
            str(len(view)),
            f"{errors[k]:.3f}",
            unseen,
            f"{calibration.tilts.tilts_deg[k]:.0f}",
            f"{view.blur_px:.1f}",
        )
        table.add_row(Text(view.name), *cells)
    return table

"""Where the commands of `pilotfish render` for calibrations write to."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from pilotfish.cli.board_options import read_option
from pilotfish.cli.console import progress
from pilotfish.cli.outputs import in_new_folder, output_file, output_folder

if TYPE_CHECKING:
    from pilotfish.calibration.rehearsal import Shot
    from pilotfish.cli.console import OnProgress


def check_out(out: Path, allowed: tuple[str, ...], count: int, camera: tuple[int, int]) -> tuple[str, str]:
    """The kind of ``out``, and what is to be said of where it lies (in a new folder, or replaced).

    Before minutes are spent: what cannot be written, pictures that would be mixed, a film of an odd size. ConfigError,
    ExistsError, OSError, typer.BadParameter, MissingPackageError."""
    from pilotfish.calibration.rehearsal import outlets
    from pilotfish.extras import require

    kind = read_option("--out", outlets.kind_of, out)
    if kind not in allowed:
        names = {outlets.FOLDER: "a folder", outlets.FILM: "a film (NAME.mp4)", outlets.LOG: "a log (NAME.lcmlog)"}
        raise typer.BadParameter(f"--out: '{out}' is not {' or '.join(names[each] for each in allowed)}")
    if kind == outlets.FOLDER:
        if out.exists() and not out.is_dir():
            raise typer.BadParameter(f"--out: {out} is a file; name a folder, or NAME.mp4")
        output_folder(out)
        outlets.check_folder(out, count)
        return kind, in_new_folder(out)
    target = output_file(out)
    if kind == outlets.FILM:
        require("av", "export")
        if any(side % 2 for side in camera):
            raise typer.BadParameter(
                f"--out: a film's sides are even, the pictures have {camera[0]}x{camera[1]} px: write a folder"
            )
    return kind, target.note


def write_pictures(label: str, kind: str, out: Path, shots: Iterator[Shot], count: int) -> int:
    """To the folder or the film ``out``, with a bar; how many were written."""
    from pilotfish.calibration.rehearsal import outlets

    write = outlets.write_folder if kind == outlets.FOLDER else outlets.write_film
    return with_progress(label, lambda step: write(out, shots, count, step))


def with_progress(label: str, write: Callable[[OnProgress], int]) -> int:
    """The number of pictures that ``write`` wrote, with a bar."""
    with progress(label) as step:
        return write(step)

"""Choices that several commands offer."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.outputs import writable_folder


def between(low: float, high: float, unit: str = "") -> Callable[[float | None], float | None]:
    """A callback that lets only numbers from low to high through; click's own ranges let NaN pass."""

    def check(value: float | None) -> float | None:
        if value is not None and not low <= value <= high:
            raise typer.BadParameter(f"{value} is not a number from {low:g} to {high:g} {unit}".rstrip())
        return value

    return check


def check_family(name: str) -> None:
    """Refuses what is no tag family, before anything is opened."""
    from pilotfish.errors import ConfigError
    from pilotfish.vision import TagFamily

    try:
        TagFamily(name)
    except ConfigError as error:
        raise typer.BadParameter(f"--family: {str(error).removeprefix('leader.family: ')}") from None


DurationOption = Annotated[
    float | None,
    typer.Option(
        "--duration-s",
        callback=between(0.5, 1e5, "s"),
        help="Play this long instead of what the scenario says; 0.5 to 1e5 s.",
    ),
]


class PictureFormat(str, Enum):
    """What pictures are written as."""

    png = "png"
    svg = "svg"
    pdf = "pdf"


FormatOption = Annotated[
    PictureFormat,
    typer.Option("--format", help="What drawings are written as; svg and pdf keep text as text and scale."),
]
DarkOption = Annotated[bool, typer.Option("--dark", help="Light lines on a dark ground.")]

OutOption = Annotated[
    Path | None,
    typer.Option("--out", file_okay=False, callback=writable_folder, help="Folder for recordings (CSV) and pictures."),
]


CalibrationOption = Annotated[
    Path, typer.Option("--camera", exists=True, dir_okay=False, help="Its calibration: OpenCV's YAML, ViSP's XML.")
]
TagSizesOption = Annotated[
    list[str],
    typer.Option(
        "--tag-size",
        help="Side of the black squares in metres, as 0.16; of one id, as 7=0.10. Can be repeated.",
        metavar="[ID=]METRES",
    ),
]

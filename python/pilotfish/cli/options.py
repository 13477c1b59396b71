"""Choices that several commands offer."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer


class Which(str, Enum):
    line = "line"
    circle = "circle"
    both = "both"


class Profile(str, Enum):
    paper = "paper"
    anticipate = "anticipate"


ProfileOption = Annotated[
    Profile,
    typer.Option(help="The law that drives: as published, or around a feed-forward of the leader's motion."),
]
InProcessOption = Annotated[
    bool, typer.Option("--in-process", help="Without programs and LCM: the same code, called directly.")
]
DurationOption = Annotated[
    float | None,
    typer.Option("--duration-s", min=0.5, help="Play this long instead of what the scenario says."),
]
OutOption = Annotated[
    Path | None,
    typer.Option("--out", file_okay=False, help="Folder for recordings (CSV) and pictures (PNG)."),
]

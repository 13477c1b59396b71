"""``pilotfish calibrate``: what a robot's eyes need to be told once."""

from __future__ import annotations

import typer

from pilotfish.cli.calibrate_camera import camera
from pilotfish.cli.calibrate_mounting import mounting

app = typer.Typer(
    help="Calibrate a camera with a printed board, and where it sits on the robot.",
    no_args_is_help=True,
    rich_markup_mode="rich",
)
for command in (camera, mounting):
    app.command()(command)

"""``pilotfish init``: a folder with everything one robot needs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.console import friendly_errors, tell, tell_next, warn
from pilotfish.cli.outputs import writable_folder


def init(
    name: Annotated[str, typer.Argument(help="The robot's name on the bus: 1 to 32 letters, digits and underscores.")],
    folder: Annotated[
        Path | None,
        typer.Option("--dir", file_okay=False, help="Where; must be empty or not there yet. Default: ./NAME."),
    ] = None,
    source: Annotated[
        str, typer.Option("--source", help="Where its pictures come from: camera:N, or lcm for images on the bus.")
    ] = "camera:0",
    calibration: Annotated[
        Path | None,
        typer.Option(
            "--calibration", exists=True, dir_okay=False, help="Its camera's calibration, by OpenCV or ViSP, to copy."
        ),
    ] = None,
    leader: Annotated[
        Path | None,
        typer.Option("--leader", exists=True, dir_okay=False, help="The leader file of whom it follows, to copy."),
    ] = None,
    user: Annotated[
        str | None, typer.Option("--user", help="Who the services run as. Default: you (root: the user pilotfish).")
    ] = None,
) -> None:
    """Make a folder for a robot: configuration, leader, calibration, fuzzy law, wheels, systemd units, README with
    the next steps.

    It works from anywhere. The robot looks and stands still until `pilotfish go NAME`. Never overwrites anything.

    \b
    Examples
      pilotfish init robot1
      pilotfish init robot1 --dir /srv/robot1 --calibration camera.yaml --leader leader.yaml
    """
    from pilotfish.robot_folder import Options, create

    place = folder or Path(name)
    with friendly_errors():
        _check_words(name, source, user)
        _check_place(place)
        writable_folder(place)
        files = create(name, place, Options(source, calibration, leader, user))
        for file in files:
            tell(f"wrote {file}")
        if place.resolve().is_relative_to("/tmp"):
            warn("services have a /tmp of their own and cannot see this folder: choose another --dir for them")
        tell(f"\nstep by step: {place / 'README.md'}")
        tell_next("is everything there?", "pilotfish", "doctor", "--config", place / f"{name}.yaml")


def _check_place(place: Path) -> None:
    """Its units name it, and the folder that this command runs in may be part of that."""
    from pilotfish.robot_folder.units import unusable

    if problem := unusable(place.absolute()):
        raise typer.BadParameter(f"--dir: {problem}: choose another folder")


def _check_words(name: str, source: str, user: str | None) -> None:
    import re

    from pilotfish.bus import channel
    from pilotfish.errors import ConfigError

    try:
        channel(name, "STATUS")
    except ConfigError as error:
        raise typer.BadParameter(str(error)) from None
    if not re.fullmatch(r"(camera:\d{1,3}|lcm(:\w{1,63})?)", source):
        raise typer.BadParameter(f"--source: '{source}' is not camera:N, lcm or lcm:CHANNEL")
    if user is not None and not re.fullmatch(r"[a-z_][a-z0-9_-]{0,31}", user):
        raise typer.BadParameter(f"--user: '{user}' is no user's name (lower-case letters, digits, _ and -)")

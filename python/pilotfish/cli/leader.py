"""``pilotfish leader``: look at a leader's file before a robot drives by it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from pilotfish.cli.console import console, friendly_errors
from pilotfish.cli.options import between
from pilotfish.cli.outputs import output_picture

if TYPE_CHECKING:
    from pilotfish.core import LeaderBody
    from pilotfish.leader import Finding, Viewer, Visibility

app = typer.Typer(help="Look at a leader's file (the tags it wears): show, check.", no_args_is_help=True)

FINDINGS = 1  # exit code of check
_COLOURS = {"error": "bold red", "warning": "bold yellow", "note": "dim"}

FileArgument = Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="A leader's YAML.")]
ConfigOption = Annotated[
    Path | None,
    typer.Option(
        exists=True, dir_okay=False, help="A coordinator's configuration: its camera, where it sits, its gates."
    ),
]
CameraOption = Annotated[
    Path | None,
    typer.Option(
        exists=True,
        dir_okay=False,
        help="Instead, a camera's calibration alone; it then looks straight ahead at the tags' mean height.",
    ),
]
DistanceOption = Annotated[
    float | None,
    typer.Option(
        "--distance-m",
        callback=between(0.1, 100.0, "m"),
        help="Look from this far, between the turning centres.",
        show_default="the configuration's setpoint, or 1.1",
    ),
]
HeightOption = Annotated[
    float | None,
    typer.Option(
        "--height-m",
        callback=between(0.0, 10.0, "m"),
        help="Look from this high.",
        show_default="the configuration's camera, or the tags' mean height",
    ),
]


@app.command()
def show(
    file: FileArgument,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", dir_okay=False, help="The picture: .png, .svg or .pdf.", show_default="NAME.png"),
    ] = None,
    config: ConfigOption = None,
    camera: CameraOption = None,
    distance_m: DistanceOption = None,
    height_m: HeightOption = None,
) -> None:
    """Draw a leader's tags in space and from above, and say what `leader check` says.

    \b
    Examples
      pilotfish leader show data/leaders/three_faces.yaml --out three_faces.png
      pilotfish leader show my_robot.yaml --out my_robot.svg \\
          --config data/config/coordinator.yaml
    """
    from pilotfish.plots.leader_picture import draw_leader
    from pilotfish.plots.style import save

    with friendly_errors():
        picture = output_picture(out or Path(f"{file.stem}.png"))
        body, visibility, findings = _look(file, config, camera, distance_m, height_m)
        remarks = [f"{finding.level.value}: {finding.text}" for finding in findings] or ["nothing found"]
        save(draw_leader(body, visibility, remarks), picture.file)
        picture.wrote()


@app.command()
def check(
    file: FileArgument,
    config: ConfigOption = None,
    camera: CameraOption = None,
    distance_m: DistanceOption = None,
    height_m: HeightOption = None,
) -> None:
    """Say what is wrong with a leader's file, from where its tags are seen, and how near and far.

    \b
    Exit codes: 78 if the file cannot be used, 1 if there are errors or warnings,
    0 with notes at most.

    \b
    Examples
      pilotfish leader check data/leaders/three_faces.yaml
      pilotfish leader check my_robot.yaml --config data/config/coordinator.yaml
      pilotfish leader check my_robot.yaml --camera camera.yaml --distance-m 2
    """
    with friendly_errors():
        _, _, findings = _look(file, config, camera, distance_m, height_m)
        if any(finding.level.value != "note" for finding in findings):
            raise typer.Exit(FINDINGS)


def _look(
    file: Path, config: Path | None, camera: Path | None, distance_m: float | None, height_m: float | None
) -> tuple[LeaderBody, Visibility, list[Finding]]:
    """Loads, checks and prints."""
    from pilotfish.leader import check_leader, load_leader, look_all_round

    if config is not None and camera is not None:
        raise typer.BadParameter("--config and --camera exclude each other: a configuration names its camera")
    body = load_leader(file)
    mean_height_m = max(sum(float(tag.position_m[2]) for tag in body.tags) / len(body.tags), 0.0)
    viewer, setpoint_m = _viewer(config, camera, mean_height_m)
    if height_m is None:
        height_m = float(viewer.mounting.position_m[2]) if config is not None and viewer else mean_height_m
    visibility = look_all_round(body, distance_m=distance_m or setpoint_m or 1.1, height_m=height_m)
    findings = check_leader(body, visibility, viewer)
    _print_tags(body, visibility)
    if viewer is not None:
        _print_reaches(body, viewer)
    for finding in findings:
        level = finding.level.value
        console.print(f"[{_COLOURS[level]}]{level}[/] {escape(finding.text)}", soft_wrap=True)
    if viewer is None:
        console.print("[dim]how near and how far: add --config or --camera[/]", soft_wrap=True)
    return body, visibility, findings


def _viewer(config: Path | None, camera: Path | None, height_m: float) -> tuple[Viewer | None, float | None]:
    """Who looks, and from how far if a configuration says so."""
    from pilotfish.coordinator import load_calibration, load_coordinator
    from pilotfish.core import CameraMounting
    from pilotfish.errors import ConfigError
    from pilotfish.leader import Viewer

    try:
        if config is not None:
            coordinator = load_coordinator(str(config)).coordinator
            viewer = Viewer(coordinator.camera, coordinator.mounting, coordinator.vision)
            return viewer, coordinator.setpoint.distance_m
        if camera is not None:
            mounting = CameraMounting(position_m=[0.0, 0.0, height_m])
            return Viewer(load_calibration(str(camera)), mounting), None
    except ValueError as error:
        file = config or camera
        raise ConfigError(str(error) if str(file) in str(error) else f"{file}: {error}") from error
    return None, None


def _print_tags(body: LeaderBody, visibility: Visibility) -> None:
    table = Table(title=f"{body.name} ({body.family})", title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    columns = ["tag", "size mm", "forward", "left", "up m", "facing", "tilt", "roll °", "seen from"]
    for column in columns:
        table.add_column(column, justify="left" if column == "seen from" else "right")
    for k, tag in enumerate(body.tags):
        sectors = visibility.sectors(visibility.seen[:, k])
        row = [str(tag.id), f"{tag.size_m * 1e3:g}", *(f"{value + 0.0:.3f}" for value in tag.position_m)]
        row += [f"{math.degrees(turn) + 0.0:.1f}" for turn in (tag.facing_rad, tag.tilt_rad, tag.roll_rad)]
        row.append(", ".join(str(sector) for sector in sectors) or "nowhere")
        table.add_row(*row)
    console.print(table)


def _print_reaches(body: LeaderBody, viewer: Viewer) -> None:
    from pilotfish.leader import tag_reach

    title = "Between the turning centres, the tag seen squarely and sharply"
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for column in ("tag", "nearest m", "found to m", "followed to m"):
        table.add_column(column, justify="right")
    for reach in tag_reach(body, viewer):
        distances = f"{reach.nearest_m:.2f}", f"{reach.found_to_m:.1f}", f"{reach.followed_to_m:.1f}"
        table.add_row(str(reach.id), *distances)
    console.print(table)

"""``pilotfish plot``: draw a recording or a fuzzy controller."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer
import yaml

from pilotfish.cli.console import console, friendly_errors
from pilotfish.cli.options import between
from pilotfish.errors import ConfigError, PilotfishError
from pilotfish.files import read_text


def plot(
    file: Annotated[
        Path,
        typer.Argument(exists=True, dir_okay=False, help="A recording (.csv) or fuzzy sets and rules (.yaml)."),
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", file_okay=False, help="Folder for the pictures; default: beside FILE."),
    ] = None,
    robot: Annotated[
        str | None, typer.Option(help="Whose run, if the recording holds several; default: every robot's.")
    ] = None,
    distance_setpoint_m: Annotated[
        float | None,
        typer.Option(
            callback=between(0.0, 1e3, "m"), help="d_p, if the recording does not say it (pilotfish-sim's do not)."
        ),
    ] = None,
    bearing_setpoint_deg: Annotated[
        float, typer.Option(callback=between(-360.0, 360.0, "degrees"), help="theta_pd, likewise.")
    ] = 0.0,
) -> None:
    """Draw a recording (distance error, paths) or a fuzzy controller (sets, control surface).

    \b
    Examples
      pilotfish plot out/line_paper.csv
      pilotfish plot chain.csv --robot robot2 --distance-setpoint-m 1.1
      pilotfish plot data/fuzzy/coordination.yaml --out out
    """
    with friendly_errors():
        draw = {".csv": _draw_recording, ".yaml": _draw_fuzzy, ".yml": _draw_fuzzy}.get(file.suffix)
        if draw is None:
            raise typer.BadParameter(f"'{file.suffix}' is neither .csv (a recording) nor .yaml (a fuzzy controller)")
        folder = out or file.parent
        for written in draw(file, folder, robot, distance_setpoint_m, bearing_setpoint_deg):
            console.print(f"wrote {written}", soft_wrap=True)


def _draw_recording(
    file: Path, out: Path, robot: str | None, distance_m: float | None, bearing_deg: float
) -> list[Path]:
    from pilotfish.plots.distance_error import draw_distance_error
    from pilotfish.plots.paths import draw_paths
    from pilotfish.plots.style import save
    from pilotfish.recording import Recording, read_csv

    runs = [Recording.from_csv(file, robot)] if robot else list(read_csv(file).values())
    if distance_m is not None:
        setpoint = {"distance_setpoint_m": distance_m, "bearing_setpoint_rad": math.radians(bearing_deg)}
        runs = [run.with_meta(**setpoint) for run in runs]
    if not all(math.isfinite(run.meta.distance_setpoint_m) for run in runs):
        raise typer.BadParameter(f"{file} does not say what distance was to be kept: add --distance-setpoint-m")
    written = [save(draw_paths(runs, f"{file.stem}: from above"), out / f"{file.stem}_paths.png")]
    for run in runs:
        stem = file.stem if len(runs) == 1 else f"{file.stem}_{run.meta.robot}"
        title = f"{stem}: distance error"
        written.append(save(draw_distance_error(run, title), out / f"{stem}_distance_error.png"))
    return written


def _draw_fuzzy(file: Path, out: Path, *_: object) -> list[Path]:
    from pilotfish import fuzzy
    from pilotfish.plots.fuzzy_sets import draw_fuzzy_sets
    from pilotfish.plots.style import save
    from pilotfish.plots.surface import draw_surface

    try:
        controller = fuzzy.load_controller(file)
    except ValueError as error:
        other = _other_kind(file)
        problem = f"is {other}, not a fuzzy controller; this draws recordings (.csv) and fuzzy controllers (.yaml)"
        raise ConfigError(f"{file} {problem}" if other else f"{file}: {error}") from error
    sets = draw_fuzzy_sets(controller, f"Membership functions of '{controller.name}'")
    surface = draw_surface(controller, f"Control surface of '{controller.name}'")
    return [save(sets, out / f"{file.stem}_sets.png"), save(surface, out / f"{file.stem}_surface.png")]


def _other_kind(file: Path) -> str | None:
    """What a YAML file is that is no fuzzy controller, by the keys that every file of its kind has."""
    try:
        keys = set(yaml.safe_load(read_text(file)))
    except (yaml.YAMLError, PilotfishError, TypeError, RecursionError):
        return None
    kinds = {"robots": "a scenario", "camera": "a coordinator's configuration", "tags": "a leader's body"}
    return next((kind for key, kind in kinds.items() if key in keys), None)

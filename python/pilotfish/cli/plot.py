"""``pilotfish plot``: draw a recording or a fuzzy controller."""

from __future__ import annotations

import math
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.console import byte_progress, friendly_errors, progress, warn_of_losses
from pilotfish.cli.options import between
from pilotfish.cli.outputs import output_folder, writable_folder
from pilotfish.errors import ConfigError

_LOG_SUFFIXES = (".log", ".lcmlog", ".lcm")
_SYNC = b"\xed\xa1\xda\x01"  # a file of LCM events begins so


class PictureFormat(str, Enum):
    """What a picture is written as."""

    png = "png"
    svg = "svg"
    pdf = "pdf"


def plot(
    file: Annotated[
        Path,
        typer.Argument(
            exists=True,
            help="A black box (a file, or the folder of its ring), a file of lcm-logger, a recording of the simulator "
            "(.csv), or fuzzy sets and rules (.yaml).",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", file_okay=False, callback=writable_folder, help="Folder for the pictures; default: beside FILE."
        ),
    ] = None,
    robot: Annotated[
        str | None, typer.Option(help="Whose run, if the recording holds several; default: every robot's.")
    ] = None,
    picture_format: Annotated[PictureFormat, typer.Option("--format", help="Of the pictures.")] = PictureFormat.png,
    dark: Annotated[
        bool, typer.Option("--dark", help="Light on dark; for black boxes and files of lcm-logger.")
    ] = False,
    distance_setpoint_m: Annotated[
        float | None,
        typer.Option(callback=between(0.0, 1e3, "m"), help="d_p, if a .csv does not say it (pilotfish-sim's do not)."),
    ] = None,
    bearing_setpoint_deg: Annotated[
        float, typer.Option(callback=between(-360.0, 360.0, "degrees"), help="theta_pd, likewise.")
    ] = 0.0,
) -> None:
    """Draw a recorded run (errors, commands, latency, status; the leader from above), or a fuzzy controller (sets,
    control surface).

    \b
    Examples
      pilotfish plot /var/lib/pilotfish --out pictures
      pilotfish plot robot1-1764000000000000-12.lcmlog --format svg --dark
      pilotfish plot out/line_paper.csv
      pilotfish plot chain.csv --robot robot2 --distance-setpoint-m 1.1
      pilotfish plot data/fuzzy/coordination.yaml --out out
    """
    with friendly_errors():
        suffix = f".{picture_format.value}"
        is_log = _is_log(file)
        into = out or (file.resolve() if is_log else file).parent
        folder = output_folder(into)
        if is_log:
            written = _draw_log(file, into, robot, suffix, dark)
        elif dark:
            raise typer.BadParameter(f"--dark is for black boxes and files of lcm-logger, and {file} is neither")
        elif file.suffix == ".csv":
            written = _draw_recording(file, into, suffix, robot, distance_setpoint_m, bearing_setpoint_deg)
        elif file.suffix in (".yaml", ".yml"):
            written = _draw_fuzzy(file, into, suffix)
        else:
            raise typer.BadParameter(
                f"'{file.suffix}' is neither .csv (a recording of the simulator) nor .yaml (a fuzzy controller), and "
                f"{file} does not begin as a black box or a file of lcm-logger does"
            )
        for picture in written:
            folder.wrote(picture)


def _is_log(file: Path) -> bool:
    if file.is_dir() or file.suffix in _LOG_SUFFIXES:
        return True
    if not file.is_file() or file.suffix in (".csv", ".yaml", ".yml"):
        return False
    with file.open("rb") as stream:
        return stream.read(len(_SYNC)) == _SYNC


def _draw_log(file: Path, out: Path, robot: str | None, suffix: str, dark: bool) -> list[Path]:
    from pilotfish.logs import read_run
    from pilotfish.logs.glance import check_recorded
    from pilotfish.plots.relative_view import draw_relative_view
    from pilotfish.plots.run_overview import draw_run_overview
    from pilotfish.plots.style import DARK, LIGHT, save

    check_recorded(file, robot)
    with byte_progress("reading") as step:
        run = read_run(file, robot, step)
    warn_of_losses(run.losses)
    coordinators = run.recorded_coordinators()
    theme, name = DARK if dark else LIGHT, file.resolve().name if file.is_dir() else file.stem
    written: list[Path] = []
    with progress("drawing") as step:
        for one in coordinators:
            stem = name if len(coordinators) == 1 else f"{name}_{one.name}"
            overview = draw_run_overview({one.name: one}, f"{name}: {one.name}", theme)
            written.append(save(overview, out / f"{stem}_run{suffix}"))
            step(len(written), 2 * len(coordinators))
            view = draw_relative_view({one.name: one}, f"{name}: from above, relative to {one.name}", theme)
            written.append(save(view, out / f"{stem}_relative{suffix}"))
            step(len(written), 2 * len(coordinators))
    return written


def _draw_recording(
    file: Path, out: Path, suffix: str, robot: str | None, distance_m: float | None, bearing_deg: float
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
    written = [save(draw_paths(runs, f"{file.stem}: from above"), out / f"{file.stem}_paths{suffix}")]
    for run in runs:
        stem = file.stem if len(runs) == 1 else f"{file.stem}_{run.meta.robot}"
        title = f"{stem}: distance error"
        written.append(save(draw_distance_error(run, title), out / f"{stem}_distance_error{suffix}"))
    return written


def _draw_fuzzy(file: Path, out: Path, suffix: str) -> list[Path]:
    from pilotfish import fuzzy
    from pilotfish.plots.fuzzy_sets import draw_fuzzy_sets
    from pilotfish.plots.style import save
    from pilotfish.plots.surface import draw_surface

    try:
        controller = fuzzy.load_controller(file)
    except ValueError as error:  # says what the file looks like, if it is of another kind
        raise ConfigError(f"{file}: no fuzzy controller: {error}") from error
    sets = draw_fuzzy_sets(controller, f"Membership functions of '{controller.name}'")
    surface = draw_surface(controller, f"Control surface of '{controller.name}'")
    return [save(sets, out / f"{file.stem}_sets{suffix}"), save(surface, out / f"{file.stem}_surface{suffix}")]

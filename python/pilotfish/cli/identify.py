"""``pilotfish identify``: what a robot's drive is like, from a recorded run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from pilotfish.cli.console import byte_progress, friendly_errors, print_whole, tell, warn, warn_of_losses, working
from pilotfish.cli.options import between
from pilotfish.cli.outputs import output_file, output_picture
from pilotfish.errors import RecordingError

if TYPE_CHECKING:
    from pilotfish.identify import DriveFit, KeyVerdict
    from pilotfish.logs import RobotRun


def identify(
    log: Annotated[
        Path,
        typer.Argument(exists=True, help="A black box (a file, or the folder of its ring), or a file of lcm-logger."),
    ],
    robot: Annotated[str | None, typer.Option(help="Whose drive, if the recording holds several robots.")] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", dir_okay=False, help="Write the keys to set as YAML, to be merged."),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(dir_okay=False, help="Draw seen and fitted own speed, and the residuals: .png, .svg or .pdf."),
    ] = None,
    wheel_radius_m: Annotated[
        float | None,
        typer.Option(callback=between(0.005, 1.0, "m"), help="wheels.wheel_radius_m the base was driven with."),
    ] = None,
    track_width_m: Annotated[
        float | None,
        typer.Option(callback=between(0.02, 5.0, "m"), help="wheels.track_width_m the base was driven with."),
    ] = None,
    max_mps2: Annotated[
        float | None,
        typer.Option(
            "--max-acceleration-mps2",
            callback=between(0.01, 1000.0, "m/s^2"),
            help="Of the wheels' driver; default: the run's control.limits.max_linear_acceleration_mps2, or 1.",
        ),
    ] = None,
    max_radps2: Annotated[
        float | None,
        typer.Option(
            "--max-acceleration-radps2",
            callback=between(0.01, 10000.0, "rad/s^2"),
            help="The same for turning; default: the run's, or 10.",
        ),
    ] = None,
) -> None:
    """Fit latency, lag, gains and noise of a drive to a recorded run, and say which keys of the configuration to set.

    Uses only commands and what the camera saw. The leader may drive as it likes, smoothly for most of the time; the
    robot has to change its speed: stop-and-go for 20 s is best.

    \b
    Examples
      pilotfish identify /var/lib/pilotfish
      pilotfish identify run.lcmlog --robot robot1 -o drive.yaml --plot drive.png
      pilotfish identify recordings --wheel-radius-m 0.05 --track-width-m 0.30
    """
    with friendly_errors():
        picture = output_picture(plot, "--plot") if plot else None
        target = output_file(output, [log]) if output else None
        from pilotfish.identify import as_yaml, evidence_of, fit_drive, verdicts_of
        from pilotfish.identify.fit import STRAYING_M_PER_SQRT_S
        from pilotfish.identify.verdicts import settings_numbers
        from pilotfish.logs import read_run
        from pilotfish.logs.glance import check_recorded

        with working("looking what is recorded"):
            check_recorded(log, robot, commands=True)
        with byte_progress("reading") as step:
            run = read_run(log, robot, step)
        warn_of_losses(run.losses)
        one = _only(log, run.recorded_coordinators())
        said = settings_numbers(one.last_settings)
        if len(one.settings) > 1:
            warn(f"{one.name} was started with {len(one.settings)} configurations in this recording; the last is shown")
        with working("fitting"):
            fit = fit_drive(
                evidence_of(one),
                max_mps2=max_mps2 or said.get("control.limits.max_linear_acceleration_mps2", 1.0),
                max_radps2=max_radps2 or said.get("control.limits.max_angular_acceleration_radps2", 10.0),
            )
        verdicts = verdicts_of(fit, one.last_settings, wheel_radius_m=wheel_radius_m, track_width_m=track_width_m)
        _show(one, fit, verdicts)
        if not fit.converged:
            warn("the fit still moved when it ended: record a longer run, or one with more changes of speed")
        if fit.straying_m_per_sqrt_s > STRAYING_M_PER_SQRT_S:
            warn("the wheels slip or step: the latency may be 20 ms too short, and the turn gain a third too great")
        if target:
            from pilotfish.whole_files import write_whole

            write_whole(target.file, as_yaml(verdicts, log.name))
            target.wrote()
        if picture:
            from pilotfish.plots.drive_identification import draw_drive_identification
            from pilotfish.plots.style import save

            save(draw_drive_identification(fit, f"{one.name}: the drive in {log.name}"), picture.file)
            picture.wrote()


def _only(log: Path, robots: list[RobotRun]) -> RobotRun:
    if len(robots) > 1:
        raise RecordingError(f"{log}: several robots; choose with --robot: {', '.join(one.name for one in robots)}")
    return robots[0]


def _show(robot: RobotRun, fit: DriveFit, verdicts: list[KeyVerdict]) -> None:
    online = _online(robot)
    tell(f"{robot.name}: {fit.frames} frames, {fit.duration_s:.1f} s")
    table = Table()
    for name in ("key", "fitted", "run had", "online (STATUS)"):
        table.add_column(name, no_wrap=True)
    for row in verdicts:
        fitted = "-" if row.value is None or row.sigma is None else f"{row.value:.4f} +- {row.sigma:.4f}"
        had = "-" if row.had is None else f"{row.had:.4g}{' (default)' if row.had_default else ''}"
        table.add_row(row.key, fitted, had, online.get(row.key, "-"))
    print_whole(table, 160)
    for row in verdicts:
        tell(f"{row.key}: {row.verdict}")
    tell("")
    for text, found in (("speed gain", fit.linear_gain), ("turn gain", fit.angular_gain)):
        weak = "" if found.observable else "  (not observable in this run)"
        tell(f"{text:<22}{found.value:.4f} +- {found.sigma:.4f}{weak}")
    tell(f"{'noise of distance':<22}{1e3 * fit.distance_sigma_m:.3f} mm, {fit.distance_noise_ratio:.2f} x as stated")
    tell(f"{'noise of bearing':<22}{1e3 * fit.bearing_sigma_rad:.3f} mrad, {fit.bearing_noise_ratio:.2f} x as stated")
    tell(
        f"{'straying (slip)':<22}{1e3 * fit.straying_m_per_sqrt_s:.2f} mm per sqrt(s); a mean slip is part of the "
        "speed gain. control.leader_motion.own_position_sigma learns it"
    )


def _online(robot: RobotRun) -> dict[str, str]:
    """What the coordinator itself had identified at the end."""
    import numpy as np

    frames, shown = robot.frames, {}
    for key, name in (("latency_s", "drive_latency"), ("actuator_lag_s", "drive_lag")):
        known = np.flatnonzero(np.isfinite(frames[f"{name}_s"]))
        if len(known):
            value, sigma = frames[f"{name}_s"][known[-1]], frames[f"{name}_sigma_s"][known[-1]]
            shown[f"control.drive.{key}"] = f"{value:.4f} +- {sigma:.4f}"
    return shown

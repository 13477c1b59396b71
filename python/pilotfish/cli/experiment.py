"""``pilotfish experiment``: run the source paper's experiments and show their figures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.completing import experiments
from pilotfish.cli.console import console, friendly_errors, progress
from pilotfish.cli.driving_options import (
    InProcessOption,
    Law,
    LawOption,
    Profiles,
    ProfilesOption,
    Robot,
    RobotOption,
    TuningOption,
    drivers_of,
)
from pilotfish.cli.options import DarkOption, DurationOption, FormatOption, OutOption, PictureFormat
from pilotfish.cli.outputs import OutputFolder
from pilotfish.harness.driving import BASELINES
from pilotfish.law_names import law_name


def experiment(
    which: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            autocompletion=experiments,
            help="line (Fig. 6), circle (Fig. 7), both; or any shipped scenario (pilotfish data scenarios), or a file "
            "(a scenario, or a formation).",
        ),
    ],
    profile: ProfilesOption = Profiles.both,
    law: LawOption = Law.fuzzy,
    robot: RobotOption = Robot.ideal,
    tuning: TuningOption = None,
    in_process: InProcessOption = False,
    duration_s: DurationOption = None,
    out: OutOption = None,
    all_laws: Annotated[
        bool, typer.Option("--all-laws", help="Then the baselines too, tuned: ViSP's servo (pbvs) and PID (pid).")
    ] = False,
    picture_format: FormatOption = PictureFormat.png,
    dark: DarkOption = False,
) -> None:
    """Run the source paper's experiments, or any other scenario, in simulation and show what came of them.

    The camera is rendered, the tags are detected, the real programs talk over a private LCM bus in lock-step.

    \b
    Examples
      pilotfish experiment line                    the table for Fig. 6
      pilotfish experiment both --out out          with recordings and pictures
      pilotfish experiment circle --in-process     without programs and bus
      pilotfish experiment line --law pid          with a baseline of the fuzzy law
      pilotfish experiment both --all-laws         the fuzzy law and its baselines, compared
      pilotfish experiment both --robot nonideal   with slip, lag, noise and camera misalignment
      pilotfish experiment line --out out --format svg --dark    for a slide
      pilotfish experiment chain --profile anticipate
      pilotfish experiment my_scenario.yaml
    """
    from pilotfish.cli.pictures import gallery, save_comparison, save_pictures, save_recording
    from pilotfish.experiments import EXPERIMENTS, experiment_of, metrics_tables, run_all_robots
    from pilotfish.formation.expand import scenario_of

    transport = "in-process" if in_process else "lcm"
    with friendly_errors(), scenario_of(which) as which:
        chosen = list(EXPERIMENTS.values()) if which == "both" else [experiment_of(which)]
        if robot is Robot.nonideal:
            chosen = [experiment.on_nonideal_robot() for experiment in chosen]
        drivers = _all_drivers(profile, law, tuning) if all_laws else drivers_of(profile, law)
        results = []
        runs = [(experiment, driver) for experiment in chosen for driver in drivers]
        for number, (experiment, driver) in enumerate(runs, 1):
            which_run = f"run {number} of {len(runs)}: " if len(runs) > 1 else ""
            with progress(f"{which_run}{experiment.title}, {law_name(driver)}") as step:
                how = {"tuning": tuning, "duration_s": duration_s, "on_progress": step}
                results += run_all_robots(experiment, driver, transport, **how)
        for table in metrics_tables(results):
            console.print(table)
        if out:
            into, folder = gallery(out, picture_format.value, dark), OutputFolder(out)
            written = [save_recording(result, out) for result in results]
            with progress("drawing") as step:
                for done, result in enumerate(results, 1):
                    written += [picture.file for picture in save_pictures(result, into)]
                    step(done, len(results) + 1)
                written += [picture.file for picture in save_comparison(results, into)]
                step(len(results) + 1, len(results) + 1)
            for file in written:
                folder.wrote(file)


def _all_drivers(profile: Profiles, law: Law, tuning: Path | None) -> list[str]:
    """The fuzzy law's profiles and every baseline; a single law, or its tuning, contradicts that."""
    if law is not Law.fuzzy:
        raise typer.BadParameter(f"--law {law.value} is one law, --all-laws is every law: give one of the two")
    if tuning is not None:
        raise typer.BadParameter("--tuning holds the parameters of one law: leave it out, or --all-laws")
    return [*drivers_of(profile, law), *BASELINES]

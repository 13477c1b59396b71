"""``pilotfish experiment``: run the source paper's experiments and show their figures."""

from __future__ import annotations

from typing import Annotated

import typer

from pilotfish.cli.console import console, friendly_errors, progress
from pilotfish.cli.options import (
    DurationOption,
    InProcessOption,
    Law,
    LawOption,
    OutOption,
    Profiles,
    ProfilesOption,
    Robot,
    RobotOption,
    TuningOption,
    drivers_of,
)


def experiment(
    which: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="line (Fig. 6), circle (Fig. 7), both; or any shipped scenario (pilotfish data scenarios), or a file.",
        ),
    ],
    profile: ProfilesOption = Profiles.both,
    law: LawOption = Law.fuzzy,
    robot: RobotOption = Robot.ideal,
    tuning: TuningOption = None,
    in_process: InProcessOption = False,
    duration_s: DurationOption = None,
    out: OutOption = None,
) -> None:
    """Run the source paper's experiments, or any other scenario, in simulation and show what came of them.

    The camera is rendered, the tags are detected, the real programs talk over a private LCM bus in lock-step.

    \b
    Examples
      pilotfish experiment line                    the table for Fig. 6
      pilotfish experiment both --out out          with recordings and pictures
      pilotfish experiment circle --in-process     without programs and bus
      pilotfish experiment line --law pid          with a baseline of the fuzzy law
      pilotfish experiment both --robot nonideal   with slip, lag, noise and camera misalignment
      pilotfish experiment chain --profile anticipate
      pilotfish experiment my_scenario.yaml
    """
    from pilotfish.cli.pictures import save_comparison, save_result
    from pilotfish.experiments import EXPERIMENTS, experiment_of, metrics_table, run_all_robots

    transport = "in-process" if in_process else "lcm"
    with friendly_errors():
        chosen = list(EXPERIMENTS.values()) if which == "both" else [experiment_of(which)]
        if robot is Robot.nonideal:
            chosen = [experiment.on_nonideal_robot() for experiment in chosen]
        results = []
        for experiment in chosen:
            for driver in drivers_of(profile, law):
                with progress(f"{experiment.title}, {driver}") as step:
                    how = {"tuning": tuning, "duration_s": duration_s, "on_progress": step}
                    results += run_all_robots(experiment, driver, transport, **how)
        console.print(metrics_table(results))
        if out:
            written = [file for result in results for file in save_result(result, out)]
            for file in [*written, *save_comparison(results, out)]:
                console.print(f"wrote {file}", soft_wrap=True)

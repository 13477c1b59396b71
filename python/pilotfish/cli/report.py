"""``pilotfish report``: recorded runs as one page of HTML."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import byte_progress, friendly_errors, warn_of_losses, working
from pilotfish.cli.outputs import output_file

if TYPE_CHECKING:
    from pilotfish.logs import Run
    from pilotfish.logs.report import ReportedRun


def report(
    runs: Annotated[
        list[Path],
        typer.Argument(
            exists=True,
            help="Black boxes (files, or folders of rings) or files of lcm-logger; several are compared.",
        ),
    ],
    out: Annotated[Path, typer.Option("--out", help="The page to write.")] = Path("report.html"),
    robot: Annotated[str | None, typer.Option(help="Whose run, if several robots are recorded; default: all.")] = None,
) -> None:
    """Sum up recorded runs on one page of HTML that needs no network: figures, tables, settings, events.

    With several runs also what differs between them: results side by side, curves in the same axes, settings key by
    key, versions of the program.

    \b
    Examples
      pilotfish report /var/lib/pilotfish --out monday.html
      pilotfish report before.lcmlog after.lcmlog --out comparison.html
      pilotfish report /var/lib/pilotfish --robot robot2 --out robot2.html
    """
    from pilotfish.logs import read_run
    from pilotfish.logs.glance import check_recorded
    from pilotfish.logs.report import report_html
    from pilotfish.whole_files import written_whole

    with friendly_errors():
        inputs = (file for path in runs for file in ([path] if path.is_file() else path.iterdir()))
        target = output_file(out, inputs)
        recordings = []
        for path in runs:
            check_recorded(path, robot)
        for path in runs:
            with byte_progress(f"reading {path.name or path}") as step:
                recordings.append(read_run(path, robot, step))
        chosen = _named(recordings)
        with working("drawing the page"):
            text = report_html(chosen)
        with written_whole(out) as partial:
            partial.write_text(text, encoding="utf-8")
        for recording in recordings:
            warn_of_losses(recording.losses)
        target.wrote(f"{len(text) / 1e6:.1f} MB")


def _named(recordings: list[Run]) -> list[ReportedRun]:
    """Every robot of every recording, with a name of its own."""
    from pilotfish.logs.report import ReportedRun

    for run in recordings:
        run.recorded_coordinators()
    labels = _labels([run.path for run in recordings])
    chosen = []
    for label, run in zip(labels, recordings, strict=True):
        for robot in run.coordinators:
            name = f"{label}: {robot.name}" if len(run.coordinators) > 1 else label
            chosen.append(ReportedRun(name, run, robot))
    return chosen


def _labels(paths: list[Path]) -> list[str]:
    """The shortest ends of the paths that differ; numbered where the same is named twice."""
    parts = [path.resolve().parts for path in paths]
    shortest = 1 if len(paths) > 1 else 2  # a ring's folder alone is often called "box"
    for length in range(shortest, max(map(len, parts)) + 1):
        labels = ["/".join(own[-length:]) for own in parts]
        if len(set(labels)) == len(labels):
            return labels
    return [f"{label} ({at + 1})" for at, label in enumerate(labels)]

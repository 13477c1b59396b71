"""``pilotfish sweep``: thousands of variants of a scenario, on all cores or a cluster."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import console, friendly_errors, progress, warn
from pilotfish.cli.default_command import DefaultCommandGroup
from pilotfish.cli.outputs import output_file, writable_folder
from pilotfish.cli.sweep_results import plot, report, sensitivity
from pilotfish.interrupts import BOUNCE_S

if TYPE_CHECKING:
    from pilotfish.sweep.campaign import Campaign
    from pilotfish.sweep.run import Summary

_RUN = "run"


class _RunByDefault(DefaultCommandGroup):
    default = _RUN


app = typer.Typer(
    cls=_RunByDefault,
    no_args_is_help=True,
    help="""Simulate thousands of variants of a scenario, on all cores or a cluster, and see what came of them.

\b
Examples
  pilotfish sweep data/sweeps/laws_over_speed.yaml --out out/laws
  pilotfish sweep plot out/laws --over speed_mps --by law --where robot=nonideal
  pilotfish sweep report out/laws --by law
  pilotfish sweep data/sweeps/robot_sensitivity.yaml --out out/robot
  pilotfish sweep sensitivity out/robot
  pilotfish sweep --describe             the format of a campaign's file

`pilotfish sweep FILE` is `pilotfish sweep run FILE`; its options: `pilotfish sweep run --help`.
""",
)

FileArgument = Annotated[
    Path, typer.Argument(metavar="FILE", exists=True, dir_okay=False, help="The campaign (see --describe).")
]


def _print_description(wanted: bool) -> None:
    if wanted:
        from pilotfish.sweep.describe import describe

        with friendly_errors():
            typer.echo(describe(), nl=False)
        raise typer.Exit


@app.command()
def run(
    file: FileArgument,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            file_okay=False,
            callback=writable_folder,
            help="Folder of the results; default: out/NAME of FILE.",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(min=0, max=1024, help="Processes on this machine; default: one for each core; 0: only this one."),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask cluster instead, as tcp://host:8786.")
    ] = None,
    check: Annotated[bool, typer.Option("--check", help="Read and check FILE, say how many runs it is, end.")] = False,
    describe: Annotated[
        bool,
        typer.Option(
            "--describe", callback=_print_description, is_eager=True, help="Print the format of FILE and end."
        ),
    ] = False,
) -> None:
    """Simulate every run of a campaign that has no result in the folder yet.

    Results are the same bit for bit, whatever the number of workers and their order. Ctrl-C keeps what is done, and
    the same command goes on there. A run that fails is a row with its reason.

    \b
    Examples
      pilotfish sweep data/sweeps/laws_over_speed.yaml --out out/laws
      pilotfish sweep run my_campaign.yaml --check     (`run` may be left out)
      pilotfish sweep my_campaign.yaml --workers 4

    \b
    On a cluster: a scheduler on one computer, and workers on those that are to
    help, with the same pilotfish[sweep] installed. Files go with the work.
      dask scheduler
      dask worker tcp://host:8786 --nworkers auto --nthreads 1
      pilotfish sweep my_campaign.yaml --scheduler tcp://host:8786
    """
    from pilotfish.sweep.campaign import load_campaign
    from pilotfish.sweep.run import run_campaign
    from pilotfish.sweep.workers import Where

    if scheduler is not None and workers is not None:
        raise typer.BadParameter(
            "--scheduler uses the cluster's workers, --workers this machine's: give one of the two"
        )
    with friendly_errors():
        campaign = load_campaign(file)
        console.print(_described(campaign), soft_wrap=True, highlight=False)
        for text in _unseen(campaign):
            warn(text)
        if check:
            return
        folder = out or Path("out") / file.stem
        where = Where(os.cpu_count() or 1 if workers is None else workers, scheduler)
        with _stopping() as stopped_by, progress(campaign.name) as step:
            summary = run_campaign(
                campaign,
                folder,
                where,
                on_started=_say_dashboard,
                on_progress=step,
                on_warning=warn,
                stopping=lambda: bool(stopped_by),
            )
        console.print(_summed_up(summary, folder), soft_wrap=True, highlight=False)
        if stopped_by and summary.done < summary.total:
            raise typer.Exit(128 + stopped_by[0])


@app.command()
def rerun(
    file: FileArgument,
    number: Annotated[int, typer.Argument(metavar="RUN", min=0, help="Its number, the column `run` of the results.")],
    out: Annotated[Path, typer.Option("--out", dir_okay=False, help="The recording to write (CSV).")] = Path("run.csv"),
) -> None:
    """Simulate one run of a campaign again, and keep all of it: for `pilotfish plot`.

    \b
    Example
      pilotfish sweep rerun data/sweeps/laws_over_speed.yaml 17 --out run.csv
      pilotfish plot run.csv
    """
    import tempfile

    from pilotfish.sweep.campaign import load_campaign
    from pilotfish.sweep.metrics import outcome
    from pilotfish.sweep.play import record

    with friendly_errors():
        target = output_file(out, [file])
        campaign = load_campaign(file)
        if number >= campaign.count:
            raise typer.BadParameter(f"{number} is not one of its runs, which are 0 to {campaign.count - 1}")
        spec = campaign.run(number)
        with tempfile.TemporaryDirectory(prefix="pilotfish-sweep-") as folder:
            campaign.documents.write_files(Path(folder))
            recording = record(campaign.job, spec, Path(folder))
        for name, value in spec.factors.items():
            console.print(f"  {name}: {value}", highlight=False)
        job = campaign.job
        result, reason = outcome(recording, job.collision_distance_m, job.lost_after_s)
        console.print(f"{result}{': ' if reason else ''}{reason}", highlight=False)
        recording.to_csv(out)
        target.wrote()


app.command()(plot)
app.command()(sensitivity)
app.command()(report)


_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def _stopping() -> Iterator[list[int]]:
    """The signal (Ctrl-C, SIGTERM, SIGHUP) that came first, once one has come. A second, no bounce, ends at once."""
    came: list[int] = []
    ends_from_s = [0.0]

    def stop(number: int, _frame: FrameType | None) -> None:
        if not came:
            came.append(number)
            ends_from_s[0] = time.monotonic() + BOUNCE_S
            warn("stopping; what is done is kept, and the same command goes on. Once more: at once")
        elif time.monotonic() > ends_from_s[0]:
            ends_from_s[0] = time.monotonic() + BOUNCE_S
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield came
        return
    heard = [number for number in _ENDING if signal.getsignal(number) is not signal.SIG_IGN]  # else: under nohup
    before = {number: signal.signal(number, stop) for number in heard}
    try:
        yield came
    except KeyboardInterrupt:
        raise typer.Exit(128 + came[0]) from None
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _say_dashboard(address: str | None) -> None:
    if address:
        console.print(f"dashboard: {address}", soft_wrap=True, highlight=False)


def _described(campaign: Campaign) -> str:
    points = len(campaign.points)
    factors = ", ".join(factor.name.rpartition(".")[2] for factor in campaign.factors)
    runs = f"{points} points of {factors}; {campaign.runs} {'run' if campaign.runs == 1 else 'runs'} each"
    return f"{campaign.name}: {campaign.count} runs of {campaign.job.duration_s:g} s ({runs})"


def _unseen(campaign: Campaign) -> list[str]:
    """What the scenario says of cameras and drawn measurements do not have."""
    if campaign.job.rendered:
        return []
    errors = ("pan_error_deg", "pan_error_rad", "tilt_error_deg", "tilt_error_rad", "focal_error")
    said = sorted({key for robot in campaign.documents.robots() for key in robot.get("camera", {}) if key in errors})
    if not said:
        return []
    return [f"drawn measurements do not have {', '.join(said)} of the scenario's camera; `observations: rendered` has"]


def _summed_up(summary: Summary, folder: Path) -> str:
    new = sum(summary.outcomes.values())
    if not new:
        return f"{folder}: {summary.done} of {summary.total} runs are done"
    how = ", ".join(f"{count} {name}" for name, count in sorted(summary.outcomes.items(), key=lambda item: -item[1]))
    pace = f"{summary.wall_s:.1f} s, {1e3 * summary.cpu_s / new:.0f} ms of processor time a run"
    return f"{folder}: {summary.done} of {summary.total} runs done, {new} now ({how}) in {pace}"

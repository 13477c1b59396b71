"""``pilotfish sweep``: thousands of variants of a scenario, on all cores or a cluster."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated, Any

import typer
import typer.core

from pilotfish.cli.console import console, friendly_errors, progress, warn
from pilotfish.cli.options import writable_folder
from pilotfish.cli.sweep_results import plot, report, sensitivity

if TYPE_CHECKING:
    from pilotfish.sweep.campaign import Campaign
    from pilotfish.sweep.run import Summary

INTERRUPTED = 130  # 128 + SIGINT, as a shell says it
_RUN = "run"


class _RunByDefault(typer.core.TyperGroup):
    """``pilotfish sweep FILE`` is ``pilotfish sweep run FILE``."""

    def with_default(self, args: list[str]) -> list[str]:
        """With ``run`` in front of what is no subcommand."""
        return args if not args or args[0] in self.commands else [_RUN, *args]

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As click's, with the default."""
        asks = bool(args) and args[0] in ctx.help_option_names
        return super().parse_args(ctx, args if asks else self.with_default(args))


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

FileArgument = Annotated[Path, typer.Argument(metavar="FILE", help="The campaign (see --describe).")]


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
        with _stopping() as stop, progress(campaign.name) as step:
            summary = run_campaign(
                campaign,
                folder,
                where,
                on_started=_say_dashboard,
                on_progress=step,
                on_warning=warn,
                stopping=stop.is_set,
            )
        console.print(_summed_up(summary, folder), soft_wrap=True, highlight=False)
        if stop.is_set() and summary.done < summary.total:
            raise typer.Exit(INTERRUPTED)


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

    from pilotfish.cli.console import check_writable
    from pilotfish.sweep.campaign import load_campaign
    from pilotfish.sweep.metrics import outcome
    from pilotfish.sweep.play import record

    with friendly_errors():
        check_writable(out)
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
        console.print(f"wrote {recording.to_csv(out)}", soft_wrap=True)


app.command()(plot)
app.command()(sensitivity)
app.command()(report)


@contextmanager
def _stopping() -> Iterator[threading.Event]:
    """Set by the first Ctrl-C or SIGTERM; the second ends at once."""
    event = threading.Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        if event.is_set():
            raise KeyboardInterrupt
        event.set()
        warn("stopping; what is done is kept, and the same command goes on. Once more: at once")

    if threading.current_thread() is not threading.main_thread():
        yield event
        return
    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield event
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

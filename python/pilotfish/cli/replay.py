"""``pilotfish replay``: what a coordinator recorded of itself, computed again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from pilotfish.cli.console import byte_progress, console, friendly_errors, warn
from pilotfish.errors import ConfigError, RecordingError

if TYPE_CHECKING:
    from pilotfish.black_box import ReplayReport


def replay(
    log: Annotated[Path, typer.Argument(exists=True, help="A file of a black box, or the folder of its ring.")],
    must_agree: Annotated[
        bool, typer.Option("--assert", help="End with 1 if a bit differs, or if there was nothing to compare.")
    ] = False,
    from_pixels: Annotated[
        bool,
        typer.Option(
            "--from-pixels", help="Look at the recorded pictures again, too: JPEG as it came, and raw (--record-raw)."
        ),
    ] = False,
    robot: Annotated[str | None, typer.Option(help="Whose, if several robots recorded into the folder.")] = None,
) -> None:
    """Recompute every command of a recorded run from what the coordinator was given, and compare it bit for bit.

    Needs the program that recorded, on the same kind of processor; nothing is sent anywhere.

    \b
    Examples
      pilotfish replay /var/lib/pilotfish --assert
      pilotfish replay robot1-1764000000000000-12.lcmlog --from-pixels
    """
    from pilotfish import blackbox
    from pilotfish.black_box import replay as compute
    from pilotfish.black_box.log import files_in
    from pilotfish.logs.sources import events_of, size_of

    with friendly_errors():
        files = files_in(log, robot)
        _check_recorded(log, files)
        try:
            with byte_progress("replaying") as step:
                events = events_of(files, 0, size_of(files), step)
                report = compute(events, from_pixels=from_pixels)
        except RecordingError:
            raise
        except ValueError as error:  # of the bindings; the recorded configuration is not one of this program
            raise ConfigError(f"{log}: {error}") from error
        console.print(_table(report, from_pixels))
        for damage in report.damage:
            where = "it ends in the middle of an event" if damage.at_end else f"at byte {damage.offset}"
            warn(f"{damage.file}: {damage.size} bytes that are no events, {where}")
        for program in report.programs:
            if program != blackbox.program_description():
                warn(f"recorded by '{program}', replayed by '{blackbox.program_description()}': bits may differ")
        _show_first(report)
        unseen = from_pixels and not report.observations
        if unseen:
            warn(
                "no picture could be looked at again: only those that come as JPEG, or are recorded raw "
                "(--record-raw), are what was seen"
            )
    if must_agree and (report.differences or not report.commands or unseen):
        raise typer.Exit(1)


def _check_recorded(log: Path, files: list[Path]) -> None:
    """RecordingError if there is no event in the files at all."""
    from pilotfish.black_box.log import Event
    from pilotfish.logs.sources import events_of

    if not any(isinstance(event, Event) for event in events_of(files, 0, 0, None)):
        raise RecordingError(f"{log}: no event of LCM in it: not a file of a black box")


def _table(report: ReplayReport, from_pixels: bool) -> Table:
    table = Table(show_header=False)
    rows = {
        "frames": report.frames,
        "measured": report.measured,
        "commands of frames compared": report.commands,
        "commands sent compared": report.sent,
        "calls of the core, all kinds": report.calls,
        "starting points": report.starts,
        "memories compared at later ones": report.memories,
        "gaps": report.gaps,
        "calls behind a gap, not compared": report.skipped,
        "damaged places, unreadable events": f"{len(report.damage)}, {report.unreadable}",
    }
    if from_pixels:
        rows["frames seen again, compared"] = report.observations
        rows["frames without their picture"] = report.observations_unchecked
    rows["differences"] = report.differences
    for name, value in rows.items():
        table.add_row(name, str(value))
    return table


def _agreement(report: ReplayReport) -> str:
    if not report.commands:
        return "nothing to compare: no start, or no frame behind one"
    if not report.skipped:
        return "every bit agrees"
    gaps = f"{report.gaps} gap{'s' if report.gaps > 1 else ''}"
    return f"every bit agrees of what was compared; {report.skipped} calls behind {gaps} were not"


def _show_first(report: ReplayReport) -> None:
    first = report.first_difference
    if first is None:
        console.print(_agreement(report))
        return
    console.print(f"first difference: {first.what}", markup=False)
    console.print(f"  where       {first.event.file}, byte {first.event.offset}", soft_wrap=True, markup=False)
    for at, cause in enumerate(first.causes):
        console.print(f"  {'differs' if at == 0 else '':<10}  {cause}", soft_wrap=True, markup=False)
    if first.agreed_before:
        agreed = f"{first.agreed_before} calls before it, since the last starting point, agree in every bit"
        console.print(f"  before      {agreed}", soft_wrap=True, markup=False)
    elif first.what in ("the command", "what is held"):
        console.print("  before      nothing: it is the first call behind a starting point", markup=False)
    console.print(f"  inputs      {first.inputs}", soft_wrap=True, markup=False)
    console.print(f"  recorded    {first.recorded}", soft_wrap=True, markup=False)
    console.print(f"  recomputed  {first.recomputed}", soft_wrap=True, markup=False)

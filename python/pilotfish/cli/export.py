"""``pilotfish export``: a recorded run in other formats."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import OnProgress, byte_progress, friendly_errors, warn_of_losses
from pilotfish.cli.outputs import output_file

if TYPE_CHECKING:
    from pilotfish.logs.notes import RunNotes


class ExportFormat(str, Enum):
    """What a run can be written as."""

    mcap = "mcap"
    csv = "csv"
    parquet = "parquet"
    mp4 = "mp4"
    rrd = "rrd"


class TableName(str, Enum):
    """The tables of a run; see docs/recordings.md."""

    frames = "frames"
    tags = "tags"
    commands = "commands"
    wheels = "wheels"
    poses = "poses"
    odometry = "odometry"
    intents = "intents"
    events = "events"


def export(
    log: Annotated[
        Path,
        typer.Argument(exists=True, help="A black box (a file, or the folder of its ring) or a file of lcm-logger."),
    ],
    out: Annotated[Path, typer.Option("--out", help="The file to write.")],
    to: Annotated[
        ExportFormat | None,
        typer.Option("--to", "--format", help="The format; default: what the suffix of --out says."),
    ] = None,
    robot: Annotated[str | None, typer.Option(help="Only this robot's; default: all (MP4 shows one camera).")] = None,
    table: Annotated[
        TableName, typer.Option("--table", help="For CSV and Parquet, which are one table a file.")
    ] = TableName.frames,
    images: Annotated[
        bool, typer.Option("--images/--no-images", help="For MCAP and RRD: with the images, or without.")
    ] = True,
    overlay: Annotated[
        bool, typer.Option("--overlay/--no-overlay", help="For MP4: with tags, distance, bearing and status drawn.")
    ] = True,
) -> None:
    """Write a recorded run as MCAP (Foxglove), RRD (Rerun), CSV, Parquet or MP4.

    Numbers come back bit for bit. Hours of a recording need no more memory than minutes (MP4: some 100 MB an hour).
    MCAP, Parquet and MP4 need: pip install 'pilotfish\\[export]'; RRD needs: pip install 'pilotfish\\[rerun]'

    \b
    Examples
      pilotfish export /var/lib/pilotfish --to mcap --out run.mcap
      pilotfish export robot1-1764000000000000-12.lcmlog --out run.parquet
      pilotfish export run.lcmlog --to csv --table commands --out commands.csv
      pilotfish export run.lcmlog --to rrd --out run.rrd     then: rerun run.rrd
      pilotfish export run.lcmlog --to mp4 --robot robot1 --out run.mp4
    """
    from pilotfish.logs.notes import RunNotes

    with friendly_errors():
        kind = _kind(to, out)
        _check_options(kind, table, images, overlay)
        target = output_file(out, _files_of(log))
        notes = RunNotes()
        with byte_progress("exporting") as step:
            if kind is ExportFormat.mp4:
                count = _export_mp4(log, out, robot, overlay, step, notes)
            else:
                count = _export(kind, log, out, robot, table.value, images, step, notes)
        warn_of_losses(notes.loss_texts)
        what = {"csv": "rows", "parquet": "rows", "mcap": "messages", "mp4": "frames", "rrd": "frames and images"}[
            kind.value
        ]
        target.wrote(f"{count} {what}")


def _kind(to: ExportFormat | None, out: Path) -> ExportFormat:
    if to is not None:
        return to
    try:
        return ExportFormat(out.suffix.removeprefix(".").lower())
    except ValueError:
        formats = ", ".join(one.value for one in ExportFormat)
        raise typer.BadParameter(f"--out {out}: its suffix is no format ({formats}); say it with --to") from None


def _check_options(kind: ExportFormat, table: TableName, images: bool, overlay: bool) -> None:
    """Options that would be ignored are refused."""
    ignored = {
        f"--table {table.value}": table is not TableName.frames
        and kind not in (ExportFormat.csv, ExportFormat.parquet),
        "--no-images": not images and kind not in (ExportFormat.mcap, ExportFormat.rrd),
        "--no-overlay": not overlay and kind is not ExportFormat.mp4,
    }
    for option, is_ignored in ignored.items():
        if is_ignored:
            raise typer.BadParameter(f"{option} means nothing to {kind.value}: leave it out, or choose another --to")


def _files_of(log: Path) -> list[Path]:
    return [log] if log.is_file() else [path for path in log.iterdir() if path.is_file()]


def _export(
    kind: ExportFormat,
    log: Path,
    out: Path,
    robot: str | None,
    table: str,
    images: bool,
    step: OnProgress,
    notes: RunNotes,
) -> int:
    if kind is ExportFormat.mcap:
        from pilotfish.logs.export.to_mcap import export_mcap

        return export_mcap(log, out, robot=robot, images=images, on_progress=step, notes=notes)
    if kind is ExportFormat.rrd:
        from pilotfish.logs.export.to_rrd import export_rrd

        return export_rrd(log, out, robot=robot, images=images, on_progress=step, notes=notes)
    if kind is ExportFormat.parquet:
        from pilotfish.logs.export.to_parquet import export_parquet

        return export_parquet(log, out, table=table, robot=robot, on_progress=step, notes=notes)
    from pilotfish.logs.export.to_csv import export_csv

    return export_csv(log, out, table=table, robot=robot, on_progress=step, notes=notes)


def _export_mp4(log: Path, out: Path, robot: str | None, overlay: bool, step: OnProgress, notes: RunNotes) -> int:
    from pilotfish.logs.export.to_mp4 import export_mp4

    return export_mp4(log, out, robot=robot, overlay=overlay, on_progress=step, notes=notes)

"""A recording read at once: numbers only, images stay in the file."""

from __future__ import annotations

from pathlib import Path

from pilotfish.logs.columns import TABLES
from pilotfish.logs.growing import GrowingTable
from pilotfish.logs.notes import RobotNotes, RunNotes
from pilotfish.logs.rows import rows_in
from pilotfish.logs.run import RobotRun, Run, RunEvent
from pilotfish.logs.sources import OnProgress


def read_run(
    path: str | Path,
    robot: str | None = None,
    on_progress: OnProgress | None = None,
    notes: RunNotes | None = None,
) -> Run:
    """A black box (a file, or the folder of its ring) or a file of lcm-logger, as far as it is not damaged.

    Some 100 MB an hour of 30 frames a second; images are not kept (see images.images_in). ``on_progress`` gets the
    bytes read and the bytes in all, ``notes`` is filled. MissingFileError, RecordingError.
    """
    notes = RunNotes() if notes is None else notes
    growing: dict[str, dict[str, GrowingTable]] = {}
    for row in rows_in(path, robot, notes, on_progress):
        if row.robot not in growing:
            growing[row.robot] = {name: GrowingTable(columns) for name, columns in TABLES.items()}
        growing[row.robot][row.table].append(row.values)
    nobodys = notes.nobodys()
    robots = [_robot(tables, notes.of(name)) for name, tables in growing.items() if name not in nobodys]
    robots.sort(key=lambda one: (not len(one.frames), one.name))
    return Run(
        path=Path(path),
        robots={one.name: one for one in robots},
        channels=dict(notes.events),
        cameras=dict(notes.cameras),
        damage=tuple(loss.damage for loss in notes.losses),
        unreadable=notes.unreadable,
        losses=tuple(notes.loss_texts),
    )


def _robot(growing: dict[str, GrowingTable], notes: RobotNotes) -> RobotRun:
    tables = {name: table.table() for name, table in growing.items()}
    events = tables.pop("events")
    happened = zip(events["t_s"].tolist(), events["kind"], events["text"], strict=True)
    return RobotRun(
        name=notes.name,
        **tables,
        events=tuple(sorted((RunEvent(*one) for one in happened), key=lambda event: event.t_s)),
        settings=tuple(notes.settings),
        sessions=tuple(notes.sessions),
        simulated=notes.simulated,
        counters=dict(sorted(notes.counters.items())),
        stages=dict(notes.stages),
    )

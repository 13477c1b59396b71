"""The rows of one table, for formats that are one table a file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pilotfish.errors import RecordingError
from pilotfish.logs.columns import NONE, TABLES, Column
from pilotfish.logs.notes import RunNotes
from pilotfish.logs.rows import Row, rows_in
from pilotfish.logs.sources import OnProgress

ROBOT = Column("robot", "text", "", "whose row this is")


def columns_of(table: str) -> tuple[Column, ...]:
    """With the robot's name in front."""
    return (ROBOT, *TABLES[table])


def table_rows(
    path: Path, table: str, robot: str | None, notes: RunNotes, on_progress: OnProgress | None
) -> Iterator[Row]:
    """RecordingError at the end if there was none."""
    counts = dict.fromkeys(TABLES, 0)
    for row in rows_in(path, robot, notes, on_progress):
        counts[row.table] += 1
        if row.table == table:
            yield row
    if not counts[table]:
        there = ", ".join(f"{name} ({count})" for name, count in counts.items() if count) or "none"
        raise RecordingError(f"{path}: no row of table '{table}'; tables with rows: {there}")


def cell(column: Column, row: Row) -> Any:
    """What stands in a column: a number, a bool, a text; None if it is not known."""
    if column is ROBOT:
        return row.robot
    value = row.values.get(column.name)
    if value is None or value != value or (column.kind in ("int", "word") and value == NONE):
        return None
    if column.kind == "word":
        return column.word(value)
    return bool(value) if column.kind == "bool" else value

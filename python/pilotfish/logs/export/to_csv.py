"""CSV: one line a row, floats with as many digits as give the same bits back, nothing where nothing is known."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from pilotfish.logs.export.table_rows import cell, columns_of, table_rows
from pilotfish.logs.notes import RunNotes
from pilotfish.logs.sources import OnProgress
from pilotfish.whole_files import written_whole


def export_csv(
    path: Path,
    out: Path,
    *,
    table: str = "frames",
    robot: str | None = None,
    on_progress: OnProgress | None = None,
    notes: RunNotes | None = None,
) -> int:
    """Writes one table; the number of its rows. RecordingError, MissingFileError, OSError."""
    columns, count = columns_of(table), 0
    with written_whole(out) as partial, partial.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([column.name for column in columns])
        for row in table_rows(path, table, robot, notes or RunNotes(), on_progress):
            writer.writerow([_text(cell(column, row)) for column in columns])
            count += 1
    return count


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    return repr(value) if isinstance(value, float) else str(value)

"""Parquet: one table, with the unit and the meaning of every column in its metadata, and the settings in the file's."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pilotfish.extras import require
from pilotfish.logs.columns import Column
from pilotfish.logs.export.table_rows import cell, columns_of, table_rows
from pilotfish.logs.notes import RunNotes
from pilotfish.logs.sources import OnProgress
from pilotfish.whole_files import written_whole

ROWS_PER_GROUP = 20_000


def export_parquet(
    path: Path,
    out: Path,
    *,
    table: str = "frames",
    robot: str | None = None,
    on_progress: OnProgress | None = None,
    notes: RunNotes | None = None,
) -> int:
    """Writes one table; the number of its rows. RecordingError, MissingFileError, MissingPackageError, OSError."""
    pa, parquet = require("pyarrow", "export"), require("pyarrow.parquet", "export")
    columns, notes, count = columns_of(table), notes or RunNotes(), 0
    schema = pa.schema([_field(pa, column) for column in columns], metadata={"pilotfish.table": table})
    with (
        written_whole(out) as partial,
        partial.open("wb") as stream,
        parquet.ParquetWriter(stream, schema, compression="zstd") as writer,
    ):
        cells: list[list[Any]] = [[] for _ in columns]
        for row in table_rows(path, table, robot, notes, on_progress):
            for column, values in zip(columns, cells, strict=True):
                values.append(cell(column, row))
            count += 1
            if count % ROWS_PER_GROUP == 0:
                _write(pa, writer, schema, cells)
        if cells[0]:
            _write(pa, writer, schema, cells)
        writer.add_key_value_metadata({"pilotfish.settings": _settings(notes)})
    return count


def _field(pa: Any, column: Column) -> Any:
    types = {"float": pa.float64(), "int": pa.int64(), "bool": pa.bool_(), "word": pa.string(), "text": pa.string()}
    return pa.field(column.name, types[column.kind], metadata={"unit": column.unit, "description": column.text})


def _write(pa: Any, writer: Any, schema: Any, cells: list[list[Any]]) -> None:
    writer.write_batch(
        pa.record_batch([pa.array(v, f.type) for v, f in zip(cells, schema, strict=True)], schema=schema)
    )
    for values in cells:
        values.clear()


def _settings(notes: RunNotes) -> str:
    """By robot: what each start has said."""
    return json.dumps({name: [asdict(one) for one in robot.settings] for name, robot in notes.robots.items()})

"""Numbers of a table as scalars of Rerun, some hundred rows at a time: row by row would take a second for ten seconds
of a recording."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pilotfish.logs.columns import Column

ROWS_AT_ONCE = 512


class ScalarColumns:
    """Collects rows of one entity and sends each number as its own series, what is not known left out."""

    def __init__(self, rr: Any, stream: Any, entity: str, columns: tuple[Column, ...], timeline: str) -> None:
        self._rr, self._stream, self._entity, self._timeline = rr, stream, entity, timeline
        self._columns = [column for column in columns if column.kind == "float" and column.name != "t_s"]
        self._utime: list[int] = []
        self._rows: list[list[float]] = []

    def add(self, utime: int, values: dict[str, Any]) -> None:
        """A row for the stamp ``utime`` [us]."""
        self._utime.append(utime)
        self._rows.append([float(values.get(column.name, math.nan)) for column in self._columns])
        if len(self._rows) >= ROWS_AT_ONCE:
            self.send()

    def send(self) -> None:
        """Writes what was collected."""
        if not self._rows:
            return
        utime, table = np.array(self._utime, "datetime64[us]"), np.array(self._rows)
        for column, values in zip(self._columns, table.T, strict=True):
            known = np.isfinite(values)
            if known.any():
                times = self._rr.TimeColumn(self._timeline, timestamp=utime[known])
                scalars = self._rr.Scalars.columns(scalars=values[known])
                self._stream.send_columns(f"{self._entity}/{column.name}", [times], scalars)
        self._utime, self._rows = [], []

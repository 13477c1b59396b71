"""Columns that grow row by row, eight bytes a number."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np

from pilotfish.logs.columns import Column
from pilotfish.logs.run import Table

_CODES = {"float": "d", "int": "q", "bool": "b", "word": "h"}
_DTYPES = {"float": np.float64, "int": np.int64, "bool": np.bool_, "word": np.int16, "text": object}


class GrowingTable:
    """``append`` rows, then ``table``."""

    def __init__(self, columns: tuple[Column, ...]) -> None:
        self.columns = columns
        self._cells: list[tuple[str, Any, Any]] = [
            (column.name, column.missing, array(_CODES[column.kind]) if column.kind in _CODES else [])
            for column in columns
        ]

    def append(self, values: dict[str, Any]) -> None:
        """What is not in ``values`` is not known."""
        for name, missing, cells in self._cells:
            cells.append(values.get(name, missing))

    def table(self) -> Table:
        """The same memory, as NumPy arrays."""
        arrays = {}
        for column, (name, _, cells) in zip(self.columns, self._cells, strict=True):
            dtype = _DTYPES[column.kind]
            if column.kind == "bool":
                arrays[name] = np.frombuffer(cells, dtype=np.int8).astype(bool) if cells else np.zeros(0, bool)
            elif column.kind == "text":
                arrays[name] = np.array(cells, dtype=object)
            else:
                arrays[name] = np.frombuffer(cells, dtype=dtype) if cells else np.zeros(0, dtype)
        return Table(self.columns, arrays)

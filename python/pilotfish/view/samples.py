"""A minute of samples for strip charts and paths, ten a second; a gap in time is one row without values."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

SPAN_S = 60.0
PERIOD_S = 0.1
_GAP_S = 0.5
COLUMNS = (
    *("time_s", "distance_error_mm", "bearing_error_deg", "linear_mps", "angular_radps", "latency_ms"),
    *("x_m", "y_m", "heading_rad", "leader_x_m", "leader_y_m", "range_m"),
)
Row = tuple[float | None, ...]


class Samples:
    """Rows by number: a page says which it has, and gets those behind."""

    def __init__(self) -> None:
        self._rows: deque[Row] = deque()
        self._next = 0  # number of the next row

    def due(self, time_s: float) -> bool:
        """Whether a sample of this time is wanted."""
        last = self._rows[-1][0] if self._rows else None
        return last is None or time_s - last >= PERIOD_S

    def add(self, time_s: float, values: Sequence[float | None]) -> None:
        """A row of COLUMNS, the time first."""
        last = self._rows[-1][0] if self._rows else None
        if last is not None and time_s - last > _GAP_S:
            self._append((last + PERIOD_S, *([None] * (len(COLUMNS) - 1))))
        self._append((time_s, *values))
        while self._rows and time_s - (self._rows[0][0] or 0.0) > SPAN_S:
            self._rows.popleft()

    def since(self, number: int) -> tuple[int, list[Row]]:
        """(number of the next row, rows from `number` on that are still there)."""
        missing = min(max(self._next - number, 0), len(self._rows))
        return self._next, [self._rows[k] for k in range(len(self._rows) - missing, len(self._rows))]

    def _append(self, row: Row) -> None:
        self._rows.append(row)
        self._next += 1

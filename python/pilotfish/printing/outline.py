"""The outline of black cells, as polygons.

Cells that were drawn one by one would show hairlines between neighbours on screens, and printers would make each of
them a little larger than it is. One path with the even-odd rule has neither.
"""

from __future__ import annotations

import numpy as np


def outline(black: np.ndarray) -> tuple[np.ndarray, ...]:
    """Closed polygons (N, 2) along the border between black and white, in cells from the top left corner, x right, y
    down. black: (rows, columns) bool; outside is white. Under the even-odd rule their inside is what is black.

    Every black cell has four directed sides, clockwise. Where two black cells meet, two of them cancel out; the others
    form closed loops.
    """
    sides: set[tuple[tuple[int, int], tuple[int, int]]] = set()
    for row, column in np.argwhere(black).tolist():
        corners = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)]
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
            if (end, start) in sides:
                sides.remove((end, start))
            else:
                sides.add((start, end))
    leaving: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for start, end in sorted(sides):
        leaving.setdefault(start, []).append(end)
    loops = []
    while leaving:
        first = next(iter(leaving))
        loop, at = [], first
        while True:
            loop.append(at)
            ends = leaving[at]
            following = ends.pop()
            if not ends:
                del leaving[at]
            at = following
            if at == first:
                break
        loops.append(_without_straight_points(np.array(loop, dtype=float)))
    return tuple(loops)


def _without_straight_points(loop: np.ndarray) -> np.ndarray:
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    return loop[before[:, 0] * after[:, 1] != before[:, 1] * after[:, 0]]

"""Proved bounds of u over the cells of a grid, and the greatest over any box by table look-up.

Proofs about following ask for sup u over many boxes of inputs. The grid's cells are bounded once; then a range
maximum (a sparse table of windows of 2^a x 2^b cells) answers for any box by the cells that it touches, which is an
upper bound for the box.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.fuzzy_proof.boxes import Boxes
from pilotfish.fuzzy_proof.branch import OnShare
from pilotfish.fuzzy_proof.enclosure import Encloser
from pilotfish.fuzzy_proof.interval import FloatArray, Interval

CELLS = (400, 100)  # along e and ec
_ROWS_AT_ONCE = 40


@dataclass(frozen=True)
class Grid:
    """Closed cells and ``upper``, a proved bound of u in each, shape (cells of e, cells of ec)."""

    e: FloatArray  # edges
    ec: FloatArray
    upper: FloatArray


def bound_cells(encloser: Encloser, cells: tuple[int, int] = CELLS, on_share: OnShare | None = None) -> Grid:
    """Bounds of every cell: the hull over the pieces that the cell touches."""
    every = encloser.boxes
    edges = [np.linspace(x.lo.min(), x.hi.max(), n + 1) for x, n in zip((every.e, every.ec), cells, strict=True)]
    first_e, last_e = _touched(edges[0], every.e)
    first_ec, last_ec = _touched(edges[1], every.ec)
    upper = np.full(cells, -np.inf)
    for begin in range(0, cells[0], _ROWS_AT_ONCE):
        end = min(begin + _ROWS_AT_ONCE, cells[0])
        low, high = np.maximum(first_e, begin), np.minimum(last_e, end - 1)
        piece, i, j = _pairs(low, high, first_ec, last_ec)
        boxes = Boxes(
            piece,
            every.e[piece].meet(Interval(edges[0][i], edges[0][i + 1])),
            every.ec[piece].meet(Interval(edges[1][j], edges[1][j + 1])),
        )
        touching = encloser.touches(boxes)
        boxes, i, j = boxes[touching], i[touching], j[touching]
        np.maximum.at(upper, (i, j), encloser.bounds(boxes).u.hi)
        if on_share:
            on_share(end / cells[0])
    return Grid(edges[0], edges[1], upper)


def _touched(edges: FloatArray, x: Interval) -> tuple[np.ndarray, np.ndarray]:
    """First and last closed cell that has a point of each interval."""
    first = np.searchsorted(edges[1:], x.lo, side="left")
    last = np.searchsorted(edges[:-1], x.hi, side="right") - 1
    return np.clip(first, 0, len(edges) - 2), np.clip(last, 0, len(edges) - 2)


def _pairs(low: np.ndarray, high: np.ndarray, first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, ...]:
    """(piece, i, j) for all i from low to high and j from first to last of every piece."""
    rows = np.maximum(high - low + 1, 0)
    columns = last - first + 1
    count = rows * columns
    piece = np.repeat(np.arange(len(count)), count)
    number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return piece, low[piece] + number // columns[piece], first[piece] + number % columns[piece]


class GreatestOver:
    """sup u over boxes of inputs, from a grid."""

    def __init__(self, grid: Grid) -> None:
        self._grid = grid
        self._windows = [_doubling(rows, axis=1) for rows in _doubling(grid.upper, axis=0)]  # [a][b]

    def __call__(self, e: Interval, ec: Interval) -> FloatArray:
        """Shape (N,); inputs beyond the universes count as their ends, as the law has it."""
        grid = self._grid
        first_e, last_e = _touched(grid.e, _held(e, grid.e))
        first_ec, last_ec = _touched(grid.ec, _held(ec, grid.ec))
        level_e = np.frexp(last_e - first_e + 1)[1] - 1
        level_ec = np.frexp(last_ec - first_ec + 1)[1] - 1
        greatest = np.full(len(first_e), -np.inf)
        for a, b in {*zip(level_e.tolist(), level_ec.tolist(), strict=True)}:
            of = (level_e == a) & (level_ec == b)
            window = self._windows[a][b]
            i, j = (first_e[of], last_e[of] - 2**a + 1), (first_ec[of], last_ec[of] - 2**b + 1)
            greatest[of] = np.maximum.reduce([window[x, y] for x in i for y in j])
        return greatest


def _doubling(table: FloatArray, axis: int) -> list[FloatArray]:
    """The greatest of 1, 2, 4, ... neighbours along an axis, as long as there are so many."""
    levels, length = [table], table.shape[axis]
    while 2 ** len(levels) <= length:
        half, before = 2 ** (len(levels) - 1), levels[-1]
        count = before.shape[axis] - half
        levels.append(np.maximum(before.take(range(count), axis), before.take(range(half, half + count), axis)))
    return levels


def _held(x: Interval, edges: FloatArray) -> Interval:
    return Interval(np.clip(x.lo, edges[0], edges[-1]), np.clip(x.hi, edges[0], edges[-1]))

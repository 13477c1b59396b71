"""How far u rises along e where it should fall: the greatest violation of monotony of a continuous surface."""

from __future__ import annotations

import numpy as np

from pilotfish import fuzzy
from pilotfish.fuzzy_proof.boxes import Boxes
from pilotfish.fuzzy_proof.branch import OnShare, Optimum
from pilotfish.fuzzy_proof.enclosure import Encloser
from pilotfish.fuzzy_proof.interval import FloatArray, Interval

_COLUMNS, _CELLS = 50, 200  # of the first round: strips of ec, and cells of e in each
_ROUNDS = 5
_MAX_COLUMNS = 120  # in a round
_SAMPLES = 2001  # of e, for what is reached


def prove_greatest_rise(
    encloser: Encloser, controller: fuzzy.Controller, tolerance: float, on_share: OnShare | None = None
) -> Optimum:
    """sup of u(e2, ec) - u(e1, ec) over e1 < e2 and ec; 0 if u never rises along e. ``at``: (e2, ec) of what is
    reached.

    Only of a continuous surface: there a rise is the integral of du/de along e, so within a narrow column of ec it is
    at most the greatest sum of (sup du/de) x (width) over consecutive cells (Kadane's algorithm); where a rise begins
    or ends inside a cell, that cell counts if it is positive. Columns whose
    bound is more than ``tolerance`` and more than a tenth above what is reached are cut finer.
    """
    every = encloser.boxes
    edges = np.linspace(every.ec.lo.min(), every.ec.hi.max(), _COLUMNS + 1)
    columns, cells = Interval(edges[:-1], edges[1:]), _CELLS
    reached, at, settled, seen = 0.0, (float("nan"), float("nan")), 0.0, 0
    for round_ in range(_ROUNDS):
        found, place = _sampled(controller, columns)
        if found > reached:
            reached, at = found, place
        bound = np.empty(len(columns.lo))
        for j in range(len(bound)):
            bound[j], boxes = _column_rise(encloser, columns[j : j + 1], cells)
            seen += boxes
            if on_share:
                on_share((round_ + (j + 1) / len(bound)) / _ROUNDS)
        open_ = bound > reached + max(tolerance, 0.1 * reached)
        last = round_ == _ROUNDS - 1 or 2 * open_.sum() > _MAX_COLUMNS
        if last:
            open_[:] = False
        settled = max(settled, float(bound[~open_].max(initial=0.0)))
        if not open_.any():
            break
        middle = 0.5 * (columns.lo[open_] + columns.hi[open_])
        columns = Interval(np.concatenate([columns.lo[open_], middle]), np.concatenate([middle, columns.hi[open_]]))
        cells *= 2
    return Optimum(max(settled, reached), reached, at, seen)


def _column_rise(encloser: Encloser, column: Interval, cells: int) -> tuple[float, int]:
    """The bound for one column, and how many boxes it took."""
    every = encloser.boxes
    edges = np.linspace(every.e.lo.min(), every.e.hi.max(), cells + 1)
    touched = np.flatnonzero((every.ec.lo <= column.hi) & (every.ec.hi >= column.lo))
    first = np.searchsorted(edges[1:], every.e.lo[touched], side="left")
    last = np.searchsorted(edges[:-1], every.e.hi[touched], side="right") - 1
    count = last - first + 1
    piece = np.repeat(touched, count)
    cell = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count - first, count)
    boxes = Boxes(
        piece,
        every.e[piece].meet(Interval(edges[cell], edges[cell + 1])),
        every.ec[piece].meet(column),
    )
    touching = encloser.touches(boxes)
    steepest = np.full(cells, -np.inf)
    np.maximum.at(steepest, cell[touching], encloser.bounds(boxes[touching]).slope_e.hi)
    gains = (Interval.point(steepest) * (Interval.point(edges[1:]) - Interval.point(edges[:-1]))).hi
    return _greatest_sum(gains), int(touching.sum())


def _greatest_sum(gains: FloatArray) -> float:
    running = greatest = 0.0
    for gain in gains.tolist():
        running = max(gain, 0.0, float(np.nextafter(running + gain, np.inf)))
        greatest = max(greatest, running)
    return greatest


def _sampled(controller: fuzzy.Controller, columns: Interval) -> tuple[float, tuple[float, float]]:
    """The greatest rise on the edges of the columns, by the compiled law, and where it ends."""
    best, place = 0.0, (float("nan"), float("nan"))
    e = np.linspace(controller.error.min, controller.error.max, _SAMPLES)
    for ec in np.unique([*columns.lo, *columns.hi]).tolist():
        u = fuzzy.infer_outputs(controller, e, np.full(_SAMPLES, ec))
        rise = u - np.minimum.accumulate(u)
        i = int(np.argmax(rise))
        if rise[i] > best:
            best, place = float(rise[i]), (float(e[i]), ec)
    return best, place

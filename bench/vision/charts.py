"""The comparison as pictures: error over distance, time per frame, cost by resolution."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator, StrMethodFormatter

from bench.vision import trackers as who
from bench.vision.accuracy import Cells
from bench.vision.summary import Figures
from pilotfish.plots import style as look

# A tracker has one mark in all pictures, and its makers one colour: ours blue and thicker, ViSP's green.
_SOLID, _DASHED = "-", "--"
MARKS = {
    who.TRACKED: (look.BLUE, "o", _SOLID),
    who.ACQUIRED: (look.BLUE, "s", _DASHED),
    who.VISP_1: (look.GREEN, "^", _SOLID),
    who.VISP_2: (look.GREEN, "v", _DASHED),
    who.LIBAPRILTAG: ("#888888", "D", _SOLID),
    who.WHEEL: ("#888888", "P", _DASHED),
    who.ARUCO_SUBPIX: (look.BLACK, "x", _SOLID),
    who.ARUCO_APRILTAG: (look.BLACK, "+", _DASHED),
}


def mark(name: str) -> dict[str, object]:
    """Arguments of Axes.plot for a tracker."""
    colour, symbol, dashes = MARKS[name]
    ours = name in (who.TRACKED, who.ACQUIRED)
    width, zorder = (2.6, 3) if ours else (1.3, 2)
    line = {"color": colour, "linestyle": dashes, "linewidth": width, "zorder": zorder}
    return {**line, "marker": symbol, "markersize": 6, "label": name}


def error_over_distance(cells: Cells) -> Figure:
    """Median and 95th percentile of |distance error|, one row a frame size."""
    with look.style():
        figure = Figure(figsize=(9.6, 3.6 * len(cells)))
        grid = figure.subplots(len(cells), 2, squeeze=False, sharex=True, sharey="row")
        for row, (size, by_distance) in zip(grid, cells.items(), strict=True):
            for axes, key, text in zip(row, ("median_mm", "p95_mm"), ("median", "95th percentile"), strict=True):
                for name in next(iter(by_distance.values())):
                    distances_m = list(by_distance)
                    axes.plot(distances_m, [getattr(by_distance[d][name], key) for d in distances_m], **mark(name))
                axes.set(xscale="log", yscale="log", title=f"{text} of |distance error|, {size}")
                _plain_ticks(axes, list(by_distance))
            row[0].set_ylabel("|distance error| [mm]")
        for axes in grid[-1]:
            axes.set_xlabel("distance [m], tag of 0.16 m")
        _legend_below(figure, grid[0][0])
    return figure


def time_per_frame(cells: Cells) -> Figure:
    """Median time of detection and pose, one panel a frame size, by distance."""
    with look.style():
        figure = Figure(figsize=(9.6, 4.4))
        grid = figure.subplots(1, len(cells), squeeze=False, sharey=True)[0]
        for axes, (size, by_distance) in zip(grid, cells.items(), strict=True):
            for name in next(iter(by_distance.values())):
                axes.plot(list(by_distance), [by_distance[d][name].median_ms for d in by_distance], **mark(name))
            axes.set(xscale="log", yscale="log", title=f"time per frame, {size}", xlabel="distance [m], tag of 0.16 m")
            _plain_ticks(axes, list(by_distance))
        grid[0].set_ylabel("median, one thread [ms]")
        _legend_below(figure, grid[0])
    return figure


def cost_by_resolution(by_size: dict[str, dict[str, Figures]]) -> Figure:
    """Median time over the frame's pixels, for the same tag in pixels."""
    with look.style():
        figure = Figure(figsize=(8.4, 4.4))
        axes = figure.subplots()
        pixels = [np.prod([int(side) for side in size.split("x")]) / 1e6 for size in by_size]
        for name in next(iter(by_size.values())):
            axes.plot(pixels, [trackers[name].median_ms for trackers in by_size.values()], **mark(name))
        axes.set(xscale="log", yscale="log", title="the same tag, 60 px wide, in frames of different sizes")
        axes.xaxis.set_major_locator(FixedLocator(pixels))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticklabels(list(by_size))
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.set_ylabel("median time per frame, one thread [ms]")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _plain_ticks(axes: Axes, distances_m: list[float]) -> None:
    """The distances that were measured, and 0.1 instead of a power of ten."""
    axes.xaxis.set_major_locator(FixedLocator(distances_m))
    axes.xaxis.set_minor_locator(NullLocator())
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))


def _legend_below(figure: Figure, axes: Axes) -> None:
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=4)


def save_charts(folder: Path, cells: Cells | None, by_size: dict[str, dict[str, Figures]] | None) -> list[Path]:
    """Writes what there is to draw; returns where."""
    drawn = {}
    if cells:
        drawn["error_over_distance.png"] = error_over_distance(cells)
        drawn["time_per_frame.png"] = time_per_frame(cells)
    if by_size:
        drawn["cost_by_resolution.png"] = cost_by_resolution(by_size)
    return [look.save(figure, folder / name) for name, figure in drawn.items()]

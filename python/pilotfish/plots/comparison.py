"""Several laws in the same experiment, on one axis: the source paper's Figs. 6 and 7 for more than one law."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.plots.traces import (
    Runs,
    draw_bearings_on,
    draw_errors_on,
    draw_rms_on,
    draw_speeds_on,
    draw_turn_rates_on,
)

_PANELS = (draw_errors_on, draw_rms_on, draw_bearings_on, draw_speeds_on, draw_turn_rates_on)


def draw_comparison(experiments: Mapping[str, Runs], theme: Theme = LIGHT) -> Figure:
    """One column an experiment (its title is the key): e(t) in metres, its RMS in millimetres on a logarithmic axis,
    the bearing error and the command."""
    with style(theme):
        figure = Figure(figsize=(5.6 * len(experiments), 9.6))
        shape = (len(_PANELS), len(experiments))
        grid = figure.subplots(*shape, squeeze=False, sharex="col", height_ratios=(3, 3, 2, 2, 2))
        for column, (title, runs) in zip(grid.T, experiments.items(), strict=True):
            column[0].set_title(title)
            for axes, draw in zip(column, _PANELS, strict=True):
                draw(axes, runs, theme)
            column[-1].set_xlabel("time [s]")
        for row in grid[:2]:  # distance errors are compared between experiments as well
            for axes in row[1:]:
                axes.sharey(row[0])
            row[0].autoscale_view()
        figure.align_ylabels()
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), handlelength=3.5)
    return figure

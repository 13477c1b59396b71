"""Several laws in the same experiment, on one axis: the source paper's Figs. 6 and 7 for more than one law."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pilotfish.plots.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SETPOINT, SKY, VERMILLION, style
from pilotfish.recording import Recording

_COLOURS = {"paper": BLUE, "anticipate": VERMILLION, "pbvs": GREEN, "pid": PURPLE}
_OTHERS = (ORANGE, SKY, BLACK)
ZOOM_MM = (-60.0, 30.0)

Runs = Mapping[str, Recording]  # by the name of the law


def draw_comparison(experiments: Mapping[str, Runs]) -> Figure:
    """One column an experiment (its title is the key): e(t), the same magnified, the bearing error."""
    with style():
        figure = Figure(figsize=(6.6 * len(experiments), 8.4))
        columns = figure.subplots(3, len(experiments), squeeze=False, sharex="col", height_ratios=(3, 3, 2)).T
        for (whole, zoom, bearing), (title, runs) in zip(columns, experiments.items(), strict=True):
            draw_errors_on(whole, runs)
            whole.set_title(title)
            whole.set_ylabel("distance error e [m]")
            draw_errors_on(zoom, runs, scale=1000.0)
            zoom.set_ylim(*ZOOM_MM)
            zoom.set_ylabel("the same, magnified [mm]")
            _draw_bearing_on(bearing, runs)
            bearing.set_xlabel("time [s]")
        handles, labels = columns[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def draw_errors_on(axes: Axes, runs: Runs, scale: float = 1.0) -> None:
    """e(t) of every law, times `scale`."""
    axes.axhline(0.0, color=SETPOINT, linewidth=0.8)
    for (name, run), colour in _coloured(runs):
        axes.plot(run.time_s - run.time_s[0], scale * run.distance_error_m, color=colour, label=name)
    _limit_time(axes, runs)


def _draw_bearing_on(axes: Axes, runs: Runs) -> None:
    axes.axhline(0.0, color=SETPOINT, linewidth=0.8)
    for (name, run), colour in _coloured(runs):
        axes.plot(run.time_s - run.time_s[0], np.degrees(run.bearing_error_rad), color=colour, label=name)
    axes.set_ylabel("bearing error [°]")
    _limit_time(axes, runs)


def _coloured(runs: Runs) -> list[tuple[tuple[str, Recording], str]]:
    spare = iter(_OTHERS * len(runs))
    return [((name, run), _COLOURS[name] if name in _COLOURS else next(spare)) for name, run in runs.items()]


def _limit_time(axes: Axes, runs: Runs) -> None:
    axes.set_xlim(0.0, max(run.time_s[-1] - run.time_s[0] for run in runs.values()))

"""Where the leader was, seen from above, in the base frame of the robot that follows it: forward is up."""

from __future__ import annotations

from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pilotfish.logs.run import RobotRun
from pilotfish.logs.unseen import never_measured
from pilotfish.plots.run_lines import run_lines
from pilotfish.plots.run_overview import Runs
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.recording import FloatArray

_ARROW_M = 0.12
_LINE_LETTERS = 56


def draw_relative_view(runs: Runs, title: str = "", theme: Theme = LIGHT) -> Figure:
    """The path of the leader's base, where it was to be kept, and which way it faced at the end."""
    with style(theme):
        figure = Figure(figsize=(6.4, 6.4))
        axes = figure.subplots()
        axes.plot(0, 0, marker=(3, 0, 0), markersize=14, color=theme.ink, linestyle="none", label="the robot")
        for (name, run), line in zip(runs.items(), run_lines(runs, theme).values(), strict=True):
            _draw_leader(axes, run, line, f"the leader, {name}" if len(runs) > 1 else "the leader")
        unseen = [text for run in runs.values() if (text := never_measured(run))]
        if len(unseen) < len(runs):
            axes.plot([], [], "o", color=theme.ink, markerfacecolor="none", label="start")
            axes.plot([], [], "s", color=theme.ink, label="end, and its heading")
        else:
            words = "\n".join("\n".join(wrap(text, _LINE_LETTERS)) for text in dict.fromkeys(unseen))
            axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", va="center", fontsize=10)
        axes.plot([], [], "+", color=theme.ink, markersize=10, label="setpoint")
        axes.set_xlabel("to the right [m]")
        axes.set_ylabel("forward [m]")
        axes.set_aspect("equal", adjustable="datalim")
        figure.legend(loc="outside lower center", ncols=3, fontsize=9)
        if title:
            axes.set_title(title)
    return figure


def _draw_leader(axes: Axes, run: RobotRun, line: dict[str, object], label: str) -> None:
    frames, colour = run.frames, str(line["color"])
    right_m, forward_m = _from_above(frames["distance_m"], frames["bearing_rad"])
    step = max(1, len(right_m) // 5000)
    seen = np.flatnonzero(np.isfinite(right_m))
    if seen.size:
        axes.plot(right_m[::step], forward_m[::step], **line, label=label)
    setpoints = np.unique(np.stack([frames["setpoint_distance_m"], frames["setpoint_bearing_rad"]], 1), axis=0)
    setpoints = setpoints[np.isfinite(setpoints).all(axis=1)]
    axes.plot(*_from_above(*setpoints.T), "+", color=colour, markersize=12, markeredgewidth=2)
    if not seen.size:
        return
    first, last = seen[0], seen[-1]
    axes.plot(right_m[first], forward_m[first], "o", color=colour, markerfacecolor="none", markersize=8)
    axes.plot(right_m[last], forward_m[last], "s", color=colour, markersize=6)
    heading_rad = frames["heading_rad"][last]
    tip = (right_m[last] - _ARROW_M * np.sin(heading_rad), forward_m[last] + _ARROW_M * np.cos(heading_rad))
    axes.plot([right_m[last], tip[0]], [forward_m[last], tip[1]], color=colour, linewidth=2)


def _from_above(distance_m: FloatArray, bearing_rad: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(to the right, forward): x forward and y left, turned by a quarter."""
    return -distance_m * np.sin(bearing_rad), distance_m * np.cos(bearing_rad)

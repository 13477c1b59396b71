"""Where the robots went, seen from above."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path

from pilotfish.plots.style import FOLLOWER, GREEN, LEADER, ORANGE, PURPLE, SETPOINT, style
from pilotfish.recording import FloatArray, Recording

TICK_EVERY_S = 2.0
_FOLLOWERS = (FOLLOWER, GREEN, PURPLE, ORANGE)
_ARROWHEAD = Path([(1.0, 0.0), (-0.6, 0.55), (-0.3, 0.0), (-0.6, -0.55), (1.0, 0.0)])  # heading 0


def draw_paths(recordings: Sequence[Recording], title: str) -> Figure:
    """Paths of all robots, with a legend below."""
    with style():
        figure = Figure(figsize=(7.2, _height_in(recordings)))
        axes = figure.subplots()
        draw_paths_on(axes, recordings)
        axes.set_title(title)
        figure.legend(loc="outside lower center", ncols=3, fontsize=9)
    return figure


def draw_paths_on(axes: Axes, recordings: Sequence[Recording]) -> None:
    """Paths of all robots and of the leaders that are not themselves recorded; every TICK_EVERY_S seconds an
    arrowhead shows the heading and a thin line joins robot and leader."""
    recorded = {recording.meta.robot for recording in recordings}
    drawn: set[str] = set()
    for recording, colour in zip(recordings, _FOLLOWERS * len(recordings), strict=False):
        every = _every(recording.time_s, TICK_EVERY_S)
        axes.plot(
            np.stack([recording.x_m[every], recording.leader_x_m[every]]),
            np.stack([recording.y_m[every], recording.leader_y_m[every]]),
            color=SETPOINT,
            linewidth=0.5,
            alpha=0.6,
        )
        meta = recording.meta
        if meta.leader not in recorded | drawn:
            drawn.add(meta.leader)
            leader = (recording.leader_x_m, recording.leader_y_m, recording.leader_heading_rad)
            _draw_path(axes, leader, every, LEADER, f"{meta.leader} (leads)")
        own = (recording.x_m, recording.y_m, recording.heading_rad)
        _draw_path(axes, own, every, colour, f"{meta.robot} (follows {meta.leader} by sight)")
    axes.plot([], [], "o", color=SETPOINT, markerfacecolor="white", label="start")
    axes.plot([], [], "s", color=SETPOINT, label="end")
    axes.plot([], [], ">", color=SETPOINT, label=f"heading, every {TICK_EVERY_S:.0f} s")
    axes.plot([], [], color=SETPOINT, linewidth=0.5, label=f"line of sight, every {TICK_EVERY_S:.0f} s")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_aspect("equal", adjustable="datalim")


def _draw_path(
    axes: Axes,
    pose: tuple[FloatArray, FloatArray, FloatArray],
    every: np.ndarray,
    colour: str,
    label: str,
) -> None:
    x_m, y_m, heading_rad = pose
    axes.plot(x_m, y_m, color=colour, label=label)
    for x, y, heading in zip(x_m[every], y_m[every], heading_rad[every], strict=True):
        arrowhead = MarkerStyle(_ARROWHEAD).rotated(rad=float(heading))
        axes.plot(x, y, marker=arrowhead, markersize=9, color=colour, markeredgewidth=0)
    axes.plot(x_m[0], y_m[0], "o", color=colour, markerfacecolor="white", markersize=9, zorder=5)
    axes.plot(x_m[-1], y_m[-1], "s", color=colour, markersize=7, zorder=5)


def _every(time_s: FloatArray, period_s: float) -> np.ndarray:
    """Indices of the first sample at or after each multiple of the period."""
    ticks = np.arange(time_s[0], time_s[-1] + 1e-9, period_s)
    return np.searchsorted(time_s, ticks - 1e-9)


def _height_in(recordings: Sequence[Recording]) -> float:
    """Height of a 7.2 inch wide figure that suits the box around all paths: 3.4 for a line, 6.4 for a
    circle."""
    width_m = np.ptp(np.concatenate([np.concatenate([r.x_m, r.leader_x_m]) for r in recordings]))
    height_m = np.ptp(np.concatenate([np.concatenate([r.y_m, r.leader_y_m]) for r in recordings]))
    return float(np.clip(1.4 + 5.5 * height_m / max(width_m, 1e-9), 3.4, 6.4))

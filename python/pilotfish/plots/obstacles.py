"""Robots among obstacles, seen from above."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from pilotfish import sim
from pilotfish.plots.paths import LEGEND_LINE, draw_paths_on, path_handles
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.recording import Recording

OUTLINE_EVERY_S = 4.0


def draw_among_obstacles(
    recordings: Sequence[Recording],
    obstacles: Iterable[sim.Obstacle],
    title: str,
    *,
    radius_m: float = 0.25,
    sight_m: float = 0.25,
    theme: Theme = LIGHT,
) -> Figure:
    """Paths of all robots among the obstacles. radius_m: of the robots' outlines, every OUTLINE_EVERY_S; obstacles
    that are lower than sight_m, the height of the line of sight, are drawn paler: they hide nobody."""
    obstacles = list(obstacles)
    with style(theme):
        figure = Figure(figsize=(7.2, 4.4))
        axes = figure.subplots()
        draw_paths_on(axes, recordings, theme)
        for high in (True, False):
            discs = [Circle((o.x_m, o.y_m), o.radius_m) for o in obstacles if (o.height_m > sight_m) == high]
            axes.add_collection(PatchCollection(discs, facecolor=theme.guide, alpha=_alpha(high=high), zorder=3))
        for recording in recordings:
            _draw_outlines(axes, recording, radius_m, theme)
            start = (recording.x_m[0], recording.y_m[0])  # by name, too: of one law all have the same colour
            axes.annotate(recording.meta.robot, start, (-20, 0), textcoords="offset points", ha="right", va="center")
        axes.margins(x=0.12)  # room for the names
        axes.set_title(title)
        handles = [*path_handles(recordings, theme), *_more_handles(obstacles, sight_m, theme)]
        figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=3,
            fontsize=8,
            handlelength=LEGEND_LINE,
            columnspacing=1.2,
        )
    return figure


def _alpha(*, high: bool) -> float:
    return 0.9 if high else 0.35


def _more_handles(obstacles: Sequence[sim.Obstacle], sight_m: float, theme: Theme) -> list[Line2D]:
    """What is in the picture beside the paths."""
    aid = {"color": theme.guide, "linestyle": "none", "marker": "o"}
    names = {
        True: "obstacle",
        False: "low obstacle: hides nobody",
    }
    heights = {obstacle.height_m > sight_m for obstacle in obstacles}
    discs = [
        Line2D([], [], markersize=7, markeredgewidth=0, alpha=_alpha(high=high), label=name, **aid)
        for high, name in names.items()
        if high in heights
    ]
    outline = f"robot's outline, every {OUTLINE_EVERY_S:g} s"
    return [*discs, Line2D([], [], markersize=11, markerfacecolor="none", markeredgewidth=0.5, label=outline, **aid)]


def _draw_outlines(axes: Axes, recording: Recording, radius_m: float, theme: Theme) -> None:
    times = np.arange(recording.time_s[0], recording.time_s[-1], OUTLINE_EVERY_S)
    at = np.searchsorted(recording.time_s, times)
    rings = [Circle((x, y), radius_m) for x, y in zip(recording.x_m[at], recording.y_m[at], strict=True)]
    axes.add_collection(
        PatchCollection(rings, facecolor="none", edgecolor=theme.guide, linewidth=0.5, alpha=0.8, zorder=1.2)
    )

"""Where the robots went, seen from above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.path import Path
from matplotlib.transforms import Affine2D, IdentityTransform

from pilotfish.plots.laws import LawStyle, law_styles
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.recording import FloatArray, Recording

TICK_EVERY_S = 2.0
_ARROWHEAD = Path([(1.0, 0.0), (-0.6, 0.55), (-0.3, 0.0), (-0.6, -0.55), (1.0, 0.0)])  # heading 0
_ARROWHEAD_PT = 5.5
_LEADER_WIDTH_PT, _FOLLOWER_WIDTH_PT = 1.2, 2.0
# Solid, dashed, dotted, and one dash with two dots: no two of the first four are alike at a glance.
_CHAIN_DASHES = (
    "-",
    (0.0, (4.0, 2.0)),
    (0.0, (1.2, 1.2)),
    (0.0, (8.0, 1.5, 1.2, 1.5, 1.2, 1.5)),
    (0.0, (9.0, 4.0)),
)
LEGEND_LINE = 3.4  # of the letters' height: a shorter one does not show the whole pattern

Pose = tuple[FloatArray, FloatArray, FloatArray]  # x_m, y_m, heading_rad, each of shape (N,)


def draw_paths(recordings: Sequence[Recording], title: str, theme: Theme = LIGHT) -> Figure:
    """Paths of all robots, with a legend below."""
    with style(theme):
        figure = Figure(figsize=(7.2, _height_in(recordings)))
        axes = figure.subplots()
        draw_paths_on(axes, recordings, theme)
        axes.set_title(title)
        handles = path_handles(recordings, theme)
        figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=9, handlelength=LEGEND_LINE)
    return figure


def draw_paths_on(axes: Axes, recordings: Sequence[Recording], theme: Theme = LIGHT) -> None:
    """Paths of all robots and of the leaders that are not themselves recorded; every TICK_EVERY_S seconds an
    arrowhead shows the heading and a thin line joins robot and leader."""
    leaders = _leaders(recordings)
    for recording in leaders.values():
        pose = (recording.leader_x_m, recording.leader_y_m, recording.leader_heading_rad)
        _draw_path(axes, pose, _every(recording.time_s, TICK_EVERY_S), _leader_style(recording, theme))
    for recording, own in zip(recordings, _follower_styles(recordings, theme), strict=True):
        every = _every(recording.time_s, TICK_EVERY_S)
        eye = np.stack([recording.x_m[every], recording.y_m[every]], axis=-1)
        seen = np.stack([recording.leader_x_m[every], recording.leader_y_m[every]], axis=-1)
        sight = LineCollection(np.stack([eye, seen], axis=1), colors=theme.guide, linewidths=0.5, alpha=0.6, zorder=1.5)
        axes.add_collection(sight)
        _draw_path(axes, (recording.x_m, recording.y_m, recording.heading_rad), every, own)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_aspect("equal", adjustable="datalim")


def path_handles(recordings: Sequence[Recording], theme: Theme = LIGHT) -> list[Line2D]:
    """For the legend of ``draw_paths_on``."""
    styles = [_leader_style(recording, theme) for recording in _leaders(recordings).values()]
    styles += _follower_styles(recordings, theme)
    aid = {"color": theme.guide, "linestyle": "none"}
    return [
        *(Line2D([], [], **own.line()) for own in styles),
        Line2D([], [], marker="o", markerfacecolor=theme.ground, label="start", **aid),
        Line2D([], [], marker="s", label="end", **aid),
        Line2D([], [], marker=">", label=f"heading, every {TICK_EVERY_S:.0f} s", **aid),
        Line2D([], [], color=theme.guide, linewidth=0.5, label=f"line of sight, every {TICK_EVERY_S:.0f} s"),
    ]


def _leaders(recordings: Sequence[Recording]) -> dict[str, Recording]:
    """By the name of each leader that is not itself recorded: a run that shows where it went."""
    recorded = {recording.meta.robot for recording in recordings}
    seen_by = {recording.meta.leader: recording for recording in reversed(recordings)}
    return {leader: recording for leader, recording in reversed(seen_by.items()) if leader not in recorded}


def _leader_style(recording: Recording, theme: Theme) -> LawStyle:
    return LawStyle(f"{recording.meta.leader} (leads)", theme.ink, "-", _LEADER_WIDTH_PT, 2.0)


def _follower_styles(recordings: Sequence[Recording], theme: Theme) -> list[LawStyle]:
    """The colour says which law drove; robots of a chain, which the same law drives, differ by their dashes."""
    styles = []
    for number, recording in enumerate(recordings):
        law = law_styles([recording.meta.profile], theme)[recording.meta.profile]
        label = f"{recording.meta.robot} (follows {recording.meta.leader} by sight)"
        dashes = _CHAIN_DASHES[number % len(_CHAIN_DASHES)]
        styles.append(replace(law, label=label, dashes=dashes, width_pt=_FOLLOWER_WIDTH_PT, zorder=2.5))
    return styles


def _draw_path(axes: Axes, pose: Pose, every: np.ndarray, own: LawStyle) -> None:
    x_m, y_m, heading_rad = pose
    axes.plot(x_m, y_m, **own.line())
    arrowheads = [Affine2D().rotate(float(heading)).transform_path(_ARROWHEAD) for heading in heading_rad[every]]
    places = np.stack([x_m[every], y_m[every]], axis=-1)
    heads = PathCollection(
        arrowheads, sizes=(_ARROWHEAD_PT**2,), offsets=places, offset_transform=axes.transData, zorder=own.zorder + 0.1
    )
    heads.set(color=own.colour, linewidth=0, transform=IdentityTransform())
    axes.add_collection(heads)
    mark = {"color": own.colour, "linestyle": "none", "zorder": 5}
    axes.plot(x_m[0], y_m[0], marker="o", markerfacecolor=axes.get_facecolor(), markersize=9, **mark)
    axes.plot(x_m[-1], y_m[-1], marker="s", markersize=7, **mark)


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

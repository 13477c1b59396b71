"""A formation from above: robots to scale, what their cameras see, whom each watches, the ids of their tags."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Wedge

from pilotfish.formation.expand import tag_offsets
from pilotfish.formation.file import Formation, Stage
from pilotfish.formation.shapes import Place
from pilotfish.plots.style import LIGHT, Theme, style

_FIELD_M = 0.55  # how far a field of view is drawn
_STAGES_SHOWN = 4
_BESIDE_M = 1.0  # for what is written beside robots


def draw_formation(formation: Formation, theme: Theme = LIGHT) -> Figure:
    """One picture for each shape that the formation takes (up to four), in the order in which it takes them."""
    stages = formation.stages[:_STAGES_SHOWN]
    with style(theme):
        figure = Figure(figsize=(1.6 + 3.6 * len(stages), 5.0))
        for axes, stage in zip(figure.subplots(1, len(stages), squeeze=False)[0], stages, strict=True):
            _draw_stage(axes, formation, stage, theme)
        more = len(formation.stages) - len(stages)
        title = f"{formation.name}: {formation.description}" + (f" (and {more} more changes)" if more else "")
        figure.suptitle(textwrap.fill(title, 30 + 40 * len(stages)), x=0.01, ha="left", fontsize=11, weight="bold")
    return figure


def _draw_stage(axes: Axes, formation: Formation, stage: Stage, theme: Theme) -> None:
    offsets, ids = tag_offsets(formation), sorted(tag.id for tag in formation.outlook.body.tags)
    watched = {watch.leader for watch in stage.watches.values()}
    for robot, place in stage.places.items():
        colour = theme.anticipate if robot in stage.watches else theme.ink
        rear, front, right, left = formation.outlook.footprint_m
        corners = [(front, left), (front, right), (rear, right), (rear, left)]
        axes.add_patch(Polygon([_at(place, corner) for corner in corners], facecolor=colour, alpha=0.25, zorder=2))
        nose = [(front, 0.0), (0.0, right * 0.5), (0.0, left * 0.5)]
        axes.add_patch(Polygon([_at(place, corner) for corner in nose], facecolor=colour, zorder=3))
        tags = ", ".join(str(each + offsets[robot]) for each in ids)
        _write(axes, f"{robot}\ntags {tags}", formation, place, robot in watched, theme)
    for robot, watch in stage.watches.items():
        _draw_sight(axes, formation, stage.places, robot, watch.leader, theme)
    when = "start" if stage.at_s == 0.0 else f"from {stage.at_s:g} s"
    axes.set_title(f"{when}: {stage.shape.name.replace('_', ' ')}", fontsize=10)
    axes.set_xlabel("y, to the left [m]")
    axes.set_ylabel("x, ahead [m]")
    axes.set_aspect("equal", adjustable="box")
    _limit(axes, stage.places)


def _write(axes: Axes, text: str, formation: Formation, place: Place, watched: bool, theme: Theme) -> None:
    """Below the robot; if others look at it from there, beside it on the outer side."""
    rear, _, right, left = formation.outlook.footprint_m
    if not watched:
        point, shift, how = (rear, 0.0), (0, -3), {"ha": "center", "va": "top"}
    elif place[1] > 0.0:
        point, shift, how = (0.0, left), (-3, 0), {"ha": "right", "va": "center"}
    else:
        point, shift, how = (0.0, right), (3, 0), {"ha": "left", "va": "center"}
    axes.annotate(
        text, _at(place, point), xytext=shift, textcoords="offset points", fontsize=7, color=theme.ink, zorder=5, **how
    )


def _draw_sight(
    axes: Axes, formation: Formation, places: Mapping[str, Place], robot: str, leader: str, theme: Theme
) -> None:
    viewer = formation.outlook.viewer
    eye = _at(places[robot], (float(viewer.mounting.position_m[0]), float(viewer.mounting.position_m[1])))
    # Bearings of the picture's edges. Ahead is 90 degrees on paper, and positive bearings are to the left there too.
    edges = [viewer.camera.normalize(np.array([u, viewer.camera.cy]))[0] for u in (-0.5, viewer.camera.width - 0.5)]
    right_deg, left_deg = sorted(math.degrees(viewer.mounting.pan_rad - math.atan(edge)) for edge in edges)
    axes.add_patch(
        Wedge(eye, _FIELD_M, 90.0 + right_deg, 90.0 + left_deg, facecolor=theme.measured, alpha=0.25, zorder=1)
    )
    seen = _at(places[leader], (formation.outlook.footprint_m[0], 0.0))
    axes.annotate(
        "",
        seen,
        xytext=eye,
        arrowprops={"arrowstyle": "->", "color": theme.guide, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 1},
        zorder=4,
    )


def _at(place: Place, point: Place) -> tuple[float, float]:
    """A point of a robot on paper: x ahead is up, y to the left is left."""
    return -(place[1] + point[1]), place[0] + point[0]


def _limit(axes: Axes, places: Mapping[str, Place]) -> None:
    across = [-place[1] for place in places.values()]
    ahead = [place[0] for place in places.values()]
    axes.set_xlim(min(across) - _BESIDE_M, max(across) + _BESIDE_M)
    axes.set_ylim(min(ahead) - 0.6, max(ahead) + 0.4)
    axes.xaxis.set_major_formatter(lambda value, _: f"{-value:g}" if value else "0")

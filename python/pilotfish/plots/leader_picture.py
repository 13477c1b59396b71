"""A leader's tags in space, as they are printed, and from above with the directions from which they are seen."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from pilotfish.core import BodyTag, LeaderBody
from pilotfish.leader import Visibility, sheet_of
from pilotfish.plots.style import BLUE, GREEN, ORANGE, VERMILLION, style
from pilotfish.printing.quantities import millimetres
from pilotfish.printing.tag_art import tag_art

_BLIND, _ONE_PLANE, _SURE = VERMILLION, ORANGE, GREEN
_AXES = ((BLUE, "x forward", (1, 0, 0)), (GREEN, "y left", (0, 1, 0)), (VERMILLION, "z up", (0, 0, 1)))
_ELEVATION_DEG, _AZIMUTH_DEG = 24.0, 150.0
_TICKS = 5  # intervals of an axis in space; with more the numbers of a short one overlap
_HALO = [withStroke(linewidth=2.5, foreground="white")]
_WRAP = 150  # characters in a line of the remarks


def draw_leader(body: LeaderBody, visibility: Visibility, remarks: Sequence[str] = ()) -> Figure:
    """In space (from behind, left and above), from above, and the remarks below."""
    lines = [line for remark in remarks for line in _wrapped(remark)]
    with style():
        height = 6.0 + 0.2 * len(lines)
        figure = Figure(figsize=(12.5, height))
        title = f"{body.name}: {body.family}, black squares of {_sizes(body)}"
        figure.suptitle(title, x=0.02, ha="left", fontsize=12, weight="bold")
        grid = figure.add_gridspec(2, 2, height_ratios=[6.0, max(0.2 * len(lines), 0.05)])
        _draw_in_space(figure.add_subplot(grid[0, 0], projection="3d"), body)
        _draw_from_above(figure.add_subplot(grid[0, 1]), body, visibility)
        words = figure.add_subplot(grid[1, :])
        words.axis("off")
        words.text(0.0, 1.0, "\n".join(lines), va="top", fontsize=9, transform=words.transAxes)
    return figure


def _wrapped(remark: str) -> list[str]:
    lines = [""]
    for word in remark.split():
        if len(lines[-1]) + len(word) > _WRAP:
            lines.append("   ")
        lines[-1] += f"{' ' if lines[-1].strip() else ''}{word}"
    return lines


def _extent_m(body: LeaderBody) -> float:
    corners = np.concatenate([sheet_of(tag, body.family).corners_m() for tag in body.tags])
    return float(max(np.linalg.norm(corners[:, :2], axis=1).max(), corners[:, 2].max() / 2, 0.05))


def _draw_in_space(axes: Axes3D, body: LeaderBody) -> None:
    axes.computed_zorder = False  # else arrows and names disappear behind paper that is nearer on the average
    extent = _extent_m(body)
    eye = _direction(_ELEVATION_DEG, _AZIMUTH_DEG)
    cells, colours = [], []
    for tag in body.tags:
        sheet = sheet_of(tag, body.family)
        squares, black = _cells_m(tag, body.family)
        is_front = sheet.looks @ eye > 0.0
        cells += squares
        colours += [("black" if dark else "white") if is_front else "#BBBBBB" for dark in black]
        axes.plot(*sheet.corners_m()[[0, 1, 2, 3, 0]].T, color="#888888", linewidth=0.6, zorder=3)
        looks = sheet.looks * 0.5 * extent
        axes.quiver(*sheet.centre_m, *looks, color=BLUE, linewidth=1.2, arrow_length_ratio=0.15, zorder=10)
        at, how = sheet.centre_m + 1.15 * looks, {"ha": "center", "va": "center", "path_effects": _HALO}
        axes.text(*at, str(tag.id), color=BLUE, weight="bold", zorder=11, **how)
    # One collection for all: matplotlib sorts by depth within a collection only.
    axes.add_collection3d(Poly3DCollection(cells, facecolors=colours, edgecolors=colours, linewidths=0.3, zorder=2))
    for colour, name, direction in _AXES:
        end = 0.5 * extent * np.array(direction)
        axes.quiver(0, 0, 0, *end, color=colour, linewidth=1.5, arrow_length_ratio=0.15, zorder=1)
        axes.plot([], [], [], color=colour, linewidth=1.5, label=name)
    # Not at the arrows' ends, where paper hides names, and numbers of tags and other arrows meet them.
    axes.legend(loc="upper left", fontsize=8, handlelength=1.2)
    highest = max(1.2 * extent, *(sheet_of(tag, body.family).corners_m()[:, 2].max() for tag in body.tags))
    axes.set_box_aspect((1, 1, highest / (2 * extent)))
    axes.set(xlim=(-extent, extent), ylim=(-extent, extent), zlim=(0, highest))
    axes.set(xlabel="forward [m]", ylabel="left [m]", zlabel="up [m]")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(_TICKS, steps=[1, 2, 5, 10]))
    axes.set_title("As it hangs (seen from its left, behind and above)")
    axes.view_init(elev=_ELEVATION_DEG, azim=_AZIMUTH_DEG)


def _direction(elevation_deg: float, azimuth_deg: float) -> np.ndarray:
    """(3,): towards who looks, as matplotlib counts."""
    up, round_z = math.radians(elevation_deg), math.radians(azimuth_deg)
    return np.array([math.cos(up) * math.cos(round_z), math.cos(up) * math.sin(round_z), math.sin(up)])


def _sizes(body: LeaderBody) -> str:
    """'160 mm', or with the ids if they differ: '160 mm (0), 100 mm (1, 5)'."""
    sizes = sorted({tag.size_m for tag in body.tags}, reverse=True)
    if len(sizes) == 1:
        return millimetres(sizes[0])
    ids = {size: ", ".join(str(tag.id) for tag in body.tags if tag.size_m == size) for size in sizes}
    return ", ".join(f"{millimetres(size)} ({ids[size]})" for size in sizes)


def _cells_m(tag: BodyTag, family: str) -> tuple[list[np.ndarray], list[bool]]:
    """A (4, 3) polygon for every cell, the white border's too, and whether it is black."""
    art = tag_art(family, tag.id, tag.size_m)
    black = np.pad(art.black, 1)
    oMt = tag.oMt
    rows, columns = np.indices(black.shape).reshape(2, -1)
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    flat = (np.stack([columns, rows], axis=-1)[:, None, :] + square - len(black) / 2) * art.cell_m
    return list(flat @ oMt[:3, :2].T + oMt[:3, 3]), black.ravel().tolist()


def _draw_from_above(axes: Axes, body: LeaderBody, visibility: Visibility) -> None:
    """Forward is up, left is left: x on the ordinate, -y on the abscissa."""
    extent = _extent_m(body)
    ring = 1.75 * extent
    _draw_ring(axes, visibility, ring)
    for tag in body.tags:
        sheet = sheet_of(tag, body.family, with_border=False)
        corners = sheet.corners_m()
        outline = corners[[0, 1, 2, 3, 0]]
        axes.plot(-outline[:, 1], outline[:, 0], color="black", linewidth=2.5, solid_capstyle="butt")
        looks = 0.45 * extent * sheet.looks
        axes.annotate(
            "",
            (-(sheet.centre_m + looks)[1], (sheet.centre_m + looks)[0]),
            (-sheet.centre_m[1], sheet.centre_m[0]),
            arrowprops={"arrowstyle": "->", "color": BLUE, "linewidth": 1.2},
        )
        at = sheet.centre_m + 1.25 * looks
        axes.text(-at[1], at[0], str(tag.id), color=BLUE, weight="bold", ha="center", va="center")
    axes.annotate("", (0, 0.5 * extent), (0, 0), arrowprops={"arrowstyle": "-|>", "color": "black"})
    axes.text(0.04 * extent, 0.5 * extent, "forward", fontsize=8, va="center")
    axes.plot(0, 0, "+", color="black", markersize=10)
    axes.set_aspect("equal")
    limit = 1.3 * ring
    axes.set(xlim=(-limit, limit), ylim=(-limit, limit), xlabel="right [m]", ylabel="forward [m]")
    axes.set_title(f"From above; the ring: what is seen from there, at {visibility.distance_m:g} m")


def _draw_ring(axes: Axes, visibility: Visibility, radius: float) -> None:
    count = visibility.seen.sum(axis=1)
    kinds = (
        (count == 0, _BLIND, "no tag"),
        ((count > 0) & (visibility.planes == 1), _ONE_PLANE, "tags in one plane"),
        (visibility.planes > 1, _SURE, "tags in two planes or more"),
    )
    step = math.radians(360.0 / len(visibility.azimuth_deg)) / 2
    for mask, colour, name in kinds:
        angle = np.radians(visibility.azimuth_deg[mask])[:, None] + np.array([-step, step, np.nan])
        x, y = -radius * np.sin(angle), radius * np.cos(angle)
        axes.plot(x.ravel(), y.ravel(), color=colour, linewidth=6, solid_capstyle="butt", label=name)
    for azimuth in range(0, 360, 45):
        angle = math.radians(azimuth)
        at = -1.16 * radius * math.sin(angle), 1.16 * radius * math.cos(angle)
        axes.text(*at, f"{azimuth}°", ha="center", va="center", fontsize=8, color="#555555")
    axes.legend(loc="upper left", fontsize=8, handlelength=1.2)

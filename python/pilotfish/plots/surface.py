"""The control surface u(e, ec) and sections of it."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from pilotfish import fuzzy
from pilotfish.plots.style import LIGHT, Theme, style

_GRID = 61
_SECTION = 801
_DASHES = ((0.0, (5.0, 1.5)), "-", (0.0, (5.0, 1.5, 1.5, 1.5)))

ERROR, CHANGE, SPEED = "distance error e [-]", "change of the error ec [-]", "velocity u [-]"


def draw_surface(controller: fuzzy.Controller, title: str = "Control surface", theme: Theme = LIGHT) -> Figure:
    """Left u over (e, ec) as a surface; right u(e, ec) over e for three values of ec. All are normalised."""
    with style(theme):
        figure = Figure(figsize=(11.0, 4.8))
        figure.suptitle(f"{title} (e, ec and u normalised)", x=0.02, ha="left", fontsize=12, weight="bold")
        left, right = figure.subfigures(1, 2, width_ratios=(1.15, 1.0))
        _draw_solid(left, controller, theme)
        _draw_sections(right, controller, theme)
    return figure


def _draw_solid(figure: Figure, controller: fuzzy.Controller, theme: Theme) -> None:
    error, change, output = controller.error, controller.error_change, controller.output
    axes = figure.add_subplot(projection="3d")
    e, ec = np.meshgrid(
        np.linspace(error.min, error.max, _GRID), np.linspace(change.min, change.max, _GRID), indexing="ij"
    )
    u = outputs(controller, e.ravel(), ec.ravel()).reshape(e.shape)
    fine = {"rcount": _GRID, "ccount": _GRID, "linewidth": 0.15, "edgecolor": f"{theme.ink}22", "rasterized": True}
    solid = axes.plot_surface(e, ec, u, cmap=theme.values, vmin=output.min, vmax=output.max, **fine)
    figure.colorbar(solid, ax=axes, shrink=0.7, pad=0.12, label=SPEED)
    axes.set_xlabel(ERROR, labelpad=8.0)
    axes.set_ylabel(CHANGE, labelpad=8.0)
    axes.set_zlabel(SPEED)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MultipleLocator(0.5))
        axis.set_pane_color(theme.ground)
        axis.line.set_color(theme.ink)
    axes.view_init(elev=24, azim=-38)
    axes.set_box_aspect((1.1, 1.1, 0.8), zoom=0.85)


def _draw_sections(figure: Figure, controller: fuzzy.Controller, theme: Theme) -> None:
    error, change = controller.error, controller.error_change
    axes = figure.add_subplot()
    axes.axhline(0.0, color=theme.guide, linewidth=0.6)
    axes.axvline(0.0, color=theme.guide, linewidth=0.6)
    e = np.linspace(error.min, error.max, _SECTION)
    middle, quarter = 0.5 * (change.min + change.max), 0.25 * (change.max - change.min)
    for ec, share, dashes in zip((middle - quarter, middle, middle + quarter), (0.25, 0.5, 0.75), _DASHES, strict=True):
        u = outputs(controller, e, np.full(_SECTION, ec))
        label = f"ec = {ec:+.1f}" if ec else "ec = 0"
        axes.plot(e, u, linestyle=dashes, color=theme.values(share), linewidth=1.8, label=label)
    axes.set_xlabel(f"{ERROR} (positive: too close)")
    axes.set_ylabel(SPEED)
    axes.set_xlim(error.min, error.max)
    axes.legend(loc="upper right", handlelength=3.0)


def outputs(controller: fuzzy.Controller, error: np.ndarray, error_change: np.ndarray) -> np.ndarray:
    """u*, shape (N,), for inputs of shape (N,)."""
    return fuzzy.infer_outputs(controller, error, error_change)

"""The control surface u(e, ec) and its section u(e, 0)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from pilotfish import fuzzy
from pilotfish.plots.style import BLACK, BLUE, SETPOINT, VERMILLION, style

_GRID = 61
_SECTION = 801


def draw_surface(controller: fuzzy.Controller, title: str = "Control surface") -> Figure:
    """Left u over (e, ec) as a surface; right u(e, ec) over e for three values of ec."""
    error, change = controller.error, controller.error_change
    with style():
        figure = Figure(figsize=(10.0, 4.6))
        figure.suptitle(title, x=0.02, ha="left", fontsize=12, weight="bold")
        grid = figure.add_gridspec(1, 2, width_ratios=(1.0, 1.0))

        solid = figure.add_subplot(grid[0], projection="3d")
        e, ec = np.meshgrid(
            np.linspace(error.min, error.max, _GRID),
            np.linspace(change.min, change.max, _GRID),
            indexing="ij",
        )
        u = outputs(controller, e.ravel(), ec.ravel()).reshape(e.shape)
        solid.plot_surface(e, ec, u, cmap="cividis", rcount=_GRID, ccount=_GRID, linewidth=0.15, edgecolor="#33333333")
        solid.set_xlabel("e")
        solid.set_ylabel("ec")
        solid.set_zlabel("u")
        for axis in (solid.xaxis, solid.yaxis, solid.zaxis):
            axis.set_major_locator(MultipleLocator(0.5))
        solid.view_init(elev=24, azim=-38)
        solid.set_box_aspect((1.1, 1.1, 0.8), zoom=0.9)

        section = figure.add_subplot(grid[1])
        section.axhline(0.0, color=SETPOINT, linewidth=0.6)
        section.axvline(0.0, color=SETPOINT, linewidth=0.6)
        e_line = np.linspace(error.min, error.max, _SECTION)
        half = 0.5 * change.max
        for ec_value, colour, dashes in ((-half, VERMILLION, "--"), (half, BLUE, "-."), (0.0, BLACK, "-")):
            u_line = outputs(controller, e_line, np.full(_SECTION, ec_value))
            section.plot(e_line, u_line, dashes, color=colour, label=f"ec = {ec_value:+.1f}" if ec_value else "ec = 0")
        section.set_xlabel("distance error e, normalised (positive: too close)")
        section.set_ylabel("velocity u, normalised")
        section.set_xlim(error.min, error.max)
        section.legend(loc="upper right")
    return figure


def outputs(controller: fuzzy.Controller, error: np.ndarray, error_change: np.ndarray) -> np.ndarray:
    """u*, shape (N,), for inputs of shape (N,)."""
    return fuzzy.infer_outputs(controller, error, error_change)

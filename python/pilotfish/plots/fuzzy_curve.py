"""The curve u(e, 0) with its slope at zero, its dead zone and its jumps."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from pilotfish import fuzzy
from pilotfish.fuzzy_report import Report
from pilotfish.number_text import signed
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.plots.surface import outputs

_SAMPLES = 4001


def draw_curve(
    controller: fuzzy.Controller, report: Report, title: str = "The curve u(e, 0)", theme: Theme = LIGHT
) -> Figure:
    """u over e at a constant distance; the tangents at zero are drawn as far as they are steeper than the picture."""
    error = controller.error
    with style(theme):
        figure = Figure(figsize=(7.2, 4.6))
        axes = figure.subplots()
        axes.set_title(title)
        axes.axhline(0.0, color=theme.guide, linewidth=0.6)
        axes.axvline(0.0, color=theme.guide, linewidth=0.6)
        e = np.linspace(error.min, error.max, _SAMPLES)
        u = outputs(controller, e, np.zeros(_SAMPLES))
        jumps = [jump.at for jump in report.jumps if jump.variable == error.name]
        for at in jumps:  # a break in the line, where there is one in the surface
            u[np.abs(e - at) <= e[1] - e[0]] = np.nan
            axes.axvline(at, color=theme.guide, linestyle=":", label="jump" if at == jumps[0] else None)
        top = float(np.nanmax(np.abs(u)))
        for slope, side in zip(report.slope_at_zero, (-1.0, 1.0), strict=True):
            length = min(0.6 * top / max(abs(slope), 1e-9), 0.4 * abs(error.max))
            tangent = np.array([0.0, side * length])
            label = f"slope at zero {signed(slope, 2)}"
            shown = label if side > 0 or not np.isclose(*report.slope_at_zero) else None
            axes.plot(tangent, slope * tangent, "--", color=theme.guide, linewidth=2.4, label=shown)
        low, high = report.dead_zone
        if high > low:
            hatched = {"facecolor": "none", "edgecolor": theme.guide, "hatch": "///", "linewidth": 0.0, "alpha": 0.6}
            axes.axvspan(low, high, label=f"dead zone {low:.3g} to {high:.3g}", **hatched)
        axes.plot(e, u, color=theme.ink, label="u(e, 0)")
        axes.set_xlim(error.min, error.max)
        axes.set_xlabel("distance error e, normalised [-] (positive: too close)")
        axes.set_ylabel("velocity u, normalised [-]")
        axes.legend(loc="best")
    return figure

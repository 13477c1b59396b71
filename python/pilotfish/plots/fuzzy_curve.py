"""The curve u(e, 0) with its slope at zero, its dead zone and its jumps."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from pilotfish import fuzzy
from pilotfish.fuzzy_report import Report
from pilotfish.plots.style import BLUE, ORANGE, SETPOINT, VERMILLION, style
from pilotfish.plots.surface import outputs

_SAMPLES = 4001


def draw_curve(controller: fuzzy.Controller, report: Report, title: str = "The curve u(e, 0)") -> Figure:
    """u over e at a constant distance; the tangents at zero are drawn as far as they are steeper than the picture."""
    error = controller.error
    with style():
        figure = Figure(figsize=(7.2, 4.6))
        axes = figure.subplots()
        axes.set_title(title)
        axes.axhline(0.0, color=SETPOINT, linewidth=0.6)
        axes.axvline(0.0, color=SETPOINT, linewidth=0.6)
        e = np.linspace(error.min, error.max, _SAMPLES)
        u = outputs(controller, e, np.zeros(_SAMPLES))
        jumps = [jump.at for jump in report.jumps if jump.variable == error.name]
        for at in jumps:  # a break in the line, where there is one in the surface
            u[np.abs(e - at) <= e[1] - e[0]] = np.nan
            axes.axvline(at, color=VERMILLION, linestyle=":", label="jump" if at == jumps[0] else None)
        top = float(np.nanmax(np.abs(u)))
        for slope, side in zip(report.slope_at_zero, (-1.0, 1.0), strict=True):
            length = min(0.6 * top / max(abs(slope), 1e-9), 0.4 * abs(error.max))
            tangent = np.array([0.0, side * length])
            label = f"slope at zero {slope:+.2f}" if side > 0 or not np.isclose(*report.slope_at_zero) else None
            axes.plot(tangent, slope * tangent, "--", color=ORANGE, label=label)
        low, high = report.dead_zone
        if high > low:
            axes.axvspan(low, high, color=VERMILLION, alpha=0.15, label=f"dead zone {low:.3g} to {high:.3g}")
        axes.plot(e, u, color=BLUE, label="u(e, 0)")
        axes.set_xlim(error.min, error.max)
        axes.set_xlabel("distance error e, normalised (positive: too close)")
        axes.set_ylabel("velocity u, normalised")
        axes.legend(loc="best")
    return figure

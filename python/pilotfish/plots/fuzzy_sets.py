"""The membership functions of E, EC and U, in the form of the source paper's Figs. 2 to 4."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pilotfish import fuzzy
from pilotfish.plots.style import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILLION, style

# By name, so that a term and its opposite are distinguished at one glance: blues are negative, reds positive.
_COLOURS = {"NB": BLUE, "NM": SKY, "NS": GREEN, "NZ": "#777777", "ZE": "#000000", "PZ": "#000000"}
_COLOURS |= {"PS": PURPLE, "PM": ORANGE, "PB": VERMILLION}
_SAMPLES = 2001


def draw_fuzzy_sets(controller: fuzzy.Controller, title: str = "Membership functions") -> Figure:
    """One axes each for E, EC and U over their normalised universes."""
    with style():
        figure = Figure(figsize=(7.2, 7.2))
        figure.suptitle(title, x=0.02, ha="left", fontsize=12, weight="bold")
        captions = ("distance error e", "change of the error ec", "velocity u")
        variables = (controller.error, controller.error_change, controller.output)
        for axes, variable, caption in zip(figure.subplots(3, 1), variables, captions, strict=True):
            draw_variable(axes, variable)
            axes.set_xlabel(f"{caption}, normalised")
            axes.set_ylabel(f"degree, {variable.name}")
    return figure


def draw_variable(axes: Axes, variable: fuzzy.LinguisticVariable, *, faint: bool = False) -> None:
    """The sets of one variable, each with its name at its peak."""
    x = np.linspace(variable.min, variable.max, _SAMPLES)
    for term in variable.terms:
        degree = fuzzy.membership(term.set, x)
        colour = _COLOURS.get(term.label, "#000000")
        axes.plot(x, degree, color=colour, alpha=0.35 if faint else 1.0)
        peak = float(x[degree >= degree.max() - 1e-9].mean())
        axes.text(peak, 1.04, term.label, color=colour, ha=_alignment(variable, peak), weight="bold")
    axes.set_xlim(variable.min, variable.max)
    axes.set_ylim(0.0, 1.18)
    axes.set_yticks([0.0, 0.5, 1.0])


def _alignment(variable: fuzzy.LinguisticVariable, peak: float) -> str:
    """NZ and PZ peak side by side around zero, so their names go to either side; names at the ends go
    inside."""
    if peak == variable.min or 0.0 < peak < 0.1 * variable.max:
        return "left"
    if peak == variable.max or 0.1 * variable.min < peak < 0.0:
        return "right"
    return "center"

"""The membership functions of E, EC and U, one axes each."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pilotfish import fuzzy
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.recording import FloatArray

DEGREE = "degree of membership [-]"
TOP = 1.18  # of the axis of degrees: the names of the sets stand above 1
_SAMPLES = 2001
_DASHES = ("-", (0.0, (5.0, 1.5)))  # in turn, so that a set is told from its neighbour in gray as well


def draw_fuzzy_sets(controller: fuzzy.Controller, title: str = "Membership functions", theme: Theme = LIGHT) -> Figure:
    """One axes each for E, EC and U over their normalised universes."""
    with style(theme):
        figure = Figure(figsize=(7.2, 7.2))
        figure.suptitle(title, x=0.02, ha="left", fontsize=12, weight="bold")
        captions = ("distance error e (positive: too close)", "change of the error ec", "velocity u")
        variables = (controller.error, controller.error_change, controller.output)
        for axes, variable, caption in zip(figure.subplots(3, 1), variables, captions, strict=True):
            draw_variable(axes, variable, theme=theme)
            axes.set_xlabel(f"{caption}, normalised [-]")
            axes.set_ylabel(f"{variable.name}: {DEGREE}", fontsize=9)
    return figure


def draw_variable(axes: Axes, variable: fuzzy.LinguisticVariable, *, faint: bool = False, theme: Theme = LIGHT) -> None:
    """The sets of one variable, each where its degree is not zero, with its name at its peak, in the colour of the
    value at which it peaks."""
    x = np.linspace(variable.min, variable.max, _SAMPLES)
    for number, term in enumerate(variable.terms):
        degree = np.asarray(fuzzy.membership(term.set, x))
        peak = float(x[degree >= degree.max() - 1e-9].mean())
        share = (peak - variable.min) / (variable.max - variable.min)
        line = {"color": theme.values(share), "alpha": 0.45 if faint else 1.0, "linewidth": 1.8}
        axes.plot(x, _without_tails(degree), linestyle=_DASHES[number % len(_DASHES)], label=term.label, **line)
        axes.text(peak, 1.04, term.label, color=theme.ink, ha=_alignment(variable, peak), weight="bold")
    axes.set_xlim(variable.min, variable.max)
    axes.set_ylim(0.0, TOP)
    axes.set_yticks([0.0, 0.5, 1.0])


def _without_tails(degree: FloatArray) -> FloatArray:
    """NaN where the degree and both its neighbours are zero: a set is drawn down to its feet and no further, else it
    runs along the base line over the others."""
    wide = np.concatenate([[0.0], degree, [0.0]])
    return np.where((wide[:-2] > 0.0) | (degree > 0.0) | (wide[2:] > 0.0), degree, np.nan)


def _alignment(variable: fuzzy.LinguisticVariable, peak: float) -> str:
    """NZ and PZ peak side by side around zero, so their names go to either side; names at the ends go
    inside."""
    if peak == variable.min or 0.0 < peak < 0.1 * variable.max:
        return "left"
    if peak == variable.max or 0.1 * variable.min < peak < 0.0:
        return "right"
    return "center"

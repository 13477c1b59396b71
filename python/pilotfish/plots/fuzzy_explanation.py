"""One inference as a picture: where the inputs fall on their sets, the clipped output set and its centroid."""

from __future__ import annotations

from matplotlib.figure import Figure

from pilotfish import fuzzy
from pilotfish.plots.fuzzy_sets import DEGREE, TOP, draw_variable
from pilotfish.plots.style import LIGHT, Theme, style

_RULES = 5
_BELOW_NAMES = 1.0 / TOP  # share of the height below the names of the sets


def draw_explanation(
    controller: fuzzy.Controller,
    error: float,
    error_change: float,
    widths: fuzzy.InputWidths,
    theme: Theme = LIGHT,
) -> Figure:
    """E and EC with the inputs (and their widths), then mu_C'(u) with u* under it; the strongest rules as the title."""
    explanation = fuzzy.explain(controller, error, error_change, widths)
    with style(theme):
        figure = Figure(figsize=(7.6, 7.4))
        inputs = ((controller.error, error, widths.error), (controller.error_change, error_change, widths.error_change))
        *above, below = figure.subplots(3, 1)
        for axes, (variable, value, width) in zip(above, inputs, strict=True):
            draw_variable(axes, variable, theme=theme)
            at = min(max(value, variable.min), variable.max)
            axes.axvline(at, color=theme.measured, ymax=_BELOW_NAMES, linewidth=2.0)
            if width > 0.0:
                axes.axvspan(at - width, at + width, color=theme.measured, alpha=0.2, linewidth=0)
            axes.set_xlabel(f"{variable.name} = {value:.3g} [-]" + (f", width {width:.3g}" if width else ""))
            axes.set_ylabel(DEGREE, fontsize=9)
        draw_variable(below, controller.output, faint=True, theme=theme)
        u, degree = explanation.clipped.T
        below.fill_between(u, degree, color=theme.guide, alpha=0.35, linewidth=0)
        below.plot(u, degree, color=theme.ink)
        centroid = {"color": theme.ink, "linestyle": "--", "linewidth": 2.0}
        below.axvline(explanation.inference.output, ymax=_BELOW_NAMES, **centroid)
        below.set_xlabel(
            f"{controller.output.name} = {explanation.inference.output:.4f} [-], the centroid of the shaded set"
        )
        below.set_ylabel(DEGREE, fontsize=9)
        rules = "\n".join(firing.text for firing in explanation.firing[:_RULES])
        figure.suptitle(rules, x=0.02, ha="left", fontsize=10, family="monospace")
    return figure

"""One inference as a picture: where the inputs fall on their sets, the clipped output set and its centroid."""

from __future__ import annotations

from matplotlib.figure import Figure

from pilotfish import fuzzy
from pilotfish.plots.fuzzy_sets import draw_variable
from pilotfish.plots.style import BLUE, SKY, VERMILLION, style

_RULES = 5


def draw_explanation(
    controller: fuzzy.Controller, error: float, error_change: float, widths: fuzzy.InputWidths
) -> Figure:
    """E and EC with the inputs (and their widths), then mu_C'(u) with u* under it; the strongest rules as the title."""
    explanation = fuzzy.explain(controller, error, error_change, widths)
    with style():
        figure = Figure(figsize=(7.6, 7.4))
        inputs = ((controller.error, error, widths.error), (controller.error_change, error_change, widths.error_change))
        *above, below = figure.subplots(3, 1)
        for axes, (variable, value, width) in zip(above, inputs, strict=True):
            draw_variable(axes, variable)
            at = min(max(value, variable.min), variable.max)
            axes.axvline(at, color=VERMILLION)
            if width > 0.0:
                axes.axvspan(at - width, at + width, color=VERMILLION, alpha=0.12)
            axes.set_xlabel(f"{variable.name} = {value:.3g}" + (f", width {width:.3g}" if width else ""))
            axes.set_ylabel("degree")
        draw_variable(below, controller.output, faint=True)
        u, degree = explanation.clipped.T
        below.fill_between(u, degree, color=SKY, alpha=0.5)
        below.plot(u, degree, color=BLUE)
        below.axvline(explanation.inference.output, color=VERMILLION)
        below.set_xlabel(
            f"{controller.output.name} = {explanation.inference.output:.4f}, the centroid of the shaded set"
        )
        below.set_ylabel("degree")
        rules = "\n".join(firing.text for firing in explanation.firing[:_RULES])
        figure.suptitle(rules, x=0.02, ha="left", fontsize=10, family="monospace")
    return figure

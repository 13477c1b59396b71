"""The tables of ``pilotfish fuzzy``."""

from __future__ import annotations

from rich.table import Table

from pilotfish import fuzzy
from pilotfish.fuzzy_report import Report


def sets_table(variable: fuzzy.LinguisticVariable) -> Table:
    """One row a term: its shape, its numbers, and where it is one."""
    table = Table(title=f"{variable.name} over [{variable.min:g}, {variable.max:g}]", title_justify="left")
    for heading in ("term", "shape", "numbers", "core"):
        table.add_column(heading)
    for term in variable.terms:
        core = fuzzy.level_cut(term.set, 1.0)
        table.add_row(
            term.label,
            type(term.set).__name__.lower(),
            "  ".join(f"{number:g}" for number in _numbers(term.set)),
            f"{core[0]:g}" if core[1] - core[0] < 1e-12 else f"{core[0]:g} to {core[1]:g}",
        )
    return table


def _numbers(shape: fuzzy.Triangle | fuzzy.Trapezoid | fuzzy.Gaussian) -> list[float]:
    names = {"Triangle": "abc", "Trapezoid": "abcd", "Gaussian": ("mean", "sigma")}[type(shape).__name__]
    return [getattr(shape, name) for name in names]


def rules_table(controller: fuzzy.Controller) -> Table:
    """The table as the paper prints it."""
    title = f"{controller.output.name}, by {controller.error.name} (rows) and {controller.error_change.name} (columns)"
    table = Table(title=title, title_justify="left")
    table.add_column(f"{controller.error.name} \\ {controller.error_change.name}", style="bold")
    for label in controller.error_change.labels:
        table.add_column(label, justify="center")
    labels = controller.output.labels
    for row, cells in zip(controller.error.labels, controller.rules.consequents, strict=True):
        table.add_row(row, *(labels[cell] for cell in cells))
    return table


def figures_table(report: Report) -> Table:
    """What the controller does as a whole, in its normalised units."""
    table = Table(title="What comes of them", title_justify="left", show_header=False)
    table.add_column()
    table.add_column(justify="right")
    left, right = report.slope_at_zero
    low, high = report.dead_zone
    table.add_row("slope of u(e, 0) at zero, left and right", f"{left:+.3f}  {right:+.3f}")
    table.add_row("dead zone of u(e, 0)", f"{low:.4g} to {high:.4g}" if high > low else "none")
    table.add_row("u from, to", f"{report.range[0]:+.4f}  {report.range[1]:+.4f}")
    table.add_row("steepest along e, along ec", f"{report.steepest[0]:.3g}  {report.steepest[1]:.3g}")
    table.add_row("ripple along e, along ec", f"{report.ripple[0]:.3g}  {report.ripple[1]:.3g}")
    table.add_row("discontinuities", str(len(report.jumps)) if report.jumps else "none")
    table.add_row("rules that never fire", str(len(report.never_fires)) if report.never_fires else "none")
    table.add_row("rules that never decide", str(len(report.never_decides)) if report.never_decides else "none")
    return table


def firing_table(controller: fuzzy.Controller, explanation: fuzzy.Explanation) -> Table:
    """The rules that fire, strongest first, and the output."""
    term_strengths = ", ".join(
        f"{label} at {height:.2f}"
        for label, height in zip(controller.output.labels, explanation.term_strengths, strict=True)
        if height > 0
    )
    caption = f"{controller.output.name} = {explanation.inference.output:+.4f}, the centroid of {term_strengths}"
    table = Table(
        title="Rules that fire, strongest first", title_justify="left", caption=caption, caption_justify="left"
    )
    table.add_column("rule")
    table.add_column("strength", justify="right")
    for firing in explanation.firing:
        table.add_row(firing.text.rsplit(",", 1)[0], f"{firing.strength:.4f}")
    return table

"""The chart of the cost per robot."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter

from bench.sim.figures import CrowdFigures
from pilotfish.plots.style import LIGHT, Theme, style


def draw_scale(rows: Sequence[CrowdFigures], exponent: float, theme: Theme = LIGHT) -> Figure:
    """Processor time of a frame per robot over the number of robots: flat where the cost is linear."""
    robots = [row.robots for row in rows]
    with style(theme):
        figure = Figure(figsize=(7.2, 4.2))
        axes = figure.subplots()
        lines = (
            ("picture and answer", [row.robot_frame_ms for row in rows], theme.anticipate, "-"),
            ("picture", [row.render_ms for row in rows], theme.measured, "--"),
            ("answer", [row.answer_ms for row in rows], theme.ink, ":"),
        )
        for label, values, colour, dashes in lines:
            axes.plot(robots, values, color=colour, linestyle=dashes, marker="o", markersize=4, label=label)
        axes.set_xscale("log")
        axes.set_xticks(robots)
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.xaxis.set_minor_formatter("")
        axes.set_ylim(bottom=0.0)
        axes.set_xlabel("robots in a column, each with a camera of 640 x 480 [-]")
        axes.set_ylabel("processor time\nper robot and frame [ms]")
        axes.set_title(f"A frame of all robots costs robots^{exponent:.2f}")
        axes.legend(loc="center right")
    return figure

"""Several experiments on one page, a column each: where the robots went, what the camera saw, and over time the
distance error in metres and millimetres, the bearing error and the command of every law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D

from pilotfish.camera_view import CameraView
from pilotfish.law_names import law_name
from pilotfish.plots.camera_gif import draw_seen, measured_texts
from pilotfish.plots.laws import law_styles
from pilotfish.plots.paths import draw_paths_on, path_handles
from pilotfish.plots.style import LIGHT, Theme, style
from pilotfish.plots.traces import draw_bearings_on, draw_errors_on, draw_rms_on, draw_speeds_on
from pilotfish.recording import Recording

_PANELS = {"error": draw_errors_on, "rms": draw_rms_on, "bearing": draw_bearings_on, "speed": draw_speeds_on}
_ROWS = [["paths", "camera"], *([name, name] for name in _PANELS)]
_HEIGHTS = (2.6, 1.9, 1.9, 1.3, 1.3)


@dataclass(frozen=True)
class Summary:
    """The runs of one experiment, by the name of the law, and what the last one's camera saw at one instant of it."""

    title: str
    runs: Mapping[str, Recording]
    view: CameraView

    @property
    def last(self) -> Recording:
        """The run that was made last: the one that is drawn in the paths."""
        return list(self.runs.values())[-1]


def draw_overview(summaries: Sequence[Summary], theme: Theme = LIGHT) -> Figure:
    """One column an experiment."""
    with style(theme):
        figure = Figure(figsize=(6.2 * len(summaries), 9.8))
        columns = figure.subfigures(1, len(summaries), squeeze=False)[0]
        drawn = [_draw_column(*pair, theme) for pair in zip(columns, summaries, strict=True)]
        for axes in drawn[1:]:
            axes["rms"].sharey(drawn[0]["rms"])
        drawn[0]["rms"].autoscale_view()
        laws = {law: run for summary in summaries for law, run in summary.runs.items()}
        handles = [Line2D([], [], **own.line()) for own in law_styles(laws, theme).values()]
        leader, _, *aids = path_handles([summaries[0].last], theme)
        figure.legend(handles=[*handles, leader, *aids], loc="outside lower center", ncols=7, fontsize=9)
    return figure


def _draw_column(column: SubFigure, summary: Summary, theme: Theme) -> dict[str, Axes]:
    axes = column.subplot_mosaic(_ROWS, height_ratios=_HEIGHTS)
    column.suptitle(summary.title, weight="bold", fontsize=12)
    draw_paths_on(axes["paths"], [summary.last], theme)
    axes["paths"].set_title(f"From above ({law_name(list(summary.runs)[-1])})", fontsize=10)
    axes["camera"].imshow(draw_seen(summary.view, theme))
    axes["camera"].set_axis_off()
    seen = [f"t = {summary.view.time_s:.1f} s", *measured_texts(summary.view)]
    axes["camera"].set_title(f"What the camera of {summary.last.meta.robot} saw", fontsize=10)
    axes["camera"].text(0.0, -0.03, ",   ".join(seen), transform=axes["camera"].transAxes, va="top", fontsize=9)
    for name, draw in _PANELS.items():
        draw(axes[name], summary.runs, theme)
        axes[name].sharex(axes["error"])
        axes[name].tick_params(labelbottom=name == "speed")
    axes["speed"].set_xlabel("time [s]")
    column.align_ylabels([axes[name] for name in _PANELS])
    return axes

"""Several experiments on one page, one row each: the distance error of every law, the last one's path and what its
camera saw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from pilotfish.camera_view import CameraView
from pilotfish.plots.camera_gif import draw_view
from pilotfish.plots.comparison import draw_errors_on
from pilotfish.plots.paths import draw_paths_on
from pilotfish.plots.style import style
from pilotfish.recording import Recording


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


def draw_overview(summaries: Sequence[Summary]) -> Figure:
    """One row an experiment."""
    with style():
        figure = Figure(figsize=(14.0, 4.2 * len(summaries)))
        rows = figure.subplots(len(summaries), 3, squeeze=False, width_ratios=(1.15, 1.0, 1.15))
        for (error, paths, camera), summary in zip(rows, summaries, strict=True):
            draw_errors_on(error, summary.runs)
            error.set_title(summary.title)
            error.set_xlabel("time [s]")
            error.set_ylabel("distance error e = $d_p$ - d [m]")
            error.legend(loc="lower right")
            draw_paths_on(paths, [summary.last])
            paths.set_title(f"From above ({list(summary.runs)[-1]})")
            camera.imshow(draw_view(summary.view))
            camera.set_axis_off()
            camera.set_title(f"What the camera of {summary.last.meta.robot} saw")
        handles, labels = rows[0][1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), fontsize=9)
    return figure

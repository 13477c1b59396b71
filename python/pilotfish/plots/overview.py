"""Several runs on one page: distance error, paths and a picture of the camera, one row a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from pilotfish.camera_view import CameraView
from pilotfish.plots.camera_gif import draw_view
from pilotfish.plots.distance_error import draw_error_on
from pilotfish.plots.paths import draw_paths_on
from pilotfish.plots.style import style
from pilotfish.recording import Recording


@dataclass(frozen=True)
class Summary:
    """One run and what its camera saw at one instant of it."""

    title: str
    recording: Recording
    view: CameraView


def draw_overview(summaries: Sequence[Summary]) -> Figure:
    """One row a run."""
    with style():
        figure = Figure(figsize=(14.0, 4.2 * len(summaries)))
        rows = figure.subplots(len(summaries), 3, squeeze=False, width_ratios=(1.15, 1.0, 1.15))
        for (error, paths, camera), summary in zip(rows, summaries, strict=True):
            draw_error_on(error, summary.recording)
            error.set_title(summary.title)
            error.set_xlabel("time [s]")
            draw_paths_on(paths, [summary.recording])
            paths.set_title("From above")
            camera.imshow(draw_view(summary.view))
            camera.set_axis_off()
            camera.set_title(f"What the camera of {summary.recording.meta.robot} saw")
        handles, labels = rows[0][1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), fontsize=9)
    return figure

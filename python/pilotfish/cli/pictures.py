"""The files a result is written to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pilotfish.camera_view import CameraView
from pilotfish.cli.console import progress
from pilotfish.experiments import Result
from pilotfish.law_names import law_name
from pilotfish.plots.comparison import draw_comparison
from pilotfish.plots.distance_error import draw_distance_error
from pilotfish.plots.gallery import Gallery, Picture
from pilotfish.plots.paths import draw_paths
from pilotfish.plots.style import DARK, LIGHT

GIF_FRAMES = 60
_OVER_TIME = (
    "From above: the true distance error and when it settled; the same in millimetres near its steady state, with what "
    "the camera measured; the bearing error; the commanded speed and turn rate."
)
_FROM_ABOVE = "The paths of the leader and of the robot that follows it, to scale, with headings and lines of sight."
_COMPARED = (
    "All laws beside each other: the distance error in metres, its RMS in millimetres on a logarithmic axis, the "
    "bearing error, and the commands. Where lines meet, the dashed ones are drawn upon the wide one."
)


def gallery(out: Path, picture_format: str, dark: bool) -> Gallery:
    """Of the options of the command line."""
    return Gallery(out, picture_format, DARK if dark else LIGHT)


def save_recording(result: Result, out: Path) -> Path:
    """The run as CSV."""
    return result.recording.to_csv(out / f"{stem_of(result)}.csv")


def save_pictures(result: Result, into: Gallery) -> list[Picture]:
    """The run over time and from above, named ``<experiment>_<law>_*``."""
    recording, theme, stem = result.recording, into.theme, stem_of(result)
    title = f"{result.experiment.title}, {law_name(result.profile)}"
    over_time, above = title + replayed(result), f"{title}: from above"
    paths = draw_paths(list(result.run.recordings.values()), above, theme)
    return [
        into.save(draw_distance_error(recording, over_time, theme), f"{stem}_distance_error", over_time, _OVER_TIME),
        into.save(paths, f"{stem}_paths", above, _FROM_ABOVE),
    ]


def save_comparison(results: Sequence[Result], into: Gallery) -> list[Picture]:
    """All that drove on one axis, if there are several."""
    grouped = by_experiment(results)
    if all(len(runs) < 2 for runs in grouped.values()):
        return []
    runs = {title: {name: result.recording for name, result in by_name.items()} for title, by_name in grouped.items()}
    return [into.save(draw_comparison(runs, into.theme), "comparison", "The laws compared", _COMPARED)]


def camera_views(result: Result, title: str) -> list[CameraView]:
    """What the camera of the result's robot saw, GIF_FRAMES of its pictures."""
    from pilotfish.harness.replay import replay_camera

    every = max(1, len(result.recording) // GIF_FRAMES)
    with progress(f"{title}, what the camera saw") as step:
        robot = result.recording.meta.robot
        return list(replay_camera(result.scenario, result.run, robot, every=every, on_progress=step))


def by_experiment(results: Sequence[Result]) -> dict[str, dict[str, Result]]:
    """Title of the experiment -> who drove -> result."""
    grouped: dict[str, dict[str, Result]] = {}
    for result in results:
        grouped.setdefault(result.experiment.title + replayed(result), {})[result.profile] = result
    return grouped


def stem_of(result: Result) -> str:
    """What the names of a result's files begin with."""
    return f"{result.experiment.name}_{result.profile}"


def replayed(result: Result) -> str:
    """Which of the paper's experiments it is, in brackets, and that it is not the paper's own run; empty if none."""
    figure = result.experiment.figure
    return f" (the paper's {figure}, simulated)" if figure else ""

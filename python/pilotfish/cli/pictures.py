"""The files a result is written to."""

from __future__ import annotations

from pathlib import Path

from pilotfish.experiments import Result
from pilotfish.plots.distance_error import draw_distance_error
from pilotfish.plots.paths import draw_paths
from pilotfish.plots.style import save


def save_result(result: Result, out: Path) -> list[Path]:
    """Recording, distance error and paths, named ``<experiment>_<profile>*``."""
    experiment, profile = result.experiment, result.profile
    stem = f"{experiment.name}_{profile}"
    title = f"{experiment.title} ({profile} profile)"
    error_title = f"{title}: distance error, as in the paper's {experiment.figure}"
    return [
        result.recording.to_csv(out / f"{stem}.csv"),
        save(draw_distance_error(result.recording, error_title), out / f"{stem}_distance_error.png"),
        save(
            draw_paths(list(result.run.recordings.values()), f"{title}: from above"),
            out / f"{stem}_paths.png",
        ),
    ]

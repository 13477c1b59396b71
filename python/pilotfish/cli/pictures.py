"""The files a result is written to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pilotfish.experiments import Result
from pilotfish.plots.comparison import draw_comparison
from pilotfish.plots.distance_error import draw_distance_error
from pilotfish.plots.paths import draw_paths
from pilotfish.plots.style import save


def save_result(result: Result, out: Path) -> list[Path]:
    """Recording, distance error and paths, named ``<experiment>_<profile>*``."""
    experiment, profile = result.experiment, result.profile
    stem = f"{experiment.name}_{profile}"
    title = f"{experiment.title} ({profile})"
    error_title = f"{title}: distance error" + (f" ({experiment.figure})" if experiment.figure else "")
    return [
        result.recording.to_csv(out / f"{stem}.csv"),
        save(draw_distance_error(result.recording, error_title), out / f"{stem}_distance_error.png"),
        save(
            draw_paths(list(result.run.recordings.values()), f"{title}: from above"),
            out / f"{stem}_paths.png",
        ),
    ]


def by_experiment(results: Sequence[Result]) -> dict[str, dict[str, Result]]:
    """Title of the experiment -> who drove -> result."""
    grouped: dict[str, dict[str, Result]] = {}
    for result in results:
        title = result.experiment.label
        grouped.setdefault(title, {})[result.profile] = result
    return grouped


def save_comparison(results: Sequence[Result], out: Path) -> list[Path]:
    """All that drove on one axis, if there are several."""
    grouped = by_experiment(results)
    if all(len(runs) < 2 for runs in grouped.values()):
        return []
    runs = {title: {name: result.recording for name, result in by_name.items()} for title, by_name in grouped.items()}
    return [save(draw_comparison(runs), out / "comparison.png")]

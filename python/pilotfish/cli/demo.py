"""``pilotfish demo``: both experiments with the real programs, and every picture of them."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import console, friendly_errors, progress
from pilotfish.cli.options import DurationOption, Law, Profiles, ProfilesOption, drivers_of, writable_folder

if TYPE_CHECKING:
    from pilotfish.camera_view import CameraView
    from pilotfish.experiments import Experiment, Result

GIF_FRAMES = 60


def demo(
    out: Annotated[
        Path, typer.Option("--out", file_okay=False, callback=writable_folder, help="Folder for everything.")
    ] = Path("out"),
    profile: ProfilesOption = Profiles.both,
    duration_s: DurationOption = None,
) -> None:
    """Run both experiments with both profiles and the real programs over LCM in lock-step; table and pictures in OUT.

    And once more, with the last profile, on a non-ideal robot (data/hardware/nonideal.yaml).

    \b
    Example
      pilotfish demo --out out
    """
    from pilotfish.cli.pictures import by_experiment, save_comparison, save_result
    from pilotfish.experiments import EXPERIMENTS, metrics_table, run_experiment
    from pilotfish.plots.camera_gif import draw_camera_gif
    from pilotfish.plots.overview import Summary, draw_overview
    from pilotfish.plots.style import save

    with friendly_errors():
        written: list[Path] = []

        def play(experiment: Experiment, driver: str) -> Result:
            with progress(f"{experiment.title}, {driver}, over LCM") as step:
                result = run_experiment(experiment, driver, duration_s=duration_s, on_progress=step)
            written.extend(save_result(result, out))
            return result

        drivers = drivers_of(profile, Law.fuzzy)
        results = [play(experiment, driver) for experiment in EXPERIMENTS.values() for driver in drivers]
        nonideal = [play(experiment.on_nonideal_robot(), drivers[-1]) for experiment in EXPERIMENTS.values()]
        summaries = []
        for title, by_name in by_experiment(results).items():
            shown = list(by_name.values())[-1]
            views = _camera_views(shown)
            gif = out / f"{shown.experiment.name}_{shown.profile}_camera.gif"
            written.append(draw_camera_gif(views, gif, shown.experiment.title))
            runs = {name: result.recording for name, result in by_name.items()}
            summaries.append(Summary(title, runs, views[len(views) // 3]))
        written.append(save(draw_overview(summaries), out / "overview.png"))
        written += save_comparison(results, out)
        written += _save_law(results[0], out)
        written.append(_save_metrics(results + nonideal, out))
        console.print(metrics_table(results))
        console.print()
        console.print(metrics_table(nonideal, "The same with slip, lag, noise and camera misalignment, not configured"))
        for file in written:
            console.print(f"wrote {file}", soft_wrap=True)


def _camera_views(result: Result) -> list[CameraView]:
    from pilotfish.harness.replay import replay_camera

    robot = result.scenario.robot().name
    every = max(1, len(result.recording) // GIF_FRAMES)
    with progress(f"{result.experiment.title}, what the camera saw") as step:
        return list(replay_camera(result.scenario, result.run, robot, every=every, on_progress=step))


def _save_law(result: Result, out: Path) -> list[Path]:
    """The fuzzy sets and the surface of the law that drove (Figs. 2 to 4)."""
    from pilotfish.coordinator import load_coordinator
    from pilotfish.plots.fuzzy_sets import draw_fuzzy_sets
    from pilotfish.plots.style import save
    from pilotfish.plots.surface import draw_surface

    law = load_coordinator(result.scenario.robot().coordinator_file).coordinator.control.law
    sets = draw_fuzzy_sets(law, "Membership functions of the shipped law (the paper's Figs. 2 to 4)")
    return [save(sets, out / "fuzzy_sets.png"), save(draw_surface(law), out / "control_surface.png")]


def _save_metrics(results: list[Result], out: Path) -> Path:
    file = out / "metrics.json"
    figures = {f"{r.experiment.name}_{r.profile}": asdict(r.metrics) for r in results}
    file.write_text(json.dumps(figures, indent=2) + "\n")
    return file

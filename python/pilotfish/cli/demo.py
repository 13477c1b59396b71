"""``pilotfish demo``: both experiments with the real programs, five robots among obstacles, every picture of them, and
a page of it all."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import console, friendly_errors, progress
from pilotfish.cli.driving_options import Law, Profiles, ProfilesOption, drivers_of
from pilotfish.cli.options import DarkOption, DurationOption, FormatOption, PictureFormat
from pilotfish.cli.outputs import OutputFolder, writable_folder

if TYPE_CHECKING:
    from pilotfish.experiments import Experiment, Result
    from pilotfish.plots.gallery import Gallery, Picture
    from pilotfish.plots.page import Section

NONIDEAL = "The same with slip, lag, noise and camera misalignment, not configured"


def demo(
    out: Annotated[
        Path, typer.Option("--out", file_okay=False, callback=writable_folder, help="Folder for everything.")
    ] = Path("out"),
    profile: ProfilesOption = Profiles.both,
    duration_s: DurationOption = None,
    picture_format: FormatOption = PictureFormat.png,
    dark: DarkOption = False,
) -> None:
    """Run both experiments with both profiles and the real programs over LCM in lock-step; tables here, pictures in
    OUT, and all of it on one page, OUT/index.html.

    And with the last profile: on a non-ideal robot (data/hardware/nonideal.yaml), and five robots in a wedge through
    obstacles. Takes two minutes.

    \b
    Examples
      pilotfish demo --out out
      pilotfish demo --out out/dark --dark
      pilotfish demo --out out/print --format pdf
    """
    from pilotfish.among_obstacles import passages
    from pilotfish.cli import demo_obstacles
    from pilotfish.cli.pictures import gallery, save_comparison, save_pictures, save_recording
    from pilotfish.experiments import EXPERIMENTS, metrics_tables

    with friendly_errors():
        into, folder = gallery(out, picture_format.value, dark), OutputFolder(out)
        drivers = drivers_of(profile, Law.fuzzy)
        ideal = [(experiment, driver) for experiment in EXPERIMENTS.values() for driver in drivers]
        runs = ideal + [(experiment.on_nonideal_robot(), drivers[-1]) for experiment in EXPERIMENTS.values()]
        in_all = len(runs) + 1
        played = [
            _play(f"run {number} of {in_all}", experiment, driver, duration_s)
            for number, (experiment, driver) in enumerate(runs, 1)
        ]
        wedge = demo_obstacles.play(f"run {in_all} of {in_all}", drivers[-1], duration_s)
        passed = passages(wedge[0].scenario, wedge[0].run)
        results, nonideal = played[: len(ideal)], played[len(ideal) :]
        data = [save_recording(result, out) for result in [*results, *nonideal, *wedge]]
        data.append(_save_metrics(results + nonideal, demo_obstacles.figures(passed, drivers[-1]), out))
        overview, films = _save_overview(results, into)
        among_obstacles = demo_obstacles.pictures(wedge, into)
        with progress("drawing") as step:
            drawn = []
            for done, result in enumerate(played, 1):
                drawn.append(save_pictures(result, into))
                step(done, len(played) + 2)
            compared = save_comparison(results, into)
            step(len(played) + 1, len(played) + 2)
            law = _save_law(results[0], into)
            step(len(played) + 2, len(played) + 2)
        chapters = {
            "Both experiments": [overview, *compared],
            "What the camera saw": films,
            "Each run": list(chain.from_iterable(drawn[: len(results)])),
            "Non-ideal robot": list(chain.from_iterable(drawn[len(results) :])),
            "The fuzzy law": law,
        }
        page = _write_page(chapters, results, nonideal, demo_obstacles.section(passed, among_obstacles), data, into)
        for table in (*metrics_tables(results), *metrics_tables(nonideal, NONIDEAL)):
            console.print(table)
        demo_obstacles.show(passed)
        pictures = [picture.file for shown in (*chapters.values(), among_obstacles) for picture in shown]
        for file in [*data, *pictures]:
            folder.wrote(file)
        console.print(f"everything on one page: {page}   {page.resolve().as_uri()}", soft_wrap=True)


def _play(which: str, experiment: Experiment, driver: str, duration_s: float | None) -> Result:
    from pilotfish.experiments import run_experiment

    with progress(f"{which}: {experiment.title}, {driver}, over LCM") as step:
        return run_experiment(experiment, driver, duration_s=duration_s, on_progress=step)


def _save_overview(results: Sequence[Result], into: Gallery) -> tuple[Picture, list[Picture]]:
    """The overview, and what the camera saw in the last run of each experiment."""
    from pilotfish.cli.pictures import by_experiment, camera_views, stem_of
    from pilotfish.law_names import law_name
    from pilotfish.plots.overview import Summary, draw_overview

    summaries, films = [], []
    for title, by_name in by_experiment(results).items():
        shown = list(by_name.values())[-1]
        views = camera_views(shown, shown.experiment.title)
        shows = (
            f"What the camera of {shown.scenario.robot().name} saw with law {law_name(shown.profile)}: every tag that "
            "was measured is outlined; above are the time, the measured distance d and bearing θ, and the status."
        )
        films.append(into.save_gif(views, f"{stem_of(shown)}_camera", shown.experiment.title, shows))
        runs = {name: result.recording for name, result in by_name.items()}
        summaries.append(Summary(title, runs, views[len(views) // 3]))
    shows = (
        "Where the robots went, one picture of the camera, and over time the distance error in metres and, as RMS on a "
        "logarithmic axis, in millimetres, the bearing error and the commanded speed."
    )
    return into.save(draw_overview(summaries, into.theme), "overview", "Overview", shows), films


def _save_law(result: Result, into: Gallery) -> list[Picture]:
    """The fuzzy sets and the surface of the law that drove."""
    from pilotfish.coordinator import load_coordinator
    from pilotfish.plots.fuzzy_sets import draw_fuzzy_sets
    from pilotfish.plots.surface import draw_surface

    law = load_coordinator(result.scenario.robot().coordinator_file).coordinator.control.law
    sets, surface = "Membership functions of the fuzzy law", "Control surface of the fuzzy law"
    sets_show = "The sets of both inputs and of the output. The rules are the paper's Table I, the shapes are ours."
    surface_shows = "The speed that the law answers, over the distance error and its change, and three sections of it."
    return [
        into.save(draw_fuzzy_sets(law, sets, into.theme), "fuzzy_sets", sets, sets_show),
        into.save(draw_surface(law, surface, into.theme), "control_surface", surface, surface_shows),
    ]


def _save_metrics(results: Sequence[Result], wedge: dict[str, dict[str, float]], out: Path) -> Path:
    from pilotfish.whole_files import write_whole

    file = out / "metrics.json"
    figures = {f"{r.experiment.name}_{r.profile}": asdict(r.metrics) for r in results} | wedge
    write_whole(file, json.dumps(figures, indent=2) + "\n")
    return file


def _write_page(
    chapters: dict[str, list[Picture]],
    results: Sequence[Result],
    nonideal: Sequence[Result],
    wedge: Section,
    data: Sequence[Path],
    into: Gallery,
) -> Path:
    from pilotfish.experiments import NOTE, metrics_rows, run_names
    from pilotfish.plots.page import Section, TextTable, write_page

    def table(runs: Sequence[Result], title: str) -> TextTable:
        return TextTable(title, [run_names(run) for run in runs], metrics_rows(runs), NOTE)

    tables = {
        "Both experiments": table(results, "Following by sight"),
        "Non-ideal robot": table(nonideal, NONIDEAL),
    }
    sections = [
        Section(title, tables=[tables[title]] if title in tables else [], pictures=pictures)
        for title, pictures in chapters.items()
    ]
    sections.insert(2, wedge)
    intro = (
        "A robot follows a leader by sight alone, on a line and on a circle, in the two experiments of the paper "
        "“Vision-based Fuzzy Coordination Control for Multiple Robots”: simulated, with the real programs, a "
        "rendered camera and LCM. Law paper is the law as published, law anticipate the same around a feed-forward of "
        "the leader's motion. A colour means the same in all pictures:"
    )
    return write_page(into.folder / "index.html", "Pilotfish: the demo", intro, sections, data, into.theme)

"""The demo's third experiment: five robots in a wedge drive through obstacles."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

from pilotfish import sim
from pilotfish.among_obstacles import Passage
from pilotfish.cli.console import console, progress
from pilotfish.cli.pictures import camera_views
from pilotfish.experiments import experiment_of, run_all_robots
from pilotfish.number_text import millimetres, signed
from pilotfish.plots.obstacles import draw_among_obstacles
from pilotfish.plots.page import Section, TextTable

if TYPE_CHECKING:
    from pilotfish.experiments import Result
    from pilotfish.plots.gallery import Gallery, Picture

SCENARIO, TITLE = "wedge_obstacles", "Five robots in a wedge through obstacles"
CAMERA = "robot3"  # the left end of the wedge, which passes most obstacles
_NOTE = (
    "Clearance: the least distance from outline to outline in the whole run. Errors: true, mean of the last 2 s. "
    "The leader's path alone is clear; robots see by camera and by a ring of 24 sonars."
)
_ROWS: tuple[tuple[str, Callable[[Passage], str]], ...] = (
    ("clearance to obstacles", lambda p: f"{p.obstacle_clearance_m:.2f} m"),
    ("clearance to other robots", lambda p: f"{p.robot_clearance_m:.2f} m"),
    ("distance error at the end", lambda p: millimetres(p.final_distance_error_m)),
    ("bearing error at the end", lambda p: f"{signed(math.degrees(p.final_bearing_error_rad), 1)}°"),
    ("frames detected", lambda p: f"{100.0 * p.frames_detected_ratio:.1f} %"),
)


def play(which: str, law: str, duration_s: float | None) -> list[Result]:
    """With the real programs over LCM; a result for each of the four robots that follow."""
    with progress(f"{which}: {TITLE}, {law}, over LCM") as step:
        return run_all_robots(experiment_of(SCENARIO), law, duration_s=duration_s, on_progress=step)


def figures(passed: Sequence[Passage], law: str) -> dict[str, dict[str, float]]:
    """Of each robot under a name of its own."""
    return {f"{SCENARIO}_{passage.robot}_{law}": asdict(passage) for passage in passed}


def table(passed: Sequence[Passage]) -> TextTable:
    """One column a robot."""
    rows = [(label, [text(passage) for passage in passed]) for label, text in _ROWS]
    return TextTable(TITLE, [[passage.robot] for passage in passed], rows, _NOTE)


def pictures(results: list[Result], into: Gallery) -> list[Picture]:
    """All from above, and what one camera saw."""
    scenario, run = results[0].scenario, results[0].run
    obstacles = sim.load_scenario(scenario.file).all_obstacles()
    above = draw_among_obstacles(list(run.recordings.values()), obstacles, TITLE, theme=into.theme)
    shows = (
        "Paths among the obstacles, with the robots' outlines every 4 s. Pale obstacles are lower than the line of "
        "sight; the others hide a leader that is behind them."
    )
    seen = next(result for result in results if result.recording.meta.robot == CAMERA)
    film = f"What the camera of {CAMERA} saw: its leader's tags are outlined; columns are the obstacles."
    return [
        into.save(above, SCENARIO, TITLE, shows),
        into.save_gif(camera_views(seen, TITLE), f"{SCENARIO}_camera", TITLE, film),
    ]


def section(passed: Sequence[Passage], shown: list[Picture]) -> Section:
    """Of the page."""
    text = (
        "The paper leaves more robots in an environment with obstacles as future work. Four coordinators, each with a "
        "camera and sonars of its own and nothing sent between them: two follow the leader, two follow those."
    )
    return Section(TITLE, text, [table(passed)], shown)


def show(passed: Sequence[Passage]) -> None:
    """The table in the terminal."""
    shown = table(passed)
    rich = Table(
        title=shown.title, title_justify="left", caption=shown.note, caption_justify="left", box=box.SIMPLE_HEAD
    )
    rich.add_column("", no_wrap=True)
    for head in shown.columns:
        rich.add_column(" ".join(head), justify="right")
    for label, texts in shown.rows:
        rich.add_row(label, *texts)
    console.print(rich)

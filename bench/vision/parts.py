"""The parts of the benchmark: each runs its comparison and says what came of it as tables, goals and JSON."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from rich.table import Table

from bench.vision import goals, sequences
from bench.vision import trackers as who
from bench.vision.accuracy import DISTANCES_M, Cells, accuracy
from bench.vision.chains import ChainFigures, look_at_chains
from bench.vision.conditions import CONDITIONS, Condition
from bench.vision.drive import drive
from bench.vision.goals import Goal
from bench.vision.resolutions import SIZES, cost_by_resolution
from bench.vision.runs import Tracker, compare
from bench.vision.scenes import VGA
from bench.vision.stages import DISTANCES_M as STAGE_DISTANCES_M
from bench.vision.stages import MODES, stage_times
from bench.vision.summary import Figures, as_json
from bench.vision.tables import accuracy_tables, chain_tables, figures_table, medians_table, stage_table, verdict_table
from bench.vision.trackers import Cast
from bench.vision.visp_images import FOCAL_PX, medians, on_visp_images, targets
from bench.vision.without_leader import wrong_leaders
from pilotfish import core

FAST = [who.TRACKED, who.ACQUIRED, who.VISP_1, who.VISP_2, who.LIBAPRILTAG, who.WHEEL, who.ARUCO_SUBPIX]
FLIPPING = [who.TRACKED, who.ACQUIRED, who.VISP_1, who.VISP_2, who.WHEEL]
ALL = [*FAST, who.ARUCO_APRILTAG]  # whose refinement takes half a second on the larger frames


@dataclass(frozen=True)
class Effort:
    """How many frames each part shows."""

    vga: int = 100  # a cell
    hd: int = 80  # a cell
    drive: int = 1000
    lens: int = 100
    far: int = 300
    head_on: int = 200
    repeats: int = 5  # of each of ViSP's pictures
    without_leader: int = 10_000
    scenes: int = 40  # that frames without a leader are made of
    resolutions: int = 60  # a frame size
    chains: int = 32  # a condition and distance
    stages: int = 200  # a distance


QUICK = Effort(
    vga=4,
    hd=2,
    drive=10,
    lens=3,
    far=4,
    head_on=4,
    repeats=2,
    without_leader=100,
    scenes=4,
    resolutions=2,
    chains=2,
    stages=4,
)


@dataclass
class Outcome:
    """What a part has to say. `cells` and `by_size` are for the charts."""

    tables: list[Table]
    goals: list[Goal]
    data: object  # for vision.json
    cells: Cells | None = None
    by_size: dict[str, dict[str, Figures]] | None = field(default=None)


@dataclass(frozen=True)
class Task:
    """What a part needs to run."""

    cast: Cast
    effort: Effort
    seed: int
    on_frame: Callable[[], None]
    conditions: tuple[Condition, ...] = CONDITIONS  # of the part `chains`


def run_accuracy(task: Task) -> Outcome:
    def trackers(camera: core.CameraModel) -> list[Tracker]:
        return task.cast.trackers(camera, ALL if camera.width == VGA.width else FAST)

    frames = {"640x480": task.effort.vga, "1280x720": task.effort.hd}
    cells = accuracy(trackers, frames, task.seed, task.on_frame)
    data = {size: {str(d): _json(figures) for d, figures in cell.items()} for size, cell in cells.items()}
    return Outcome(accuracy_tables(cells), list(goals.accuracy_goals(cells)), data, cells=cells)


def run_drive(task: Task) -> Outcome:
    trackers = task.cast.trackers(VGA, [who.TRACKED, who.ACQUIRED, who.VISP_1, who.VISP_2])
    figures = compare(trackers, drive(task.effort.drive, task.seed), task.on_frame)
    table = figures_table("drive with motion blur, 20 % of the frames with the tag partly or wholly hidden", figures)
    return Outcome([table], list(goals.drive_goals(figures)), _json(figures))


def run_lens(task: Task) -> Outcome:
    camera = sequences.DISTORTED
    shown = sequences.through_lens(task.effort.lens, task.seed)
    figures = compare(task.cast.trackers(camera, FAST), shown, task.on_frame)
    title = f"1.1 m through a lens with k1 = {camera.k1}, k2 = {camera.k2}"
    return Outcome([figures_table(title, figures)], [], _json(figures))


def run_headings(task: Task) -> Outcome:
    shown = {
        "5 m": sequences.far(task.effort.far, task.seed),
        "head-on, 2 to 4 m": sequences.head_on(task.effort.head_on, task.seed),
    }
    figures = {name: compare(task.cast.trackers(VGA, FLIPPING), shots, task.on_frame) for name, shots in shown.items()}
    tables = [figures_table(f"one tag, {name}", of_tracker) for name, of_tracker in figures.items()]
    rows = list(goals.heading_goals(figures["5 m"], figures["head-on, 2 to 4 m"]))
    return Outcome(tables, rows, {name: _json(of_tracker) for name, of_tracker in figures.items()})


def run_visp_images(task: Task) -> Outcome:
    def trackers(camera: core.CameraModel, target: who.Target) -> list[Tracker]:
        leader = core.LeaderBody([core.BodyTag(id=target.tag_id, size_m=target.size_m)])
        return Cast(task.cast.compiled, task.cast.wheels, target, leader).trackers(camera, ALL)

    by_tag = on_visp_images(trackers, task.effort.repeats, task.on_frame)
    middle = {size: medians(of_tag) for size, of_tag in by_tag.items()}
    table = medians_table("ViSP's pictures: median distance error over the five tags", middle)
    data = {size: {str(tag): _json(figures) for tag, figures in of_tag.items()} for size, of_tag in by_tag.items()}
    return Outcome([table], list(goals.visp_goals(middle)), data)


def run_without_leader(task: Task) -> Outcome:
    verdict = wrong_leaders(task.effort.without_leader, task.effort.scenes, task.seed, task.on_frame)
    return Outcome([verdict_table(verdict)], list(goals.wrong_leader_goals(verdict)), vars(verdict))


def run_resolutions(task: Task) -> Outcome:
    def trackers(camera: core.CameraModel) -> list[Tracker]:
        return task.cast.trackers(camera, [who.TRACKED, who.ACQUIRED, who.VISP_1, who.VISP_2])

    by_size = cost_by_resolution(trackers, task.effort.resolutions, task.seed, task.on_frame)
    tables = [figures_table(f"the same tag, 60 px wide, in {size}", figures) for size, figures in by_size.items()]
    data = {size: _json(figures) for size, figures in by_size.items()}
    return Outcome(tables, list(goals.resolution_goals(by_size)), data, by_size=by_size)


def run_chains(task: Task) -> Outcome:
    def trackers(camera: core.CameraModel) -> list[Tracker]:
        return task.cast.trackers(camera, FLIPPING)

    results = look_at_chains(trackers, task.conditions, task.effort.chains, task.seed, task.on_frame)
    data = {
        name: {str(d): _json(figures) for d, figures in by_distance.items()} for name, by_distance in results.items()
    }
    return Outcome(chain_tables(results), list(goals.chain_goals(results)), data)


def run_stages(task: Task) -> Outcome:
    times = stage_times(task.effort.stages, task.seed, task.on_frame)
    return Outcome([stage_table(mode, by_distance) for mode, by_distance in times.items()], [], times)


@dataclass(frozen=True)
class Part:
    """One comparison: what it is called on the progress bar, how to run it, how many frames it shows."""

    label: str
    run: Callable[[Task], Outcome]
    frames: Callable[[Effort, tuple[Condition, ...]], int]


PARTS = {
    "accuracy": Part("accuracy and time", run_accuracy, lambda effort, _: len(DISTANCES_M) * (effort.vga + effort.hd)),
    "drive": Part("drive with blur and occlusions", run_drive, lambda effort, _: effort.drive),
    "lens": Part("through a lens that distorts", run_lens, lambda effort, _: effort.lens),
    "headings": Part("headings of a single tag", run_headings, lambda effort, _: effort.far + effort.head_on),
    "visp-images": Part(
        "ViSP's pictures", run_visp_images, lambda effort, _: effort.repeats * len(FOCAL_PX) * len(targets())
    ),
    "resolutions": Part("cost by resolution", run_resolutions, lambda effort, _: effort.resolutions * len(SIZES)),
    "stages": Part(
        "where the time goes", run_stages, lambda effort, _: effort.stages * len(STAGE_DISTANCES_M) * len(MODES)
    ),
    "chains": Part(
        "cameras, light and prints that nothing models",
        run_chains,
        lambda effort, conditions: effort.chains * sum(len(condition.distances_m) for condition in conditions),
    ),
    "without-leader": Part("frames without a leader", run_without_leader, lambda effort, _: effort.without_leader),
}


def _json(figures: dict[str, Figures] | dict[str, ChainFigures]) -> dict[str, dict]:
    return {name: as_json(of_tracker) for name, of_tracker in figures.items()}

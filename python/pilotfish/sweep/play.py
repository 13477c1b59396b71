"""One run of a campaign, from its settings to its row. All that a worker needs comes with the job: no path, no clock,
no state between runs, so the row is the same wherever and whenever it is made."""

from __future__ import annotations

import hashlib
import json
import math
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish import core, sim
from pilotfish.coordinator import Coordinator, load_coordinator
from pilotfish.errors import ConfigError
from pilotfish.harness.drawn_observations import DrawnObservations, ObservationNoise
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.scenario import Scenario
from pilotfish.recording import Recording
from pilotfish.sweep.documents import Documents
from pilotfish.sweep.keys import DEFAULT_LAW, MEASUREMENTS, varied
from pilotfish.sweep.metrics import ERROR, figures, outcome

Row = dict[str, Any]
ROW_COLUMNS = ("run", "point", "repetition", "world_seed", "noise_seed", "outcome", "reason")

# The pictures of which ObservationNoise speaks.
_NOISE_FOCAL_PX = 600.0
_HALF_TAG_RAD = math.radians(2.0)


@dataclass(frozen=True)
class Job:
    """What all runs of a campaign share."""

    documents: Documents
    files: dict[str, str]  # names in documents.files, by what the campaign's file calls them
    robot: str
    rendered: bool
    duration_s: float
    metrics: tuple[str, ...]
    collision_distance_m: float
    lost_after_s: float
    seed: int
    common_seeds: bool


@dataclass(frozen=True)
class RunSpec:
    """What is this run's own."""

    index: int
    point: int
    repetition: int
    factors: dict[str, Any]
    settings: dict[str, Any]


@dataclass(frozen=True)
class Played:
    """Rows in the order of the runs, and the processor time they took."""

    rows: list[Row]
    cpu_s: float


def seeds(job: Job, spec: RunSpec) -> tuple[int, int]:
    """(of the world, of the measurements): from the campaign's seed, the point's own values and the repetition. Other
    points, their number and their order do not count; with common seeds the values do not either."""
    said = "" if job.common_seeds else json.dumps(spec.factors, sort_keys=True)
    digest = np.frombuffer(hashlib.sha256(said.encode()).digest(), dtype="<u4")
    sequence = np.random.SeedSequence([job.seed, spec.repetition, *(int(word) for word in digest)])
    world, noise = sequence.generate_state(2)
    return int(world) & 0x7FFFFFFF, int(noise)


def play_all(job: Job, specs: Sequence[RunSpec]) -> Played:
    """The rows of some runs. A run that fails has a row with its reason."""
    began_s = time.thread_time()
    with tempfile.TemporaryDirectory(prefix="pilotfish-sweep-") as name:
        folder = Path(name)
        job.documents.write_files(folder)
        rows = [play(job, spec, folder) for spec in specs]
    return Played(rows, time.thread_time() - began_s)


def play(job: Job, spec: RunSpec, folder: Path) -> Row:
    """The row of a run; ``folder`` holds the files' contents."""
    world_seed, noise_seed = seeds(job, spec)
    row: Row = {"run": spec.index, "point": spec.point, "repetition": spec.repetition, **spec.factors}
    row |= {"world_seed": world_seed, "noise_seed": noise_seed}
    try:
        recording = record(job, spec, folder)
        result, reason = outcome(recording, job.collision_distance_m, job.lost_after_s)
        return row | {"outcome": result, "reason": reason} | figures(recording, job.metrics)
    except Exception as error:  # whatever it is: the campaign goes on
        name = "" if isinstance(error, ConfigError) else f"{type(error).__name__}: "
        return failed(job, row, ERROR, name + without_folder(str(error), folder))


def failed(job: Job, row: Row, result: str, reason: str) -> Row:
    """The row without figures."""
    return row | {"outcome": result, "reason": reason} | dict.fromkeys(job.metrics)


def record(job: Job, spec: RunSpec, folder: Path) -> Recording:
    """The run itself."""
    world_seed, noise_seed = seeds(job, spec)
    scenario, world, measurements = prepared(job, spec.settings, folder)
    if "scenario.seed" not in spec.settings:
        world.seed = world_seed
    run = run_in_process(
        scenario,
        profile=str(spec.settings.get("law", DEFAULT_LAW)),
        as_configured=True,
        spec=world,
        drawn=None if job.rendered else drawn(world.robot(job.robot), measurements, noise_seed),
        duration_s=scenario.duration_s if "scenario.duration_s" in spec.settings else job.duration_s,
        reports=False,
    )
    return run.recordings[job.robot]


def prepared(job: Job, settings: Mapping[str, Any], folder: Path) -> tuple[Scenario, sim.Scenario, dict[str, float]]:
    """The scenario with these settings, read by the program's own readers: as the harness and as the simulator have
    it; and the settings of drawn measurements."""
    documents, measurements = varied(job.documents, settings)
    file = documents.write(folder)
    return Scenario.load(file), sim.load_scenario(file), measurements


def check_settings(job: Job, settings: Mapping[str, Any]) -> None:
    """ConfigError as the program's readers and constructors say it."""
    with tempfile.TemporaryDirectory(prefix="pilotfish-sweep-") as name:
        folder = Path(name)
        job.documents.write_files(folder)
        try:
            scenario, world, measurements = prepared(job, settings, folder)
            for robot in scenario.robots:
                config = load_coordinator(robot.coordinator_file).coordinator
                config.setpoint = robot.setpoint
                Coordinator(config)
            drawn(world.robot(job.robot), measurements, 0)
        except ValueError as error:  # what the compiled readers raise, and ours
            raise ConfigError(without_folder(str(error), folder)) from error


def without_folder(text: str, folder: Path) -> str:
    """A message without the name of a folder that is different in every run."""
    for pattern in (f" (in {folder}/scenario.yaml)", f"{folder}/scenario.yaml: ", f"{folder}/"):
        text = text.replace(pattern, "")
    return text


def drawn(robot: sim.RobotSpec, settings: Mapping[str, float], seed: int) -> DrawnObservations:
    """Measurements as this robot's camera makes them.

    An error of so many pixels is an angle as much smaller as the focal length is longer: all three sigmas go with
    1 / f. A tag is seen as long as it is wholly in the picture: up to the nearer edge, less half a tag."""
    for key, value in settings.items():
        known = MEASUREMENTS[key]
        if isinstance(value, bool) or not isinstance(value, int | float) or not known.low <= value <= known.high:
            raise ConfigError(
                f"measurements.{key}: {value!r} is not a number from {known.low:g} to {known.high:g} ({known.text})"
            )
    camera = robot.camera
    ratio = _NOISE_FOCAL_PX / camera.model.fx
    usual = ObservationNoise()
    sigmas = ("distance_sigma_per_m", "bearing_sigma_rad", "heading_sigma_rad_per_m")
    noise = ObservationNoise(**{name: settings.get(name, getattr(usual, name) * ratio) for name in sigmas})
    half_view_rad = _half_view_rad(camera.model) - _HALF_TAG_RAD
    if "half_view_deg" in settings:
        half_view_rad = math.radians(settings["half_view_deg"])
    return DrawnObservations(
        seed,
        noise,
        scale=settings.get("scale", 1.0),
        half_view_rad=half_view_rad,
        vibration_rad=camera.vibration_rad,
        vibration_hz=settings.get("vibration_hz"),
        drop_probability=camera.drop_probability,
    )


def _half_view_rad(camera: core.CameraModel) -> float:
    """From the optical axis to the nearer of the left and the right edge, at the height of the centre."""
    edges_px = ([-0.5, camera.cy], [camera.width - 0.5, camera.cy])
    return min(abs(math.atan(float(camera.normalize(edge)[0]))) for edge in edges_px)

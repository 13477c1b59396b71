"""The table of accuracy and time: both frame sizes, four distances, yaw from -60 to 60 degrees."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bench.vision.runs import Tracker, compare
from bench.vision.scenes import CAMERAS, Motion, Picture, Scene
from bench.vision.summary import Figures
from pilotfish import core

DISTANCES_M = (0.65, 1.1, 2.44, 5.0)
Cells = dict[str, dict[float, dict[str, Figures]]]  # size -> distance -> tracker


def frames_of_cell(camera: core.CameraModel, distance_m: float, count: int, seed: int) -> list[Picture]:
    """One cell's frames: a leader that wanders sideways at about 0.3 m/s and turns from side to side."""
    rng = np.random.default_rng([seed, camera.width, round(1000 * distance_m)])
    poses = Motion(distance_m).poses(count, rng)
    scene = Scene(camera, int(rng.integers(1, 10_000)))
    return list(scene.pictures(poses))


def accuracy(
    trackers_for: Callable[[core.CameraModel], list[Tracker]],
    frames: dict[str, int],
    seed: int,
    on_frame: Callable[[], None],
) -> Cells:
    """`trackers_for(camera)` makes new trackers for every cell; `frames`: how many, by frame size."""
    cells: Cells = {}
    for size, camera in CAMERAS.items():
        for distance_m in DISTANCES_M:
            pictures = frames_of_cell(camera, distance_m, frames[size], seed)
            cells.setdefault(size, {})[distance_m] = compare(trackers_for(camera), pictures, on_frame)
    return cells

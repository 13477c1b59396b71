"""Pictures that were not rendered here: ViSP's AprilTag benchmark with the true pose of each of its five tags (Debian's
visp-images-data). tests/vision/test_visp_dataset.py says how its intrinsics and its tag frame were found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from bench.vision.baselines import Target
from bench.vision.runs import Tracker, compare
from bench.vision.scenes import Picture, camera_of, utime_of
from bench.vision.summary import Figures
from pilotfish import core

FOLDER = Path("/usr/share/visp-images-data/ViSP-images/AprilTag/benchmark")
FOCAL_PX = {(640, 480): 700.0, (1920, 1080): 2100.0}
PAPER_M = {0: 0.25, 1: 0.25, 2: 0.25, 3: 0.125, 4: 0.125}  # with the quiet zone: 10 cells, of which the square has 8


def targets() -> list[Target]:
    """The five tags of the scene."""
    return [Target(tag_id, paper_m * 8 / 10) for tag_id, paper_m in PAPER_M.items()]


def truth(tag_id: int) -> np.ndarray:
    """cMt (4, 4). ViSP's tag frame has y up and z out of the paper."""
    return np.loadtxt(FOLDER / "640x480" / f"cMo_{tag_id}.txt") @ np.diag([1.0, -1.0, -1.0, 1.0])


def on_visp_images(
    trackers_for: Callable[[core.CameraModel, Target], Sequence[Tracker]], repeats: int, on_frame: Callable[[], None]
) -> dict[str, dict[int, dict[str, Figures]]]:
    """By frame size, tag and tracker. The same picture comes `repeats` times: a tracker acquires it, then tracks it."""
    figures: dict[str, dict[int, dict[str, Figures]]] = {}
    for (width, height), f_px in FOCAL_PX.items():
        size = f"{width}x{height}"
        image = np.array(Image.open(FOLDER / size / f"tag36_11_{size}.png").convert("L"))
        for target in targets():
            shown = [Picture(image, truth(target.tag_id), utime_of(k)) for k in range(repeats)]
            trackers = trackers_for(camera_of(width, height, f_px), target)
            figures.setdefault(size, {})[target.tag_id] = compare(trackers, shown, on_frame)
    return figures


def medians(by_tag: dict[int, dict[str, Figures]]) -> dict[str, float]:
    """Median distance error [mm] over the five tags, by tracker; NaN if it misses one."""
    names = next(iter(by_tag.values()))
    return {name: float(np.median([figures[name].median_mm for figures in by_tag.values()])) for name in names}

"""Where a frame's time goes: the observer's own stages, by its own stopwatch, of frames tracked and acquired."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from bench.vision.scenes import LEADER, VGA, Motion, Picture
from bench.vision.sequences import sequence
from pilotfish import core, vision

DISTANCES_M = (0.65, 1.1, 2.44, 5.0)
MODES = ("tracked", "acquired")

StageTimes = dict[str, dict[float, dict[str, float]]]  # by mode, distance [m] and stage: median [us]


def stage_times(count: int, seed: int, on_frame: Callable[[], None]) -> StageTimes:
    """Medians over `count` frames a distance. The first frame, which has to be found, is none of the tracked ones. The
    stopwatch costs two readings of a clock a stage, some 50 ns each."""
    pictures = {distance_m: sequence(VGA, Motion(distance_m), count + 1, seed) for distance_m in DISTANCES_M}
    return {
        mode: {distance_m: _medians(mode, shown, on_frame) for distance_m, shown in pictures.items()} for mode in MODES
    }


def _medians(mode: str, pictures: Sequence[Picture], on_frame: Callable[[], None]) -> dict[str, float]:
    observer = vision.LeaderObserver(camera=VGA, body=LEADER, config=vision.LeaderObserverConfig())
    observer.timed = True
    observer.observe(core.Frame(pictures[0].image, utime=pictures[0].utime))
    found: list[dict[str, float]] = []
    for picture in pictures[1:]:
        if mode == "acquired":
            observer.forget()
        seen = observer.observe(core.Frame(picture.image, utime=picture.utime)).observation
        if seen is not None and (seen.found_by.name == "track") == (mode == "tracked"):
            found.append(dict(observer.stage_times_us))
        on_frame()
    return {stage: float(np.median([each[stage] for each in found])) for stage in found[0]} if found else {}

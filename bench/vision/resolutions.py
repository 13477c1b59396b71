"""What a frame costs by its size, for the same tag in pixels: 60 px wide, 1.6 m away, always f = 600 px."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from bench.vision.runs import Contest, Tracker, compare_in_turns
from bench.vision.scenes import Motion, camera_of
from bench.vision.sequences import sequence
from bench.vision.summary import Figures
from pilotfish import core

SIZES = ((320, 240), (640, 480), (1280, 720), (1920, 1080))
MOTION = Motion(1.6, max_yaw_deg=30.0, sideways_share=0.12, sideways_mps=0.2)


def cost_by_resolution(
    trackers_for: Callable[[core.CameraModel], Sequence[Tracker]],
    count: int,
    seed: int,
    on_frame: Callable[[], None],
) -> dict[str, dict[str, Figures]]:
    """By frame size ("640x480") and tracker. The sizes take turns, as their times are compared."""
    contests = {}
    for width, height in SIZES:
        camera = camera_of(width, height, 600.0)
        contests[f"{width}x{height}"] = Contest(trackers_for(camera), sequence(camera, MOTION, count, seed))
    return compare_in_turns(contests, on_frame)

"""What the lines of sim_benchmark say."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import Any

import numpy as np

from bench.common.statistics import quantile

OURS = "Pilotfish"
SETTLED = 0.5  # of the frames are over: the errors are those of the rest


@dataclass(frozen=True)
class LoopFigures:
    """One closed loop: processor time per frame, and how well the robot follows once it has settled."""

    loop: str
    frames_per_s: float  # of all frames, the first included
    render_ms: float  # medians
    see_decide_ms: float
    move_ms: float
    frame_ms: float
    seen: float  # share of the frames with a measurement
    distance_rms_mm: float  # against the truth
    bearing_rms_deg: float


def loop_figures(lines: Iterable[dict[str, Any]]) -> list[LoopFigures]:
    """One row a loop, in the order of their rows."""
    by_loop: dict[str, list[dict[str, Any]]] = {}
    for line in sorted(lines, key=lambda each: (each["row"], each["frame"])):
        by_loop.setdefault(line["loop"], []).append(line)
    return [_figures_of(loop, own) for loop, own in by_loop.items()]


def _figures_of(loop: str, lines: Sequence[dict[str, Any]]) -> LoopFigures:
    frames_ms = [1e-6 * (line["move_ns"] + line["render_ns"] + line["see_decide_ns"]) for line in lines]
    settled = lines[int(SETTLED * len(lines)) :]
    return LoopFigures(
        loop,
        1e3 * len(lines) / sum(frames_ms),
        *(1e-6 * median(line[f"{stage}_ns"] for line in lines) for stage in ("render", "see_decide", "move")),
        median(frames_ms),
        fmean(line["seen"] for line in lines),
        1e3 * _rms(line["distance_error_m"] for line in settled),
        math.degrees(_rms(line["bearing_error_rad"] for line in settled)),
    )


def ratios(rows: Sequence[LoopFigures]) -> dict[str, float]:
    """How many times as many frames per second ours plays as each."""
    (ours,) = (row for row in rows if row.loop == OURS)
    return {row.loop: ours.frames_per_s / row.frames_per_s for row in rows}


def exponent(robots: Sequence[int], cost: Sequence[float]) -> float:
    """b of cost ~ robots^b, by least squares of the logarithms: 1 if the cost is linear in the number of robots."""
    return float(np.polyfit(np.log(robots), np.log(cost), 1)[0])


@dataclass(frozen=True)
class CrowdFigures:
    """Many robots in one process."""

    robots: int
    threads: int
    real_time_factor: float  # by the clock: simulated time over the time it took
    on_free_processors: float  # the same, were the processor time all that counts: one processor a thread
    render_ms: float  # processor time per robot and frame
    answer_ms: float
    frame_p50_ms: float  # by the clock, all robots
    frame_p99_ms: float
    made_s: float
    seen: float
    worst_rms_mm: float  # of the distance error, last quarter, worst robot
    pictures: str  # hash of all

    @property
    def robot_frame_ms(self) -> float:
        return self.render_ms + self.answer_ms


def crowd_figures(said: dict[str, Any]) -> CrowdFigures:
    """Of what sim_benchmark crowd prints."""
    pictures = said["robots"] * said["frames"]
    frames_ms = [1e-6 * each for each in said["frame_ns"]]
    cpu_s = 1e-9 * (said["capture_ns"] + said["step_ns"] + said["move_ns"])
    return CrowdFigures(
        robots=said["robots"],
        threads=said["threads"],
        real_time_factor=said["simulated_s"] / said["elapsed_s"],
        on_free_processors=said["simulated_s"] / (cpu_s / min(said["threads"], said["robots"])),
        render_ms=1e-6 * said["capture_ns"] / pictures,
        answer_ms=1e-6 * said["step_ns"] / pictures,
        frame_p50_ms=quantile(frames_ms, 0.5),
        frame_p99_ms=quantile(frames_ms, 0.99),
        made_s=said["made_s"],
        seen=said["seen"],
        worst_rms_mm=1e3 * said["worst_rms_distance_error_m"],
        pictures=said["pictures"],
    )


def _rms(values: Iterable[float]) -> float:
    squares = [value * value for value in values]
    return math.sqrt(fmean(squares)) if squares else math.nan

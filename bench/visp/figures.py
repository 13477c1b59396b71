"""From the lines of visp_benchmark to one row a tracker."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from statistics import fmean, median

import numpy as np

from bench.common.statistics import quantile

CONSISTENT = 0.1  # of the true distance: farther off, it was something else that was seen
FLIPPED_DEG = 10.0  # a tag seen from afar has two poses; farther off, it is the other one


@dataclass(frozen=True)
class Figures:
    tracker: str
    median_ms: float
    mean_ms: float
    p95_ms: float
    seen: float  # share of the tags in all pictures
    translation_rms_mm: float
    bias_mm: tuple[float, float, float]  # mean error of the translation, camera x, y, z
    rotation_rms_deg: float
    flipped: int  # poses more than FLIPPED_DEG off
    unflipped_rms_deg: float  # the same without these


def rotation_error_deg(pose: np.ndarray, truth: np.ndarray) -> float:
    """Angle of the rotation that lies between two poses, (4, 4) each."""
    between = pose[:3, :3].T @ truth[:3, :3]
    axis = [between[2, 1] - between[1, 2], between[0, 2] - between[2, 0], between[1, 0] - between[0, 1]]
    return math.degrees(math.atan2(np.linalg.norm(axis), np.trace(between) - 1.0))


def rms(values: Iterable[float]) -> float:
    squares = [value * value for value in values]
    return math.sqrt(fmean(squares)) if squares else math.nan


def figures_of(tracker: str, lines: list[dict]) -> Figures:
    times_ms = [line["elapsed_ns"] * 1e-6 for line in lines]
    total, translations, rotations = 0, [], []
    for tag in (tag for line in lines for tag in line["tags"]):
        total += 1
        if tag["pose"] is None:
            continue
        pose, truth = (np.reshape(tag[key], (4, 4)) for key in ("pose", "truth"))
        error = pose[:3, 3] - truth[:3, 3]
        if np.linalg.norm(error) > CONSISTENT * np.linalg.norm(truth[:3, 3]):
            continue
        translations.append(1e3 * error)
        rotations.append(rotation_error_deg(pose, truth))
    unflipped = [angle for angle in rotations if angle <= FLIPPED_DEG]
    bias = np.mean(translations, axis=0) if translations else np.full(3, np.nan)
    return Figures(
        tracker,
        median(times_ms),
        fmean(times_ms),
        quantile(times_ms, 0.95),
        len(translations) / total,
        rms(np.linalg.norm(translations, axis=1)) if translations else math.nan,
        tuple(map(float, bias)),
        rms(rotations),
        len(rotations) - len(unflipped),
        rms(unflipped),
    )


def all_figures(lines: list[dict]) -> list[Figures]:
    """In the order of their rows."""
    by_tracker: dict[str, list[dict]] = {}
    for line in sorted(lines, key=lambda each: each["row"]):
        by_tracker.setdefault(line["tracker"], []).append(line)
    return [figures_of(tracker, theirs) for tracker, theirs in by_tracker.items()]

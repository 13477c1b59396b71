"""From the answers of one tracker to a sequence of frames to its figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from bench.vision.answers import Answer, errors_of

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

WRONG_DEG = 10.0  # a normal or heading that is further off is a flip, not noise
CLOSE_SHARE = 0.1  # a leader counts as seen if its distance is right to a tenth


@dataclass(frozen=True)
class Figures:
    """Of one tracker in one sequence. Errors are over the frames in which it saw the leader; NaN if it never did."""

    frames: int
    seen: float  # share of the frames with an answer whose distance is right to a tenth
    median_mm: float  # of |distance error|
    p95_mm: float
    bias_mm: float  # median of the distance error with its sign
    normals_wrong: float  # share of the answers
    headings_wrong: float  # share of the answers
    median_ms: float  # per frame, seen or not
    cold_ms: float  # the same of the first frames of the bursts: another tracker has just used the caches
    found_by: dict[str, int]


def figures_of(answers: Sequence[Answer], truths: Sequence[np.ndarray], burst: int = 1) -> Figures:
    """`truths`: cMt (4, 4) of each frame; `burst`: how many frames a tracker looked at in a row."""
    errors = [errors_of(answer, truth) for answer, truth in zip(answers, truths, strict=True)]
    distance_mm = 1e3 * np.array([e.distance_m for e in errors])
    allowed_mm = 1e3 * CLOSE_SHARE * np.array([np.linalg.norm(truth[:3, 3]) for truth in truths])
    answered = np.isfinite(distance_mm)
    elapsed_ms = np.array([answer.elapsed_ns for answer in answers]) / 1e6
    found_by: dict[str, int] = {}
    for answer in answers:
        if answer.cMt is not None:
            found_by[answer.found_by] = found_by.get(answer.found_by, 0) + 1
    return Figures(
        frames=len(errors),
        seen=float(np.mean(np.abs(np.where(answered, distance_mm, np.inf)) <= allowed_mm)),
        median_mm=percentile(np.abs(distance_mm[answered]), 50),
        p95_mm=percentile(np.abs(distance_mm[answered]), 95),
        bias_mm=percentile(distance_mm[answered], 50),
        normals_wrong=share_beyond([e.normal_deg for e in errors], WRONG_DEG),
        headings_wrong=share_beyond([e.heading_deg for e in errors], WRONG_DEG),
        median_ms=percentile(elapsed_ms, 50),
        cold_ms=percentile(elapsed_ms[::burst], 50),
        found_by=found_by,
    )


def percentile(values: np.ndarray, percent: float) -> float:
    """NaN if there are no values."""
    return float(np.percentile(values, percent)) if len(values) else float("nan")


def share_beyond(values: Sequence[float], limit: float) -> float:
    """Share of |value| > limit among those that are not NaN; NaN if all are."""
    known = np.abs([value for value in values if np.isfinite(value)])
    return float(np.mean(known > limit)) if len(known) else float("nan")


def ratio(ours: float, theirs: float) -> float:
    """ours / theirs; NaN if theirs is zero or unknown."""
    return ours / theirs if theirs and np.isfinite(theirs) else float("nan")


def as_json(figures: DataclassInstance) -> dict:
    """NaN becomes null: JSON has no NaN."""
    return {
        key: None if isinstance(value, float) and np.isnan(value) else value for key, value in asdict(figures).items()
    }

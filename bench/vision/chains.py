"""Unmodelled conditions: which trackers see the leader, how far off, and whether the covariance says so."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bench.vision.answers import Answer, Claim, errors_of
from bench.vision.conditions import Condition
from bench.vision.runs import Tracker
from bench.vision.scenes import Picture
from bench.vision.summary import percentile
from pilotfish import core

CLOSE_SHARE, WRONG_DEG, WRONG_SIGMAS = 0.1, 8.0, 5.0
Results = dict[str, dict[float, dict[str, "ChainFigures"]]]  # condition -> distance -> tracker


@dataclass(frozen=True)
class ChainFigures:
    """Of one tracker in one condition at one distance. Errors are over the frames with an answer."""

    frames: int
    seen: float  # share with an answer whose distance is right to a tenth
    median_mm: float  # of |distance error|
    p95_mm: float
    median_deg: float  # of |heading error|
    p95_deg: float
    chi2: float  # mean of the squared error of (d, theta, psi) in claimed standard deviations, per degree of freedom
    median_chi2: float  # median, over that of a true covariance
    wrong: int  # answers more than 8 degrees off
    sure_and_wrong: int  # more than 5 claimed standard deviations off; baselines claim none
    median_ms: float


def figures_in(answers: Sequence[Answer], truths: Sequence[np.ndarray]) -> ChainFigures:
    """`truths`: cMt (4, 4) of each frame."""
    errors = [errors_of(answer, truth) for answer, truth in zip(answers, truths, strict=True)]
    mm = 1e3 * np.array([e.distance_m for e in errors])
    heading = np.abs([e.heading_deg for e in errors])
    allowed_mm = 1e3 * CLOSE_SHARE * np.array([np.linalg.norm(truth[:3, 3]) for truth in truths])
    answered = np.isfinite(mm)
    claims = [(a.claim, truth) for a, truth in zip(answers, truths, strict=True) if a.claim is not None]
    offs = [off_by(claim, truth) for claim, truth in claims]
    squared = np.array([off @ np.linalg.solve(c.covariance, off) / 3 for (c, _), off in zip(claims, offs, strict=True)])
    sigmas = np.array(
        [np.max(np.abs(off) / np.sqrt(np.diag(c.covariance))) for (c, _), off in zip(claims, offs, strict=True)]
    )
    wrong = answered & (np.where(answered, heading, 0.0) > WRONG_DEG)
    return ChainFigures(
        frames=len(errors),
        seen=float(np.mean(np.abs(np.where(answered, mm, np.inf)) <= allowed_mm)),
        median_mm=percentile(np.abs(mm[answered]), 50),
        p95_mm=percentile(np.abs(mm[answered]), 95),
        median_deg=percentile(heading[answered], 50),
        p95_deg=percentile(heading[answered], 95),
        chi2=float(np.mean(squared)) if len(squared) else float("nan"),
        median_chi2=percentile(squared, 50) / 0.7887,  # 2.366 / 3: the median of chi-squared with 3 degrees of freedom
        wrong=int(wrong.sum()),
        sure_and_wrong=int(np.sum(sigmas > WRONG_SIGMAS)),
        median_ms=percentile(np.array([answer.elapsed_ns for answer in answers]) / 1e6, 50),
    )


def off_by(claim: Claim, cMt: np.ndarray) -> np.ndarray:
    """(3,): (d, theta, psi) less the truth of a leader whose tag hangs at its origin, seen by a level camera."""
    x, _, z = cMt[:3, 3]
    heading = np.arctan2(-cMt[0, 2], cMt[2, 2])
    off = claim.value - [np.hypot(x, z), np.arctan2(-x, z), heading]
    return np.array([off[0], *(np.angle(np.exp(1j * off[1:])))])


def look_at_chains(
    trackers_for: Callable[[core.CameraModel], list[Tracker]],
    conditions: Sequence[Condition],
    count: int,
    seed: int,
    on_frame: Callable[[], None],
) -> Results:
    """`count` frames of each condition at each of its distances; all trackers get the same frames."""
    results: Results = {}
    for condition in conditions:
        for distance_m in condition.distances_m:
            trackers = trackers_for(condition.camera)
            answers: dict[str, list[Answer]] = {tracker.name: [] for tracker in trackers}
            shown: list[Picture] = []
            for picture in condition.pictures(distance_m, count, seed):
                shown.append(picture)
                for tracker in trackers:
                    answers[tracker.name].append(tracker.track(picture.image, picture.utime))
                on_frame()
            truths = [picture.cMt for picture in shown]
            by_tracker = {name: figures_in(given, truths) for name, given in answers.items()}
            results.setdefault(condition.name, {})[distance_m] = by_tracker
    return results

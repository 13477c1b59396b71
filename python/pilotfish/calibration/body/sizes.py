"""Whether the configured sizes are consistent with each other.

The pictures alone leave one scale free: all sizes and all distances may be multiplied by the same factor. But between
the tags of one body they do say which is how much larger, through the parallax of its turning: first roughly, pair by
pair and before there is a layout (a size that is far off would bend it beyond mending), then exactly, in the bundle.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import splu

from pilotfish.calibration.body.bundle import Bundle, Estimate
from pilotfish.calibration.body.pairs import Pair
from pilotfish.calibration.body.sightings import Sightings
from pilotfish.core import CameraModel
from pilotfish.errors import BodyLearningError

MIN_VOTERS = 6
REFUSE_ROUGHLY_BEYOND = 0.15
REFUSE_BEYOND = 0.03  # a wrong number; less is a ruler's error
WARN_BEYOND = 0.005  # 0.8 mm of 0.16 m, and 6 mm at 1.2 m
SIGMAS = 5.0
ROBUST_SCALE_PX = 1.0


def check_sizes_roughly(sightings: Sightings, pairs: list[Pair]) -> None:
    """BodyLearningError if some tag is larger or smaller than configured by more than 15 %."""
    tags = len(sightings.ids)
    pairs = [pair for pair in pairs if pair.voters >= MIN_VOTERS]
    rows, logs = np.zeros((len(pairs) + 1, tags)), np.zeros(len(pairs) + 1)
    for k, pair in enumerate(pairs):
        weight = np.sqrt(pair.voters)
        rows[k, [pair.a, pair.b]], logs[k] = [-weight, weight], weight * np.log(pair.b_larger_by)
    rows[-1] = 1e-3  # the scale that is free: about none
    log_scale = np.linalg.lstsq(rows, logs, rcond=None)[0]
    _check(sightings, log_scale, np.zeros(tags), REFUSE_ROUGHLY_BEYOND, 0)


def check_sizes(camera: CameraModel, sightings: Sightings, estimate: Estimate, reference: int) -> tuple[str, ...]:
    """Warnings about tags that are larger or smaller than configured; BodyLearningError if by more than 3 %."""
    log_scale, sigma = _measured(camera, sightings, estimate, reference)
    return _check(sightings, log_scale, sigma, REFUSE_BEYOND, reference)


def _check(
    sightings: Sightings, log_scale: np.ndarray, sigma: np.ndarray, refuse_beyond: float, reference: int
) -> tuple[str, ...]:
    # Whose size is wrong if they do not fit? Most are right: the median tag is. Of two, neither can be identified.
    two = len(log_scale) == 2
    wrong_by = np.exp(log_scale - (log_scale[reference] if two else np.median(log_scale))) - 1.0
    certain = np.abs(wrong_by) > SIGMAS * sigma
    findings = [
        f"tag {tag_id}: {size:.4g} m configured, {size * (1.0 + wrong):.3g} m measured"
        for tag_id, size, wrong in zip(sightings.ids, sightings.sizes_m, wrong_by, strict=True)
    ]
    refused = np.flatnonzero(certain & (np.abs(wrong_by) > refuse_beyond))
    if len(refused):
        raise BodyLearningError(
            "the sizes do not fit together; "
            + "; ".join(findings[k] for k in refused)
            + (f" if tag {sightings.ids[reference]}'s is right" if two else " if most others are right")
            + ". Measure the sides of the black squares and give them with --tag-size ID=METRES"
        )
    return tuple(findings[k] for k in np.flatnonzero(certain & (np.abs(wrong_by) > WARN_BEYOND)))


def _measured(
    camera: CameraModel, sightings: Sightings, estimate: Estimate, reference: int
) -> tuple[np.ndarray, np.ndarray]:
    """log of the measured over the configured size (T,), the reference's being 0, and its standard deviation (T,)."""
    others = np.array([tag for tag in range(len(sightings.ids)) if tag != reference], dtype=int)
    log_scale, sigma = np.zeros(len(sightings.ids)), np.zeros(len(sightings.ids))
    if not len(others):
        return log_scale, sigma
    bundle = Bundle(camera, sightings, estimate, reference, free_sizes=True)
    found = bundle.estimate(bundle.solve(robust_scale_px=ROBUST_SCALE_PX))
    bundle = Bundle(camera, sightings, found, reference, free_sizes=True)
    x = np.zeros(bundle.unknowns)
    jacobian = bundle.jacobian(x)
    of_sizes = np.zeros((bundle.unknowns, len(others)))
    of_sizes[-len(others) :] = np.eye(len(others))
    variance = np.diag(splu((jacobian.T @ jacobian).tocsc()).solve(of_sizes)[-len(others) :])
    noise_px = 1.4826 * np.median(np.abs(bundle.residuals(x)))
    log_scale[others], sigma[others] = found.log_scale[others], noise_px * np.sqrt(variance)
    sigma[reference] = sigma[others].max()
    return log_scale, sigma

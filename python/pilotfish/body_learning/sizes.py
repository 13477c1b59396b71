"""Whether the sizes that were said fit together.

The pictures alone leave one scale free: all sizes and all distances may be multiplied by the same factor. But between
the tags of one body they do say which is how much larger, through the parallax of its turning.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import splu

from pilotfish.body_learning.bundle import Bundle, Estimate
from pilotfish.body_learning.sightings import Sightings
from pilotfish.core import CameraModel
from pilotfish.errors import BodyLearningError

ROBUST_SCALE_PX = 1.0
REFUSE_BEYOND = 0.03  # a wrong number; less is a ruler's error
WARN_BEYOND = 0.005  # 0.8 mm of 0.16 m, and 6 mm at 1.2 m
SIGMAS = 5.0


def check_sizes(camera: CameraModel, sightings: Sightings, estimate: Estimate, reference: int) -> tuple[str, ...]:
    """Warnings about tags that are larger or smaller than was said; BodyLearningError if by more than 3 %."""
    log_scale, sigma = _measured(camera, sightings, estimate, reference)
    # Whose size is wrong if they do not fit? Most are right: the median tag is.
    wrong_by = np.exp(log_scale - np.median(log_scale)) - 1.0
    # If there are but two, the median is between them, and neither can be blamed.
    if len(log_scale) == 2:
        wrong_by = np.exp(log_scale) - 1.0
    certain = np.abs(wrong_by) > SIGMAS * sigma
    said = [
        f"tag {tag_id}: {size:.4g} m was said, it looks like {size * (1.0 + wrong):.4g} m"
        for tag_id, size, wrong in zip(sightings.ids, sightings.sizes_m, wrong_by, strict=True)
    ]
    refused = np.flatnonzero(certain & (np.abs(wrong_by) > REFUSE_BEYOND))
    if len(refused):
        raise BodyLearningError(
            "the sizes do not fit together; "
            + "; ".join(said[k] for k in refused)
            + (f" if tag {sightings.ids[reference]}'s is right" if len(log_scale) == 2 else " if most others are right")
            + ". Measure the sides of the black squares and give them with --tag-size ID=METRES"
        )
    return tuple(said[k] for k in np.flatnonzero(certain & (np.abs(wrong_by) > WARN_BEYOND)))


def _measured(
    camera: CameraModel, sightings: Sightings, estimate: Estimate, reference: int
) -> tuple[np.ndarray, np.ndarray]:
    """log of the measured over the said size (T,), the reference's being 0, and its standard deviation (T,)."""
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

"""How well each tag's pose on the body is known, by drawing what else the corners might have been.

With residuals of standard deviation s, x solving (J^T J) x = J^T e for e ~ N(0, s^2) has exactly the covariance
s^2 (J^T J)^-1 of least squares. Each draw of frames and tags goes the same way as the estimate, through the turning
axis to the base frame. How the wheels slip while the robot turns is not in the corners but in which frames there were:
each draw also weighs blocks of successive frames anew (a Bayesian bootstrap, exponential weights). What noise there is
in the frames counts twice for the axis then, so its part is rather too large. What corners have in common in every
frame (a detector that sees all tags a little too small, a calibration that is a little off) is not in it.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import splu

from pilotfish.calibration.body.adjustment import Adjustment
from pilotfish.calibration.body.base_frame import Base, base_from_reference
from pilotfish.calibration.body.rigid import step_between

DRAWS = 200  # a standard deviation from 200 draws is known to 1 / sqrt(2 * 200) = 5 %
BLOCKS = 12


def tag_covariances(adjustment: Adjustment, base: Base, bMt: np.ndarray, *, seed: int = 1) -> np.ndarray:
    """(T, 6, 6) of each tag's step (v, w) in its own frame, from the estimate ``bMt`` (T, 4, 4)."""
    rng = np.random.default_rng(seed)
    bundle, ids = adjustment.bundle, adjustment.sightings.ids
    x = np.zeros(bundle.unknowns)
    jacobian, residuals = bundle.jacobian(x), bundle.residuals(x)
    sigma_px = np.sqrt((residuals**2).sum() / max(len(residuals) - bundle.unknowns, 1))
    solver = splu((jacobian.T @ jacobian).tocsc())
    noise = rng.normal(0.0, sigma_px, (len(residuals), DRAWS))
    frames = len(adjustment.estimate.cMr)
    block = np.arange(frames) * BLOCKS // frames
    steps = []
    for drawn in solver.solve(jacobian.T @ noise).T:
        estimate = bundle.estimate(drawn)
        weights = rng.exponential(size=BLOCKS)[block]
        bMr, _ = base_from_reference(base, estimate.cMr, estimate.rMt, ids, weights)
        steps.append(step_between(bMt, bMr @ estimate.rMt))
    steps = np.array(steps)  # draw x tag x 6
    return np.einsum("dta,dtb->tab", steps, steps) / DRAWS

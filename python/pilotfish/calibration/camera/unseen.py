"""The test that a calibration cannot pass by overfitting: views that took no part in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.camera.fit import MIN_VIEWS, Fit, fit_lens, fit_pose, rms
from pilotfish.calibration.camera.views import BoardView

FOLDS = 5
# A pose of its own takes up six of a view's 2 P residuals; what is left of unit variance is (2 P - 6) / 2 P.
POSE_UNKNOWNS = 6


@dataclass(frozen=True)
class Unseen:
    """``rms_px``: over the corners of all views, each explained by a lens that was fitted without it; ``view_rms_px``
    (V,): of each view. Both corrected for the pose that is fitted to the view itself. ``folds``: how many fits."""

    rms_px: float
    view_rms_px: np.ndarray
    folds: int


def unseen_views(views: Sequence[BoardView], fit: Fit) -> Unseen | None:
    """Every fifth view in turn is left out (k-fold cross-validation). None if too few views would be left."""
    folds = min(FOLDS, len(views))
    if len(views) - -(-len(views) // folds) < MIN_VIEWS:
        return None
    size = (fit.lens.width, fit.lens.height)
    squares, counts = np.zeros(len(views)), np.zeros(len(views))
    for fold in range(folds):
        kept = [k for k in range(len(views)) if k % folds != fold]
        without = fit_lens(
            [views[k] for k in kept], size, fit.lens.model, with_k3=bool(fit.free[-1]), start=fit.lens
        ).lens
        for k in range(fold, len(views), folds):
            _, _, residuals = fit_pose(without, views[k], fit.rotations[k], fit.translations_m[k])
            squares[k] = len(views[k]) * rms(residuals) ** 2
            counts[k] = len(views[k]) - POSE_UNKNOWNS / 2
    return Unseen(float(np.sqrt(squares.sum() / counts.sum())), np.sqrt(squares / counts), folds)

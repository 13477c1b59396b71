"""Whether the other lens model explains the same corners better than the one that was asked for.

A wrong model is not seen in its RMS error: it bends until it fits where the board has been (a pinhole camera fitted as
a fisheye: 0.03 px where its corners are known to 0.005 px), and is off by pixels elsewhere. Two things are compared:

- how much: the ratio of the residuals' standard deviations, sigma = sqrt(sum e^2 / (2 N - 6 V - p)), with N corners in
  V views of 6 unknowns each and p parameters of the lens;
- whether by chance: the models are not nested, so Vuong's test (1989), by views, since the noise within a view may be
  common to its corners. With a noise of each view's own the log likelihoods differ by d_v = log(sum e_own^2 /
  sum e_other^2), up to a factor; its mean is 0 if both models are equally far from the truth, and then
  z = sqrt(V) mean(d) / std(d) is about normal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.camera.fit import Fit, fit_lens
from pilotfish.calibration.camera.lens import MODELS
from pilotfish.calibration.camera.views import BoardView
from pilotfish.errors import CalibrationError

CLEAR_Z = 3.0
_POSE_UNKNOWNS = 6


@dataclass(frozen=True)
class OtherModel:
    """The ``model`` that was not asked for, fitted to the same corners. ``times_better``: sigma of the model that was
    over sigma of this; ``z``: how clearly it is better (positive) or worse, in standard deviations."""

    model: str
    rms_px: float
    times_better: float
    z: float

    @property
    def clearly_better_by(self) -> float:
        """``times_better`` if that is not by chance, else 1."""
        return self.times_better if self.z > CLEAR_Z and self.times_better > 1.0 else 1.0


def compare_models(views: Sequence[BoardView], fit: Fit) -> OtherModel | None:
    """The other of the two models of ``MODELS``, fitted to the views of ``fit``; None if it cannot be."""
    (name,) = set(MODELS) - {fit.lens.model}
    try:
        other = fit_lens(views, (fit.lens.width, fit.lens.height), name)
    except CalibrationError:
        return None
    own_sigma, other_sigma = _sigma_px(fit), _sigma_px(other)
    if not np.isfinite([own_sigma, other_sigma]).all() or other_sigma == 0.0:
        return None
    pairs = zip(fit.residuals_px, other.residuals_px, strict=True)
    gained = np.array([np.log((own**2).sum() / (others**2).sum()) for own, others in pairs])
    spread = float(gained.std(ddof=1))
    z = float(np.sqrt(len(gained)) * gained.mean() / spread) if spread > 0.0 else 0.0
    return OtherModel(name, other.rms_px, own_sigma / other_sigma, z)


def _sigma_px(fit: Fit) -> float:
    """Of one coordinate of a corner."""
    squares = sum(float((each**2).sum()) for each in fit.residuals_px)
    measured = sum(each.size for each in fit.residuals_px)
    unknown = _POSE_UNKNOWNS * len(fit.residuals_px) + int(fit.free.sum())
    return float(np.sqrt(squares / (measured - unknown))) if measured > unknown else float("nan")

"""What a calibration is worth, in plain words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.board import Board
from pilotfish.calibration.camera.coverage import TILTED_DEG, Coverage, Tilts
from pilotfish.calibration.camera.fit import Fit
from pilotfish.calibration.camera.other_model import OtherModel
from pilotfish.calibration.camera.views import BLURRED, Rejected
from pilotfish.calibration.covariance import Uncertainty

GOOD, USABLE, AGAIN = "good", "usable", "do again"
_ORDER = (GOOD, USABLE, AGAIN)

# (limit of good, limit of usable) of what should be small; and of what should be large.
FOCAL_SHARE = (0.001, 0.005)  # 0.1 %: 1 mm of distance at 1 m
CENTRE_PX = (1.0, 4.0)
RMS_PX = (0.3, 1.0)
UNSEEN_FACTOR = (1.5, 2.5)  # of the RMS of unseen views over the used ones'; only above UNSEEN_FLOOR_PX
UNSEEN_FLOOR_PX = 0.05
VIEWS = (15, 8)
COVERED_SHARE = (0.7, 0.4)
TILTED_VIEWS = (5, 3)
BLUR_PX = (1.5, 3.0)
OTHER_MODEL_FACTOR = (1.03, 1.5)  # by which the other lens model may fit better
MARKER_SHARE_OFF = 0.12  # relative; OpenCV sees markers some 4 % too small
MANY_REJECTED = 0.3


@dataclass(frozen=True)
class Verdict:
    """``grade``: good, usable or do again; ``reasons``: what keeps it from a better one and what to do about it;
    ``notes``: what else should be looked at."""

    grade: str
    reasons: tuple[str, ...]
    notes: tuple[str, ...] = ()


class _Judge:
    def __init__(self) -> None:
        self.grade = GOOD
        self.reasons: list[str] = []

    def at_most(self, value: float, limits: tuple[float, float], reason: str) -> None:
        self._say(0 if value <= limits[0] else 1 if value <= limits[1] else 2, reason)

    def at_least(self, value: float, limits: tuple[float, float], reason: str) -> None:
        self._say(0 if value >= limits[0] else 1 if value >= limits[1] else 2, reason)

    def _say(self, place: int, reason: str) -> None:
        if place:
            self.reasons.append(reason)
            self.grade = max(self.grade, _ORDER[place], key=_ORDER.index)


def judge(
    fit: Fit,
    known: Uncertainty,
    coverage: Coverage,
    tilts: Tilts,
    unseen_rms_px: float,
    blur_px: float,
    rejected: Sequence[Rejected] = (),
    other: OtherModel | None = None,
) -> Verdict:
    """The verdict on a fit and its uncertainty; ``blur_px``: median of the views'; ``other``: the other lens model on
    the same corners."""
    judge_ = _Judge()
    lens, sigma = fit.lens, known.sigma
    views = len(fit.residuals_px)
    judge_.at_least(views, VIEWS, f"{views} views were used; {VIEWS[0]} or more are good: take more")
    empty = coverage.empty_regions
    if empty:
        judge_.at_most(len(empty), (0, 3), f"no corners in the {_listed(empty)} of the picture: hold the board there")
    judge_.at_least(
        coverage.share, COVERED_SHARE, f"{coverage.share:.0%} of the picture was covered: hold the board all over it"
    )
    focal = float(max(sigma[0] / lens.fx, sigma[1] / lens.fy))
    uncertain = f"focal length uncertain ± {focal * 100:.2g} %"
    if tilts.tilted < TILTED_VIEWS[0]:
        count = "no" if tilts.tilted == 0 else f"only {tilts.tilted}"
        judge_.at_least(
            tilts.tilted, TILTED_VIEWS, f"{count} tilted views ({TILTED_DEG:.0f} degrees or more): {uncertain}"
        )
    elif len(tilts.sides) < 2:
        missing = "up/down" if tilts.sides == ("left/right",) else "left/right"
        judge_.at_least(0, (1, 0), f"tilted views to one side only: tilt the board {missing}, too")
    judge_.at_most(focal, FOCAL_SHARE, f"{uncertain}: more tilted views (20 to 45 degrees), nearer ones")
    centre = float(max(sigma[2], sigma[3]))
    judge_.at_most(
        centre,
        CENTRE_PX,
        f"principal point uncertain ± {centre:.2g} px: views tilted to all sides, and some with the board turned by 90 "
        "degrees in its plane",
    )
    judge_.at_most(
        fit.rms_px,
        RMS_PX,
        f"the corners are off by {fit.rms_px:.2f} px (RMS): is the board flat and printed true, were it and the camera "
        "still, and is this the right lens model?",
    )
    if other is not None:
        judge_.at_most(other.clearly_better_by, OTHER_MODEL_FACTOR, better_model_reason(fit.lens.model, other))
    if unseen_rms_px > UNSEEN_FLOOR_PX and fit.rms_px > 0:
        judge_.at_most(
            unseen_rms_px / fit.rms_px,
            UNSEEN_FACTOR,
            f"views that were not used fit worse ({unseen_rms_px:.2f} px) than those that were ({fit.rms_px:.2f} px): "
            "take more views, more different ones",
        )
    judge_.at_most(blur_px, BLUR_PX, f"the pictures are blurred ({blur_px:.1f} px): focus, more light, hold still")
    return Verdict(judge_.grade, tuple(judge_.reasons), _notes(views, rejected))


def better_model_reason(model: str, other: OtherModel) -> str:
    """What to do where the other model fits better than ``model``."""
    return (
        f"the {other.model} model fits {other.times_better:.2g} times better than the {model} model: calibrate with "
        f"--model {other.model}; the pictures can stay"
    )


def _notes(views: int, rejected: Sequence[Rejected]) -> tuple[str, ...]:
    notes = []
    outliers_and_blurred = sum(1 for each in rejected if each.why in (BLURRED, "outlier"))
    if outliers_and_blurred > MANY_REJECTED * (views + outliers_and_blurred):
        notes.append(
            f"{outliers_and_blurred} views were blurred or did not fit: hold the board still, on something stiff"
        )
    return tuple(notes)


def marker_note(board: Board, shares: Sequence[float]) -> str | None:
    """Whether the printed markers are as large, beside their squares, as the file says; None if they are."""
    if board.marker_m is None or not shares:
        return None
    wanted, seen = board.marker_m / board.square_m, float(np.median(shares))
    if abs(seen / wanted - 1.0) <= MARKER_SHARE_OFF:
        return None
    return (
        f"the markers' sides measure {seen:.2f} of the squares', the file says {wanted:.2f}: measure both on the print "
        "(square_m, marker_m)"
    )


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"

"""The way into this module: views of a board in, a lens out, with what it is worth."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.board import Board
from pilotfish.calibration.camera import views as kinds
from pilotfish.calibration.camera.coverage import Coverage, Tilts, coverage_of, tilts_of
from pilotfish.calibration.camera.fit import MIN_VIEWS, Fit, fit_best, fit_lens
from pilotfish.calibration.camera.lens import Lens
from pilotfish.calibration.camera.other_model import OtherModel, compare_models
from pilotfish.calibration.camera.unseen import Unseen, unseen_views
from pilotfish.calibration.camera.verdict import Verdict, better_model_reason, judge, marker_note
from pilotfish.calibration.camera.views import BoardView, Rejected
from pilotfish.calibration.covariance import Uncertainty
from pilotfish.errors import CalibrationError

BLUR_FLOOR_PX = 1.0  # less is no blur worth a picture
BLUR_FACTOR = 1.8  # of the median
OUTLIER_FACTOR = 3.0  # of the RMS that a quarter of the views stay below: those are right even if many are wrong
OUTLIER_FLOOR_PX = 0.1
CORNER_SIGMAS = 6.0
MAX_DROPPED = 0.34  # share of the views: more, and it is not the views that are wrong
MIN_CORNERS_LEFT = 6


@dataclass(frozen=True)
class CameraCalibration:
    """A lens, how well it is known, and from what: ``views`` (those used), ``rejected`` (in the pictures' order),
    ``dropped_corners``: single corners that did not fit. ``other``: the other lens model on the same corners."""

    fit: Fit
    known: Uncertainty
    views: tuple[BoardView, ...]
    rejected: tuple[Rejected, ...]
    dropped_corners: int
    coverage: Coverage
    tilts: Tilts
    unseen: Unseen | None
    verdict: Verdict
    other: OtherModel | None = None

    @property
    def lens(self) -> Lens:
        """The fitted lens."""
        return self.fit.lens


def calibrate_camera(
    found: Sequence[BoardView | Rejected],
    size: tuple[int, int],
    board: Board,
    *,
    model: str = "pinhole",
    on_stage: Callable[[str], None] | None = None,
) -> CameraCalibration:
    """Calibrates from what ``BoardDetector`` found in pictures of ``size`` (width, height).

    Blurred views, views that do not fit and single corners that do not are left out. CalibrationError says what to
    film.
    """
    say = on_stage or (lambda _: None)
    views = [each for each in found if isinstance(each, BoardView)]
    rejected = [each for each in found if isinstance(each, Rejected)]
    if len(views) < MIN_VIEWS:
        raise CalibrationError(too_few(views, rejected))
    sharp, blurred = _sharp(views)
    if len(sharp) < MIN_VIEWS:
        raise CalibrationError(too_few(sharp, rejected + blurred))
    say("fitting")
    kept, outliers, dropped = _consistent(sharp, size, model)
    fit, known = fit_best(kept, size, model)
    say("testing on unseen views")
    unseen = unseen_views(kept, fit)
    say("comparing the lens models")
    other = compare_models(kept, fit)
    coverage, tilts = coverage_of(kept, size), tilts_of(fit)
    order = {each.name: k for k, each in enumerate(found)}
    rejected = sorted(rejected + blurred + outliers, key=lambda each: order.get(each.name, 0))
    blur_px = float(np.median([v.blur_px for v in kept]))
    verdict = judge(fit, known, coverage, tilts, unseen.rms_px if unseen else 0.0, blur_px, rejected, other)
    shares = [v.marker_share for v in kept if v.marker_share is not None]
    if note := marker_note(board, shares):
        verdict = Verdict(verdict.grade, verdict.reasons, (*verdict.notes, note))
    return CameraCalibration(fit, known, tuple(kept), tuple(rejected), dropped, coverage, tilts, unseen, verdict, other)


def too_few(views: Sequence[BoardView], rejected: Sequence[Rejected]) -> str:
    """What to say if fewer than MIN_VIEWS views are left: with the commonest reason."""
    said = (
        f"the board was found in {len(views)} pictures of {len(views) + len(rejected)}; {MIN_VIEWS} are needed at least"
    )
    if not rejected:
        return said + ", 20 or more are good"
    why, count = Counter(each.why for each in rejected).most_common(1)[0]
    detail, alike = Counter(each.detail for each in rejected if each.why == why).most_common(1)[0]
    hint = (
        " (is the board file the one of this print? is all of it in focus, flat and lit?)" if why == "no board" else ""
    )
    return f"{said}. {count} x {why}" + (f", {alike} times: {detail}" if detail != "no board was found" else "") + hint


def _sharp(views: Sequence[BoardView]) -> tuple[list[BoardView], list[Rejected]]:
    median = float(np.median([v.blur_px for v in views]))
    limit = max(BLUR_FLOOR_PX, BLUR_FACTOR * median)
    sharp = [v for v in views if v.blur_px <= limit]
    blurred = [
        Rejected(v.name, kinds.BLURRED, f"edges blurred by {v.blur_px:.1f} px, the others by {median:.1f} px")
        for v in views
        if v.blur_px > limit
    ]
    return sharp, blurred


def _better_model(views: list[BoardView], size: tuple[int, int], model: str) -> str:
    """A sentence, if the other model fits all views better; else nothing."""
    other = compare_models(views, fit_lens(views, size, model))
    return f" {better_model_reason(model, other).capitalize()}" if other and other.clearly_better_by > 1.5 else ""


def _consistent(
    views: list[BoardView], size: tuple[int, int], model: str
) -> tuple[list[BoardView], list[Rejected], int]:
    """Without the worst view, again and again, until none is far worse than the others; then without single corners.

    One at a time, since a wrong view bends the lens and makes good ones look wrong.
    """
    kept, outliers = list(views), []
    most = int(MAX_DROPPED * len(views))
    fit = fit_lens(kept, size, model)
    while True:
        errors = fit.view_rms_px
        worst = int(np.argmax(errors))
        typical = float(np.percentile(errors, 25))
        if errors[worst] <= max(OUTLIER_FACTOR * typical, OUTLIER_FLOOR_PX) or len(kept) <= MIN_VIEWS:
            break
        if len(outliers) >= most:
            raise CalibrationError(
                f"more than {most} of {len(views)} views do not fit the others (the last, {kept[worst].name}, is off "
                f"by "
                f"{errors[worst]:.2f} px): is the board flat and its file right, was zoom or focus changed meanwhile, "
                f"and is it the right --model?{_better_model(views, size, model)}"
            )
        without = [view for k, view in enumerate(kept) if k != worst]
        detail = f"off by {errors[worst]:.2f} px (RMS), the better views by {typical:.2f} px"
        outliers.append(Rejected(kept[worst].name, kinds.OUTLIER, detail))
        kept, fit = without, fit_lens(without, size, model)
    lengths = np.linalg.norm(np.concatenate(fit.residuals_px), axis=1)
    # The median length of a Gaussian residual of sigma per axis is 1.18 sigma.
    limit = max(CORNER_SIGMAS * float(np.median(lengths)) / 1.1774, OUTLIER_FLOOR_PX)
    result, dropped = [], 0
    for view, residuals in zip(kept, fit.residuals_px, strict=True):
        fits = np.linalg.norm(residuals, axis=1) <= limit
        if fits.sum() < MIN_CORNERS_LEFT:
            fits[:] = True
        dropped += int((~fits).sum())
        result.append(view.where(fits))
    return result, outliers, dropped

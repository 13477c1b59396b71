"""From corners to a layout: first guess, bundle, away with what does not fit, and again until all of it fits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.body.bundle import Bundle, Estimate
from pilotfish.calibration.body.first_guess import guess_layout, pose_frames
from pilotfish.calibration.body.pairs import pairs_seen_together
from pilotfish.calibration.body.sightings import Sightings
from pilotfish.calibration.body.single_pose import both_tag_poses
from pilotfish.calibration.body.sizes import check_sizes, check_sizes_roughly
from pilotfish.calibration.body.turning import settle_flips
from pilotfish.core import CameraModel
from pilotfish.errors import BodyLearningError

MIN_FRAMES = 10
MAX_ROUNDS = 8
OUTLIER_SIGMAS = 4.0  # RMS over a sighting's eight residuals: 16 times chi-squared's mean of 8
SIGMA_FLOOR_PX = 0.005  # no detector is better: below, nothing is an outlier
FIRST_ROBUST_SCALE_PX = 1.0
MAX_UNFIT = 0.5  # share of a tag's sightings: above, it is the tag and not the pictures


@dataclass(frozen=True)
class Adjustment:
    """``estimate`` explains ``sightings`` (those that fit) up to ``rms_px``; ``dropped`` (T,) did not fit."""

    sightings: Sightings
    estimate: Estimate
    bundle: Bundle  # around the estimate: its x is zero
    reference: int
    dropped: np.ndarray
    rms_px: float
    size_warnings: tuple[str, ...]


def adjust(camera: CameraModel, sightings: Sightings, reference_id: int) -> Adjustment:
    """Layout and frames from all sightings; raises BodyLearningError if they do not hang together."""
    ids = sightings.ids
    reference = int(np.searchsorted(ids, reference_id))
    cMt, errors_px = both_tag_poses(camera, sightings)
    pairs = pairs_seen_together(sightings, cMt, errors_px)
    usable = np.isfinite(errors_px).all(axis=1)
    enough = sightings.seen_together() if len(ids) > 1 else usable
    frames = len(np.unique(sightings.frame[enough & usable]))
    if 0 < frames < MIN_FRAMES:  # without any, guess_layout says which tags were apart
        raise BodyLearningError(
            f"only {frames} frames "
            + ("show two tags at once" if len(ids) > 1 else "show the tag")
            + f", {MIN_FRAMES} are needed: film for longer, turn more slowly, or use every frame (--every 1)"
        )
    check_sizes_roughly(sightings, pairs)
    layout = guess_layout(ids, pairs, reference)
    here, (cMt, errors_px) = _select(sightings, (cMt, errors_px), usable)
    robust_px = FIRST_ROBUST_SCALE_PX
    size_warnings: tuple[str, ...] = ()
    for round_number in range(MAX_ROUNDS):
        if len(ids) > 1:
            cMr, _ = pose_frames(camera, here, cMt, layout)
        else:  # no neighbour resolves its two poses: the turning does
            cMr = settle_flips(cMt, errors_px)
        start = Estimate(cMr, layout, np.zeros(len(ids)))
        bundle = Bundle(camera, here, start, reference)
        estimate = bundle.estimate(bundle.solve(robust_scale_px=robust_px))
        bundle = Bundle(camera, here, estimate, reference)
        if round_number == 0:
            size_warnings = check_sizes(camera, here, estimate, reference)
        layout = estimate.rMt
        residuals = bundle.residuals(np.zeros(bundle.unknowns)).reshape(-1, 8)
        sigma_px = max(1.4826 * float(np.median(np.abs(residuals))), SIGMA_FLOOR_PX)
        fits = np.sqrt((residuals**2).mean(axis=1)) < OUTLIER_SIGMAS * sigma_px
        if fits.all():
            break
        robust_px = 2.0 * sigma_px
        _check_that_tags_are_rigid(sightings, here, fits)
        here, (cMt, errors_px) = _select(here, (cMt, errors_px), fits)
    estimate = bundle.estimate(bundle.solve())
    bundle = Bundle(camera, here, estimate, reference)
    residuals = bundle.residuals(np.zeros(bundle.unknowns))
    together = sightings.where(sightings.seen_together()) if len(ids) > 1 else sightings
    dropped = np.bincount(together.tag, minlength=len(ids)) - np.bincount(here.tag, minlength=len(ids))
    rms_px = float(np.sqrt((residuals**2).mean()))
    return Adjustment(here, estimate, bundle, reference, dropped, rms_px, size_warnings)


def _select(
    sightings: Sightings, columns: tuple[np.ndarray, ...], kept: np.ndarray
) -> tuple[Sightings, tuple[np.ndarray, ...]]:
    """What is kept of the sightings and of ``columns`` beside them, (S, ...) each; only frames with two left, since
    a tag alone says nothing about the others."""
    if len(sightings.ids) > 1:
        kept = kept.copy()
        kept &= np.bincount(sightings.frame[kept], minlength=sightings.frame_count)[sightings.frame] > 1
    selected = sightings.where(kept)
    if len(selected.ids) < len(sightings.ids):
        lost = sorted(set(sightings.ids.tolist()) - set(selected.ids.tolist()))
        raise BodyLearningError(_not_rigid(lost))
    return selected, tuple(column[kept] for column in columns)


def _check_that_tags_are_rigid(all_sightings: Sightings, here: Sightings, fits: np.ndarray) -> None:
    seen, unfit = np.bincount(here.tag), np.bincount(here.tag, weights=~fits)
    loose = all_sightings.ids[unfit > MAX_UNFIT * seen].tolist()
    if loose:
        raise BodyLearningError(_not_rigid(loose))


def _not_rigid(ids: list[int]) -> str:
    named = ", ".join(map(str, ids))
    return (
        f"most sightings of tag {named} do not fit a rigid body: fix it so that it cannot move, print it flat, or name "
        "it with --ignore ID if it is not on the robot; check that the camera is the calibrated one"
    )

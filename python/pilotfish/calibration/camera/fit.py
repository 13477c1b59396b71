"""A lens and the poses of the board that explain all corners best, by OpenCV, with how well the lens is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.camera.lens import Lens, lens_of
from pilotfish.calibration.camera.views import BoardView
from pilotfish.calibration.covariance import Block, Uncertainty, uncertainty_of
from pilotfish.errors import CalibrationError
from pilotfish.extras import require

MIN_VIEWS = 4
K3_SIGMAS = 3.0  # k3 that is not clearly there is left out: it would only blow up the others' uncertainty
_POSE_ITERATIONS = 10
_FISHEYE_F_SHARE = 1.0 / np.pi  # of the longer side, as OpenCV's first guess: 180 degrees across it
_LOST_RMS_PX = 5.0  # a fisheye fit that ends above has not found its minimum


@dataclass(frozen=True)
class Fit:
    """``lens``, and of each view (in order) ``rotations`` (V, 3), ``translations_m`` (V, 3) of the board in the
    camera's frame and ``residuals_px``: (P, 2) seen minus explained. ``free`` (8 or 9,) bool: which parameters were
    fitted."""

    lens: Lens
    rotations: np.ndarray
    translations_m: np.ndarray
    residuals_px: tuple[np.ndarray, ...]
    free: np.ndarray

    @property
    def rms_px(self) -> float:
        """Over all corners, of the distance between seen and explained."""
        return rms(np.concatenate(self.residuals_px))

    @property
    def view_rms_px(self) -> np.ndarray:
        """(V,): the same of each view."""
        return np.array([rms(each) for each in self.residuals_px])


def rms(residuals_px: np.ndarray) -> float:
    """Root of the mean squared length of (P, 2); 0 of none."""
    return float(np.sqrt((residuals_px**2).sum(axis=1).mean())) if len(residuals_px) else 0.0


def fit_lens(
    views: Sequence[BoardView], size: tuple[int, int], model: str, *, with_k3: bool = True, start: Lens | None = None
) -> Fit:
    """Fits ``model`` to the views of pictures of ``size`` (width, height). ``start``: a lens near by.

    CalibrationError if it does not converge, or if there are too few views.
    """
    if len(views) < MIN_VIEWS:
        raise CalibrationError(
            f"only {len(views)} usable views of the board, {MIN_VIEWS} are needed at least, 20 or more are good: take "
            f"more "
            "pictures, sharp ones, with the board large and tilted"
        )
    cv2 = require("cv2", "calibrate")
    points = [np.ascontiguousarray(v.points_m, dtype=np.float32).reshape(-1, 1, 3) for v in views]
    corners = [np.ascontiguousarray(v.corners_px, dtype=np.float32).reshape(-1, 1, 2) for v in views]
    try:
        if model == "pinhole":
            fitted = _pinhole(cv2, points, corners, size, with_k3, start)
        else:
            fitted = _fisheye_from_any(cv2, points, corners, size, start)
    except cv2.error as error:
        raise CalibrationError(
            f"OpenCV cannot calibrate from these {len(views)} views ({' '.join(str(error.err).split())}): take views "
            f"in "
            "which the board is tilted to different sides by 20 to 45 degrees"
        ) from error
    K, D, rotations, translations = fitted
    lens = lens_of(model, size, K, D)
    if not np.isfinite(lens.values).all():
        raise CalibrationError("the calibration did not converge: take views in which the board is tilted differently")
    rotations, translations = (np.asarray(each, dtype=float).reshape(-1, 3) for each in (rotations, translations))
    residuals = tuple(
        v.corners_px - lens.project(v.points_m, r, t) for v, r, t in zip(views, rotations, translations, strict=True)
    )
    free = np.ones(len(lens.values), dtype=bool)
    if model == "pinhole" and not with_k3:
        free[-1] = False
    return Fit(lens, rotations, translations, residuals, free)


def fit_best(views: Sequence[BoardView], size: tuple[int, int], model: str) -> tuple[Fit, Uncertainty]:
    """fit_lens with the fewest coefficients that explain the corners: k3 only if it differs clearly from 0."""
    fit = fit_lens(views, size, model, with_k3=False)
    if model == "pinhole":
        larger = fit_lens(views, size, model, start=fit.lens)
        known = uncertainty(views, larger)
        if abs(larger.lens.distortion[-1]) > K3_SIGMAS * known.sigma[-1]:
            return larger, known
    return fit, uncertainty(views, fit)


def uncertainty(views: Sequence[BoardView], fit: Fit) -> Uncertainty:
    """Covariance of all ``fit.lens.values``; rows and columns of what was not fitted are zero."""
    blocks = []
    for view, r, t, residuals in zip(views, fit.rotations, fit.translations_m, fit.residuals_px, strict=True):
        _, by_lens, by_pose = fit.lens.project_with_derivatives(view.points_m, r, t)
        blocks.append(Block(residuals.ravel(), by_lens[:, fit.free], by_pose))
    known = uncertainty_of(blocks)
    place = np.ix_(fit.free, fit.free)
    both = []
    for covariance in (known.least_squares, known.jackknife):
        whole = np.zeros((len(fit.free), len(fit.free)))
        whole[place] = covariance
        both.append(whole)
    return Uncertainty(*both, known.residual_sigma)


def fit_pose(
    lens: Lens, view: BoardView, rotation: np.ndarray, translation_m: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The board's pose through a given lens, from a start near by: (3,), (3,) and the residuals (P, 2) px."""
    pose = np.concatenate([rotation, translation_m])
    for _ in range(_POSE_ITERATIONS):
        pixels, _, by_pose = lens.project_with_derivatives(view.points_m, pose[:3], pose[3:])
        step = np.linalg.lstsq(by_pose, (view.corners_px - pixels).ravel(), rcond=None)[0]
        pose = pose + step
        if np.abs(step).max() < 1e-10:
            break
    return pose[:3], pose[3:], view.corners_px - lens.project(view.points_m, pose[:3], pose[3:])


def _pinhole(cv2, points, corners, size, with_k3, start):
    criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-12)
    flags = 0 if with_k3 else cv2.CALIB_FIX_K3
    K, D = None, None
    if start is not None:
        flags |= cv2.CALIB_USE_INTRINSIC_GUESS
        K, D = start.matrix, np.array(start.distortion)
    _, K, D, rotations, translations = cv2.calibrateCamera(points, corners, size, K, D, flags=flags, criteria=criteria)
    return K, D, rotations, translations


def _fisheye_from_any(cv2, points, corners, size, start):
    """From ``start``, else from 180 degrees across the picture; if the fit is lost from there, as it is with a lens of
    half that, from the focal length that a pinhole model finds."""
    try:
        rms_px, fitted = _fisheye(cv2, points, corners, size, start)
        if start is not None or rms_px < _LOST_RMS_PX:
            return fitted
    except cv2.error:
        if start is not None:
            raise
        rms_px, fitted = np.inf, None
    K = _pinhole(cv2, points, corners, size, False, None)[0]
    try:
        second_rms_px, second = _fisheye(cv2, points, corners, size, lens_of("fisheye", size, K, np.zeros(4)))
    except cv2.error:
        if fitted is None:
            raise
        return fitted
    return second if second_rms_px < rms_px else fitted


def _fisheye(cv2, points, corners, size, start):
    # Its first guess of the poses fails where a start of the lens is far off, which the longer side over pi seldom is.
    criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-12)
    named = ("CALIB_RECOMPUTE_EXTRINSIC", "CALIB_FIX_SKEW", "CALIB_USE_INTRINSIC_GUESS")
    home = cv2.fisheye if hasattr(cv2.fisheye, named[0]) else cv2  # OpenCV 4 had them there
    flags = sum(getattr(home, name) for name in named)
    if start is None:
        f = _FISHEYE_F_SHARE * max(size)
        K = np.array([[f, 0.0, (size[0] - 1) / 2.0], [0.0, f, (size[1] - 1) / 2.0], [0.0, 0.0, 1.0]])
        D = np.zeros((4, 1))
    else:
        K, D = start.matrix, np.array(start.distortion).reshape(4, 1)
    points = [each.astype(np.float64).reshape(1, -1, 3) for each in points]
    corners = [each.astype(np.float64).reshape(1, -1, 2) for each in corners]
    rms_px, K, D, rotations, translations = cv2.fisheye.calibrate(
        points, corners, size, K, D, flags=flags, criteria=criteria
    )
    return rms_px, (K, D, rotations, translations)

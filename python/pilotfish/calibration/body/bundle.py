"""The bundle: all corners of all frames, as a function of the pose of the body in each frame and of each tag on it.

Corner q of tag j in frame f is seen at project(R_f P + t_f) with P = R_j s_j q + t_j: poses cMr_f (frame) and rMt_j
(tag), r being the reference tag's own frame, which fixes the gauge. With the steps of ``rigid.moved``

    d/dv_f = R0_f      d/dw_f = -R_f [P] J(w_f)      d/dv_j = R_f R0_j      d/dw_j = -R_f R_j [s_j q] J(w_j)

times the derivative of the projection. log s_j is an unknown only when the sizes are put to the test.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.sparse import csr_array

from pilotfish.calibration.body.projection import project
from pilotfish.calibration.body.rigid import moved, right_jacobian, skew, transform
from pilotfish.calibration.body.sightings import Sightings
from pilotfish.core import CameraModel

MAX_EVALUATIONS = 60  # it settles within 5 to 20; what takes longer does not fit, and will be refused


@dataclass(frozen=True)
class Estimate:
    """cMr (N, 4, 4) of the frames, rMt (T, 4, 4) of the tags (the reference's is the identity), and by how much
    each tag is larger than configured, log (T,)."""

    cMr: np.ndarray
    rMt: np.ndarray
    log_scale: np.ndarray


class Bundle:
    """Residuals [px] and their sparse derivative around a start. The unknowns x: six a frame, six a tag but the
    reference, and with ``free_sizes`` one log s a tag but the reference."""

    def __init__(
        self,
        camera: CameraModel,
        sightings: Sightings,
        start: Estimate,
        reference: int,
        *,
        free_sizes: bool = False,
    ) -> None:
        self._camera, self._sightings, self._start = camera, sightings, start
        frames, tags = len(start.cMr), len(start.rMt)
        self._others = np.array([tag for tag in range(tags) if tag != reference], dtype=int)
        self._free_sizes = free_sizes
        self.unknowns = 6 * frames + 6 * len(self._others) + (len(self._others) if free_sizes else 0)
        # Columns of each sighting: six of its frame, six of its tag, one of its size; -1 where there is none.
        place = np.full(tags, -1)
        place[self._others] = np.arange(len(self._others))
        place = place[sightings.tag]
        fixed = place < 0
        of_tag = np.where(fixed[:, None], -1, 6 * frames + 6 * place[:, None] + np.arange(6))
        of_size = np.where(fixed | (not free_sizes), -1, 6 * frames + 6 * len(self._others) + place)
        columns = np.concatenate([6 * sightings.frame[:, None] + np.arange(6), of_tag, of_size[:, None]], axis=1)
        columns = np.broadcast_to(columns[:, None, :], (len(sightings), 8, 13)).reshape(-1, 13)
        self._present = columns >= 0
        self._indices = columns[self._present]
        self._row_starts = np.concatenate([[0], np.cumsum(self._present.sum(axis=1))])

    def estimate(self, x: np.ndarray) -> Estimate:
        """The poses and sizes that the unknowns x (U,) stand for."""
        frame_steps, tag_steps, log_scale = self._split(x)
        rMt = moved(self._start.rMt, tag_steps)
        return Estimate(moved(self._start.cMr, frame_steps), rMt, self._start.log_scale + log_scale)

    def _split(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        frames, tags, others = len(self._start.cMr), len(self._start.rMt), self._others
        frame_steps, tag_steps, log_scale = x[: 6 * frames].reshape(-1, 6), np.zeros((tags, 6)), np.zeros(tags)
        tag_steps[others] = x[6 * frames : 6 * (frames + len(others))].reshape(-1, 6)
        if self._free_sizes:
            log_scale[others] = x[6 * (frames + len(others)) :]
        return frame_steps, tag_steps, log_scale

    def _corners(self, estimate: Estimate) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of each sighting (S, 4, 3): in the tag's frame, in the reference's, in the camera's."""
        s = self._sightings
        on_tag = s.corners_m * np.exp(estimate.log_scale)[s.tag, None, None]
        on_body = transform(estimate.rMt[s.tag], on_tag)
        return on_tag, on_body, transform(estimate.cMr[s.frame], on_body)

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """(8 S,) seen minus measured [px]."""
        pixels, _ = project(self._camera, self._corners(self.estimate(x))[2])
        return (pixels - self._sightings.corners_px).ravel()

    def jacobian(self, x: np.ndarray) -> csr_array:
        """(8 S, U), sparse: the derivative of residuals() at x (U,) [px per m, rad or unit of log size]."""
        s, estimate = self._sightings, self.estimate(x)
        frame_steps, tag_steps, _ = self._split(x)
        on_tag, on_body, in_camera = self._corners(estimate)
        _, derivative = project(self._camera, in_camera)
        turn_f, turn_t = right_jacobian(frame_steps[:, 3:])[s.frame], right_jacobian(tag_steps[:, 3:])[s.tag]
        R_f, R0_f = estimate.cMr[s.frame, :3, :3], self._start.cMr[s.frame, :3, :3]
        R_ft, R_f0t = R_f @ estimate.rMt[s.tag, :3, :3], R_f @ self._start.rMt[s.tag, :3, :3]
        by_unknown = np.concatenate(
            [
                np.broadcast_to(R0_f[:, None], (len(s), 4, 3, 3)),
                -R_f[:, None] @ skew(on_body) @ turn_f[:, None],
                np.broadcast_to(R_f0t[:, None], (len(s), 4, 3, 3)),
                -R_ft[:, None] @ skew(on_tag) @ turn_t[:, None],
                R_ft[:, None] @ on_tag[..., None],
            ],
            axis=-1,
        )
        values = (derivative @ by_unknown).reshape(-1, 13)
        shape = (len(values), self.unknowns)
        return csr_array((values[self._present], self._indices, self._row_starts), shape=shape)

    def solve(self, *, robust_scale_px: float | None = None) -> np.ndarray:
        """The x that explains the corners best; with a scale, residuals beyond it count linearly (soft L1)."""
        return least_squares(
            self.residuals,
            np.zeros(self.unknowns),
            self.jacobian,
            method="trf",
            tr_solver="lsmr",
            x_scale="jac",
            loss="soft_l1" if robust_scale_px else "linear",
            f_scale=robust_scale_px or 1.0,
            xtol=1e-9,
            ftol=1e-9,
            gtol=1e-9,
            max_nfev=MAX_EVALUATIONS,
        ).x

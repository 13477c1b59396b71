"""What a camera on a robot sees of fixed tags while the robot turns on the spot and then drives straight.

The frames. World w: the base frame b before the turn. The camera sits at bMc = (R, p). In picture k the base is at
wMb_k, a motion of the ground plane, and tag j of the world, at wMt_j, is seen at

    cMt = bMc^-1 wMb_k^-1 wMt_j

Turning on the spot:   wMb_k = (Rz(theta_k), 0): the origin of b is where the robot turns about.
Driving:               wMb_k = start * arc(s_k) with start = (x, y, phi), a free place on the same ground, and an arc of
                       one curvature kappa, since no robot drives quite straight:
                       arc(s) = (sin(kappa s) / kappa, (1 - cos(kappa s)) / kappa, kappa s).
                       Its tangent is the base's x axis: wheels do not slip sideways.

What is observable. Define the base frame otherwise, b' = b A with a constant motion A. Then bMc' = A^-1 bMc, wMb' =
wMb A and wMt give the same pictures. A is seen if wMb' cannot be again turns about b' and drives along its x axis.

- The turn leaves A = a turn about z and a shift along z. It determines how far the camera is from the turning centre,
  its tilt and its roll. The shift along z cannot be seen in any motion on level ground: the height. A measured height
  of the camera, or of one tag (a tag on the floor has 0), gives it; distance and bearing do not need it.
- The drive excludes the turn about z: it gives pan, and how much of the distance is forward and how much to the left.
- A drive alone leaves the place and, about the direction driven, the roll.

Unknowns shared by all pictures: R (3), p_x, p_y; six for each tag; of the drive x, y, phi, kappa. Each picture has
three of its own: theta_k and how far the base slipped away from the turning centre (dx, dy), or s_k and by how much it
left the path (dy, dheading). Slips are small: each is a measurement of 0 with a standard deviation that is learned from
the pictures (``Slip``). Residuals are the tags' corners in pixels, as in ``calibration.body``, and the slips in units
of their standard deviations, times the corners'.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from pilotfish.calibration.body.projection import project
from pilotfish.calibration.body.rigid import inverse, moved, transform
from pilotfish.calibration.body.sightings import Sightings
from pilotfish.calibration.covariance import Block
from pilotfish.calibration.mounting.solver import minimise
from pilotfish.core import CameraModel

STEP = 1e-6  # of the numeric derivative, in metres and radians
CAMERA, PLACE = slice(0, 3), slice(3, 5)  # of the shared unknowns: R's step, p


@dataclass(frozen=True)
class Slip:
    """Standard deviations of the slips: of the turning centre [m], across the drive's path [m] and of the heading there
    [rad]; ``corner_px``: of the corners, [px]."""

    turn_m: float
    drive_m: float
    drive_rad: float
    corner_px: float


SLIP_FLOOR = 1e-5  # m and rad: less is none
NO_SLIP = Slip(SLIP_FLOOR, SLIP_FLOOR, SLIP_FLOOR, 0.02)


@dataclass(frozen=True)
class Drive:
    """One explanation of all pictures. ``bMc`` (4, 4); ``wMt`` (T, 4, 4); ``turning`` (N,) bool: which pictures are of
    the turn; ``path`` (N,): theta [rad] there, s [m] elsewhere; ``start`` (4,): x, y, phi, kappa of the drive;
    ``slips`` (N, 3): dx forward, dy left [m], dheading [rad], from where the path has the base; ``frames`` (N,): which
    frame of the first sightings each picture is."""

    bMc: np.ndarray
    wMt: np.ndarray
    turning: np.ndarray
    path: np.ndarray
    start: np.ndarray
    slips: np.ndarray
    frames: np.ndarray

    @property
    def shared_count(self) -> int:
        """Unknowns that belong to no picture."""
        return 5 + 6 * len(self.wMt) + (4 if (~self.turning).any() else 0)

    def moved_by(self, shared: np.ndarray, own: np.ndarray) -> Drive:
        """After a step of the shared unknowns (shared_count,) and of the pictures' own (N, 3): path, and two slips."""
        bMc = moved(self.bMc[None], np.concatenate([np.zeros(3), shared[CAMERA]])[None])[0]
        bMc[:2, 3] += shared[PLACE]
        tags = 6 * len(self.wMt)
        wMt = moved(self.wMt, shared[5 : 5 + tags].reshape(-1, 6))
        start = self.start + shared[5 + tags :] if (~self.turning).any() else self.start
        slips = self.slips.copy()
        slips[self.turning, :2] += own[self.turning, 1:]
        slips[~self.turning, 1:] += own[~self.turning, 1:]
        return replace(self, bMc=bMc, wMt=wMt, path=self.path + own[:, 0], start=start, slips=slips)

    def own_slips(self) -> np.ndarray:
        """(N, 2): the two of each picture that are unknowns."""
        return np.where(self.turning[:, None], self.slips[:, :2], self.slips[:, 1:])

    def world_from_base(self) -> np.ndarray:
        """(N, 4, 4): where the base was in each picture."""
        along = np.where(self.turning, 0.0, self.path)
        turn = along * self.start[3]
        # sinc(z) = sin(pi z) / (pi z): sin(a) / a, and (1 - cos a) / a = sin(a / 2) (sin(a / 2) / (a / 2)), without
        # dividing by 0.
        x = along * np.sinc(turn / np.pi)
        y = along * np.sinc(turn / (2.0 * np.pi)) * np.sin(turn / 2.0)
        c, s = np.cos(self.start[2]), np.sin(self.start[2])
        heading = np.where(self.turning, self.path, self.start[2] + turn)
        result = np.tile(np.eye(4), (len(self.path), 1, 1))
        result[:, 0, 0] = result[:, 1, 1] = np.cos(heading)
        result[:, 1, 0] = np.sin(heading)
        result[:, 0, 1] = -result[:, 1, 0]
        result[:, 0, 3] = np.where(self.turning, 0.0, self.start[0] + c * x - s * y)
        result[:, 1, 3] = np.where(self.turning, 0.0, self.start[1] + s * x + c * y)
        return result @ _ground(self.slips)


def _ground(slips: np.ndarray) -> np.ndarray:
    """(N, 4, 4) motions of the ground plane from (N, 3): dx, dy, dheading."""
    result = np.tile(np.eye(4), (len(slips), 1, 1))
    result[:, 0, 0] = result[:, 1, 1] = np.cos(slips[:, 2])
    result[:, 1, 0] = np.sin(slips[:, 2])
    result[:, 0, 1] = -result[:, 1, 0]
    result[:, :2, 3] = slips[:, :2]
    return result


class DriveBundle:
    """Residuals [px] and derivative of all corners, and of the slips, around a Drive."""

    def __init__(
        self,
        camera: CameraModel,
        sightings: Sightings,
        drive: Drive,
        slip: Slip = NO_SLIP,
        *,
        pan_known: bool = False,
    ) -> None:
        self._camera, self._sightings, self._drive = camera, sightings, drive
        self._pictures = len(drive.path)
        of_turn, of_drive = (slip.turn_m, slip.turn_m), (slip.drive_m, slip.drive_rad)
        self._slip_weight = slip.corner_px / np.where(drive.turning[:, None], of_turn, of_drive)  # (N, 2) px per m, rad
        # Where counting begins is free: theta against the first tag's heading, s against the start. Fixed are therefore
        # a turn of that tag about the world's z axis, and a shift of the start along the path. Fixing a picture instead
        # would make what is known of everything depend on that picture.
        fixed = [np.zeros(drive.shared_count)]
        fixed[0][8:11] = drive.wMt[0, 2, :3]
        if (~drive.turning).any():
            along = np.zeros(drive.shared_count)
            along[-4:-2] = np.cos(drive.start[2]), np.sin(drive.start[2])
            fixed.append(along)
        if pan_known:  # a base that turns about z with the camera in it cannot be seen in the turn
            pan = np.zeros(drive.shared_count)
            pan[CAMERA] = drive.bMc[2, :3]  # the base's z axis as the camera has it
            fixed.append(pan)
        self._shared_base = np.linalg.svd(np.stack(fixed))[2][len(fixed) :].T
        self._shared = self._shared_base.shape[1]
        self.unknowns = self._shared + 3 * self._pictures
        self._column = self._shared + np.arange(3 * self._pictures).reshape(-1, 3)

    @property
    def shared_base(self) -> np.ndarray:
        """(shared_count, S): the directions in which the shared unknowns may move."""
        return self._shared_base

    def drive(self, x: np.ndarray) -> Drive:
        """What the unknowns x (U,) stand for."""
        return self._drive.moved_by(self._shared_base @ x[: self._shared], x[self._shared :].reshape(-1, 3))

    def corner_residuals(self, drive: Drive | None = None) -> np.ndarray:
        """(S, 8) explained minus seen [px], of a Drive (default: the one this was made with)."""
        drive = drive or self._drive
        s = self._sightings
        cMw = inverse(drive.world_from_base() @ drive.bMc)
        in_camera = transform(cMw[s.frame] @ drive.wMt[s.tag], s.corners_m)
        pixels, _ = project(self._camera, in_camera)
        return (pixels - s.corners_px).reshape(len(s), 8)

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """(8 S + 2 N,): the corners', then the slips'."""
        drive = self.drive(x)
        return np.concatenate([self.corner_residuals(drive).ravel(), (drive.own_slips() * self._slip_weight).ravel()])

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """(8 S + 2 N, U), by central differences; all pictures' own unknowns are moved at once, as no two share a
        row."""
        drive, corners = self.drive(x), 8 * len(self._sightings)
        result = np.zeros((corners + 2 * self._pictures, self.unknowns))
        no_own, no_shared = np.zeros((self._pictures, 3)), np.zeros(drive.shared_count)

        def derivative(shared: np.ndarray, own: np.ndarray) -> np.ndarray:
            after, before = (
                self.corner_residuals(drive.moved_by(sign * STEP * shared, sign * STEP * own)) for sign in (1.0, -1.0)
            )
            return ((after - before) / (2.0 * STEP)).ravel()

        for k in range(self._shared):
            result[:corners, k] = derivative(self._shared_base[:, k], no_own)
        rows = np.arange(corners)
        for k in range(3):
            own = no_own.copy()
            own[:, k] = 1.0
            result[rows, np.repeat(self._column[self._sightings.frame, k], 8)] = derivative(no_shared, own)
        slips = corners + np.arange(2 * self._pictures).reshape(-1, 2)
        result[slips, self._column[:, 1:]] = self._slip_weight
        return result

    def solve(self, *, robust_scale_px: float | None = None) -> Drive:
        """The Drive that explains the corners best; with a scale, residuals beyond it count linearly (soft L1)."""
        x = minimise(self.residuals, lambda x: csc_array(self.jacobian(x)), self.unknowns, robust_scale=robust_scale_px)
        return self.drive(x)

    def learned_slip(self) -> Slip:
        """Slips' standard deviations as the pictures show them, at the Drive this was made with.

        Given all that is shared, a picture's own unknowns have the covariance C = s^2 (J^T J)^-1 from the corners
        alone, and the estimate q of its slips scatters by C + slip^2: the mean of q^2 - C over the pictures is slip^2.
        """
        corners = 8 * len(self._sightings)
        jacobian = self.jacobian(np.zeros(self.unknowns))[:corners]
        residuals = self.corner_residuals().ravel()
        of_row, slips = np.repeat(self._sightings.frame, 8), self._drive.own_slips()
        estimates, spreads, left = [], [], []
        for picture in range(self._pictures):
            rows = of_row == picture
            J = jacobian[np.ix_(rows, self._column[picture])]
            C = np.linalg.inv(J.T @ J)
            step = -C @ (J.T @ residuals[rows])
            estimates.append(slips[picture] + step[1:])
            spreads.append(np.diag(C)[1:])
            # What three unknowns leave of n residuals is smaller by the root of (n - 3) / n.
            left.append((residuals[rows] + J @ step) / np.sqrt(1.0 - 3.0 / rows.sum()))
        corner_px = max(1.4826 * float(np.median(np.abs(np.concatenate(left)))), 1e-4)
        squares = np.array(estimates) ** 2 - corner_px**2 * np.array(spreads)

        def deviation(values: np.ndarray) -> float:
            return max(float(np.sqrt(max(values.mean(), 0.0))) if len(values) else 0.0, SLIP_FLOOR)

        turning = self._drive.turning
        return Slip(
            deviation(squares[turning]), deviation(squares[~turning, 0]), deviation(squares[~turning, 1]), corner_px
        )

    def blocks(self, count: int) -> list[Block]:
        """Blocks of successive pictures, about ``count`` of each part, at the Drive this was made with."""
        x = np.zeros(self.unknowns)
        jacobian, residuals = self.jacobian(x), -self.residuals(x)
        label = np.zeros(self._pictures, dtype=int)
        for offset, part in ((0, self._drive.turning), (count, ~self._drive.turning)):
            members = np.flatnonzero(part)
            label[members] = offset + np.arange(len(members)) * min(count, len(members)) // max(len(members), 1)
        of_row = np.concatenate([np.repeat(label[self._sightings.frame], 8), np.repeat(label, 2)])
        result = []
        for block in np.unique(of_row):
            rows = of_row == block
            own = self._column[label == block].ravel()
            result.append(Block(residuals[rows], jacobian[rows, : self._shared], jacobian[np.ix_(rows, own)]))
        return result

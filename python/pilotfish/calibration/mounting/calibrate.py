"""The way into this module: sightings of fixed tags in, the camera's mounting out, with what could not be seen."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from pilotfish.calibration.body.sightings import Sightings
from pilotfish.calibration.body.single_pose import both_tag_poses
from pilotfish.calibration.covariance import Uncertainty, uncertainty_of
from pilotfish.calibration.mounting.angles import pan_tilt_roll
from pilotfish.calibration.mounting.drive import Drive, DriveBundle, Slip
from pilotfish.calibration.mounting.first_guess import drive_of, guess_drive, turning_axis, upright_poses
from pilotfish.calibration.mounting.phases import Phases, phases_by_motion
from pilotfish.core import CameraModel, CameraMounting
from pilotfish.errors import CalibrationError

MIN_TURN_PICTURES, MIN_DRIVE_PICTURES = 8, 5
ROBUST_PX = 1.0
FIRST_SLIP = Slip(2e-3, 2e-3, 2e-3, 0.03)
OUTLIER_SIGMAS = 5.0  # RMS over a sighting's eight residuals
SIGMA_FLOOR_PX = 0.01
MAX_ROUNDS = 3
BLOCKS = 8
LARGE_WANDER_M = 0.005
LARGE_RMS_PX = 0.5
SMALL_TURN_RAD, SMALL_DRIVE_M = math.radians(25.0), 0.4
MAX_CURVATURE_PM = 0.3
TO_THE_REAR_RAD = math.radians(120.0)


@dataclass(frozen=True)
class HeightKnown:
    """The camera's height above the ground, or that of one tag's centre (a tag on the floor: 0). One of both."""

    camera_m: float | None = None
    tag: tuple[int, float] | None = None


@dataclass(frozen=True)
class MountingCalibration:
    """``mounting``; ``sigma`` (6,): one standard deviation of x, y, z [m], pan, tilt, roll [rad], infinite where it was
    not observable; ``not_observable``: those, in words; ``warnings``; ``turned_rad``, ``driven_m``, ``curvature_pm``:
    what the robot did; ``slip``: how truly; ``rms_px``; ``pictures``: used of (turn, drive); ``dropped``: sightings."""

    mounting: CameraMounting
    sigma: np.ndarray
    not_observable: tuple[str, ...]
    warnings: tuple[str, ...]
    turned_rad: float
    driven_m: float
    curvature_pm: float
    slip: Slip
    rms_px: float
    pictures: tuple[int, int]
    dropped: int
    drive: Drive


def calibrate_mounting(
    sightings: Sightings,
    camera: CameraModel,
    *,
    phases: Phases | None = None,
    height: HeightKnown | None = None,
    pan_rad: float | None = None,
    backwards: bool = False,
) -> MountingCalibration:
    """Where the camera sits, from tags that stand still while the robot turns on the spot and then drives straight.

    ``phases``: which frame of the sightings is of which part; by default found by itself (a turn, then a drive).
    Without a drive ``pan_rad`` is taken as it is given (default: 0). CalibrationError says what to film or to say
    instead.
    """
    if len(sightings) == 0:
        raise CalibrationError("no tag was seen")
    cMt, errors_px = both_tag_poses(camera, sightings)
    usable = np.isfinite(errors_px).all(axis=1)
    phases = phases or _phases_found(sightings, cMt, usable, backwards)
    used = usable & (phases.turning | phases.straight)[sightings.frame]
    drive, here = _first(sightings, cMt, errors_px, used, phases, pan_rad)
    known_pan = not phases.straight.any()
    dropped, slip, robust_px = 0, FIRST_SLIP, ROBUST_PX
    for _ in range(MAX_ROUNDS):
        drive = DriveBundle(camera, here, drive, slip, pan_known=known_pan).solve(robust_scale_px=robust_px)
        bundle = DriveBundle(camera, here, drive, slip, pan_known=known_pan)
        slip = bundle.learned_slip()
        robust_px = 3.0 * slip.corner_px
        errors = np.sqrt((bundle.corner_residuals() ** 2).mean(axis=1))
        fits = errors < OUTLIER_SIGMAS * max(slip.corner_px, SIGMA_FLOOR_PX)
        if not fits.all():
            dropped += int((~fits).sum())
            drive, here = _without(drive, here, fits)
    drive = DriveBundle(camera, here, drive, slip, pan_known=known_pan).solve()
    bundle = DriveBundle(camera, here, drive, slip, pan_known=known_pan)
    residuals = bundle.corner_residuals()
    rms_px = float(np.sqrt((residuals**2).mean()))
    uncertainty = uncertainty_of(bundle.blocks(BLOCKS))
    return _result(drive, here, slip, bundle, uncertainty, rms_px, dropped, height, pan_rad, known_pan)


def _phases_found(sightings: Sightings, cMt: np.ndarray, usable: np.ndarray, backwards: bool) -> Phases:
    tag = int(np.bincount(sightings.tag[usable]).argmax())
    of_tag = np.flatnonzero(usable & (sightings.tag == tag))
    found = phases_by_motion(cMt[of_tag, 0, :3, 3]) if len(of_tag) else None
    if found is None:
        raise CalibrationError(
            "the pictures are not of a turn on the spot followed by a straight drive, or too few of either: film "
            "both, or "
            "give the drive as a film of its own with --straight"
        )
    frames = sightings.frame_count
    turning, straight = np.zeros(frames, dtype=bool), np.zeros(frames, dtype=bool)
    turning[sightings.frame[of_tag][found.turning]] = True
    straight[sightings.frame[of_tag][found.straight]] = True
    return Phases(turning, straight, not backwards)


def _first(
    sightings: Sightings,
    cMt: np.ndarray,
    errors_px: np.ndarray,
    used: np.ndarray,
    phases: Phases,
    pan_rad: float | None,
) -> tuple[Drive, Sightings]:
    """A first Drive, from the tag that was seen most often in the turn, and the sightings that it covers."""
    in_turn = used & phases.turning[sightings.frame]
    if in_turn.sum() < MIN_TURN_PICTURES:
        raise CalibrationError(
            f"a tag was seen in {int(in_turn.sum())} pictures of the turn; {MIN_TURN_PICTURES} are needed at least: "
            f"let "
            "the robot turn slowly on the spot before a tag"
        )
    in_drive = used & phases.straight[sightings.frame]
    both = np.bincount(sightings.tag[in_turn], minlength=len(sightings.ids))
    if in_drive.any():
        seen_driving = np.bincount(sightings.tag[in_drive], minlength=len(sightings.ids))
        if in_drive.sum() < MIN_DRIVE_PICTURES:
            raise CalibrationError(
                f"a tag was seen in {int(in_drive.sum())} pictures of the drive; {MIN_DRIVE_PICTURES} are needed at "
                f"least"
            )
        both = both * (seen_driving >= MIN_DRIVE_PICTURES)
        if not both.any():
            raise CalibrationError("no tag was seen in the turn and in the drive, too: keep one in sight in both")
    tag = int(both.argmax())
    turn, straight = (np.flatnonzero(part & (sightings.tag == tag)) for part in (in_turn, in_drive))
    up, centre, choice = turning_axis(cMt[turn], errors_px[turn])
    turn_poses = cMt[turn, choice]
    n = (turn_poses[:, :3, :3].transpose(0, 2, 1) @ up).mean(axis=0)
    upright = upright_poses(cMt, n / np.linalg.norm(n), up)
    guess = guess_drive(
        turn_poses, cMt[straight, upright[straight]], up, centre, forward=phases.forward, pan_rad=pan_rad
    )
    # Only frames that show that tag have a place yet; any other tag is put where its first such frame shows it.
    frames = np.concatenate([sightings.frame[turn], sightings.frame[straight]])
    order = np.argsort(frames)
    rank = np.full(sightings.frame_count, -1)
    rank[frames[order]] = np.arange(len(frames))
    here = sightings.where(used & (rank[sightings.frame] >= 0))
    kept = np.flatnonzero(used & (rank[sightings.frame] >= 0))
    path = np.concatenate([guess[2], guess[3]])[order]
    turning = (np.arange(len(frames)) < len(turn))[order]
    wMt = np.tile(np.eye(4), (len(here.ids), 1, 1))
    drive = drive_of((*guess[:2], path[turning], path[~turning], guess[4]), wMt, turning, frames[order])
    wMc = drive.world_from_base() @ drive.bMc
    reference = int(np.searchsorted(here.ids, sightings.ids[tag]))
    for place in range(len(here.ids)):
        if place == reference:
            wMt[place] = guess[1]
            continue
        rows = np.flatnonzero(here.tag == place)
        poses = wMc[here.frame[rows], None] @ cMt[kept[rows]]
        # The pose that the others agree with best, of all that all frames offer.
        offers = poses.reshape(-1, 4, 4)
        apart = np.linalg.norm(offers[:, None, :3, :3] - offers[None, :, :3, :3], axis=(2, 3))
        apart = apart.reshape(len(offers), -1, 2).min(axis=2).sum(axis=1)
        wMt[place] = offers[apart.argmin()]
    return drive, here


def _without(drive: Drive, sightings: Sightings, fits: np.ndarray) -> tuple[Drive, Sightings]:
    """Drive and sightings without those that do not fit; frames and tags that have none left go, too."""
    here = sightings.where(fits)
    frames, tags = np.unique(sightings.frame[fits]), np.unique(sightings.tag[fits])
    turning = drive.turning[frames]
    if turning.sum() < MIN_TURN_PICTURES or ((~drive.turning).any() and (~turning).sum() < MIN_DRIVE_PICTURES):
        raise CalibrationError(
            "most pictures do not fit a turn on the spot and a straight drive before tags that stand still: is the tag "
            "fixed and flat, and the calibration this camera's?"
        )
    left = replace(
        drive,
        wMt=drive.wMt[tags],
        turning=turning,
        path=drive.path[frames],
        slips=drive.slips[frames],
        frames=drive.frames[frames],
    )
    return left, here


def _result(
    drive: Drive,
    sightings: Sightings,
    slip: Slip,
    bundle: DriveBundle,
    uncertainty: Uncertainty,
    rms_px: float,
    dropped: int,
    height: HeightKnown | None,
    pan_rad: float | None,
    known_pan: bool,
) -> MountingCalibration:
    z_m, z_of = _height(drive, sightings, height)
    base = bundle.shared_base
    # d (x, y, z, pan, tilt, roll) / d shared unknowns, numerically; z through the tag whose height is known.
    eps = 1e-6
    rows = []
    for direction in base.T:
        values = []
        for sign in (1.0, -1.0):
            near = drive.moved_by(sign * eps * direction, np.zeros((len(drive.path), 3)))
            place = np.array([*near.bMc[:2, 3], _height(near, sightings, height)[0] or 0.0])
            values.append(np.concatenate([place, pan_tilt_roll(near.bMc[:3, :3])]))
        rows.append((values[0] - values[1]) / (2 * eps))
    J = np.stack(rows, axis=1)
    both = [
        np.diag(J @ c @ J.T) if np.isfinite(c).all() else np.full(6, np.inf)  # 0 times infinity would be no number
        for c in (uncertainty.least_squares, uncertainty.jackknife)
    ]
    sigma = np.sqrt(np.maximum(*both))
    missing = []
    if z_m is None:
        missing.append("the height (position_m's third number): give --height-m or --height-of ID=METRES")
        sigma[2] = np.inf
    elif z_of == "camera":
        sigma[2] = 0.0
    if known_pan:
        told = "taken as given" if pan_rad is not None else "taken for 0"
        radius_m = float(np.hypot(*drive.bMc[:2, 3]))
        missing.append(
            f"pan, and with it how much of the camera's {radius_m:.4f} m from the turning centre is forward and how "
            f"much to "
            f"the left: pan is {told}; add a straight drive"
        )
        sigma[[0, 1, 3]] = np.inf
    pan, tilt, roll = pan_tilt_roll(drive.bMc[:3, :3])
    position = [float(drive.bMc[0, 3]), float(drive.bMc[1, 3]), z_m or 0.0]
    mounting = CameraMounting(position_m=position, pan_rad=pan, tilt_rad=tilt, roll_rad=roll)
    theta, s = drive.path[drive.turning], drive.path[~drive.turning]
    turned_rad = float(np.ptp(theta))
    driven_m = float(np.ptp(s)) if len(s) else 0.0
    curvature = float(drive.start[3]) if len(s) else 0.0
    warnings = _warnings(turned_rad, driven_m, curvature, slip, rms_px, known_pan, pan)
    pictures = (int(drive.turning.sum()), int((~drive.turning).sum()))
    return MountingCalibration(
        mounting,
        sigma,
        tuple(missing),
        warnings,
        turned_rad,
        driven_m,
        curvature,
        slip,
        rms_px,
        pictures,
        dropped,
        drive,
    )


def _height(drive: Drive, sightings: Sightings, height: HeightKnown | None) -> tuple[float | None, str]:
    """The camera's height [m] and what it comes from; None if nothing says it. In ``drive`` the camera is at z = 0."""
    if height is None or (height.camera_m is None and height.tag is None):
        return None, ""
    if height.camera_m is not None:
        return height.camera_m, "camera"
    tag_id, height_m = height.tag
    if tag_id not in sightings.ids:
        raise CalibrationError(f"--height-of {tag_id}: that tag was not seen; seen were {sightings.ids.tolist()}")
    return float(height_m - drive.wMt[int(np.searchsorted(sightings.ids, tag_id)), 2, 3]), "tag"


def _warnings(
    turned_rad: float, driven_m: float, curvature_pm: float, slip: Slip, rms_px: float, known_pan: bool, pan_rad: float
) -> tuple[str, ...]:
    warnings = []
    if not known_pan and abs(pan_rad) > TO_THE_REAR_RAD:
        warnings.append(
            f"by this the camera looks to the rear (pan {math.degrees(pan_rad):.0f} degrees): if it looks ahead, the "
            "drive was the other way round: add --backwards, or leave it out"
        )
    if turned_rad < SMALL_TURN_RAD:
        warnings.append(
            f"the robot turned by {math.degrees(turned_rad):.0f} degrees only: more places the camera better"
        )
    if not known_pan and driven_m < SMALL_DRIVE_M:
        warnings.append(f"the robot drove {driven_m:.2f} m only: a longer way gives a better pan")
    if abs(curvature_pm) > MAX_CURVATURE_PM:
        warnings.append(f"the drive was no straight one (radius {1 / abs(curvature_pm):.1f} m): pan is less certain")
    if slip.turn_m > LARGE_WANDER_M:
        warnings.append(
            f"the turning centre wandered by {slip.turn_m * 1e3:.0f} mm (RMS): turn more slowly, on firm ground"
        )
    if rms_px > LARGE_RMS_PX:
        warnings.append(
            f"the corners are off by {rms_px:.2f} px (RMS): is the calibration this camera's, the tag flat and fixed, "
            f"and "
            "the ground level?"
        )
    return tuple(warnings)

"""Where the camera sits, roughly: from the poses of one tag alone, picture by picture."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation

from pilotfish.calibration.body.rigid import inverse
from pilotfish.calibration.mounting.drive import Drive
from pilotfish.errors import CalibrationError

CLEAR_FACTOR = 2.0  # by how much the better of a tag's two poses must fit better to be taken at once
ALIKE = 0.02  # rad, nearly: by less, one of two poses does not lean more than the other
MIN_TURN_RAD = math.radians(10.0)
MIN_DRIVE_M = 0.05
MAX_BACK = 0.25  # of the way: more is no noise, and no slip
_ROUNDS = 5


def turning_axis(cMt: np.ndarray, errors_px: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From both poses (N, 2, 4, 4) of a tag while the robot turns, with their errors (N, 2): the unit vector ``up_c``
    (3,) of the axis in the camera's frame, a point ``centre_c`` (3,) of it, and which pose (N,) of each picture is
    right.

    R_k R_j^T is a turn about up_c for any two pictures, so up_c spans what all its rotation vectors w_kj have in
    common: the first eigenvector of sum w w^T. A flipped pose turns about another axis, and loses. CalibrationError if
    the robot hardly turned.
    """
    everyone = np.arange(len(cMt))
    clear = errors_px[:, 1] > CLEAR_FACTOR * errors_px[:, 0]
    weights = np.where(clear, 1.0, 1e-2)
    choice = np.zeros(len(cMt), dtype=int)
    for _ in range(_ROUNDS):
        up = _common_axis(cMt[everyone, choice, :3, :3], weights)
        n = np.einsum("n,nij,i->j", weights, cMt[everyone, choice, :3, :3], up)  # up in the tag's frame
        n /= np.linalg.norm(n)
        better = upright_poses(cMt, n, up)
        if (better == choice).all():
            break
        choice, weights = better, np.ones(len(cMt))
    poses = cMt[everyone, choice]
    angles = angles_about(poses[:, :3, :3], up)
    if np.ptp(angles) < MIN_TURN_RAD:
        raise CalibrationError(
            f"the robot turned by {math.degrees(np.ptp(angles)):.1f} degrees only while the tag was seen: let it turn "
            f"on "
            "the spot until the tag has passed from one side of the picture to the other"
        )
    return up, _centre(poses, up), choice


def upright_poses(cMt: np.ndarray, up_t: np.ndarray, up_c: np.ndarray) -> np.ndarray:
    """(N,): which of both poses (N, 2, 4, 4) of an upright tag has its ``up_t`` (3,) along ``up_c`` (3,). Where both
    lean alike, as those of a tag that is as high as the camera do, the corners decide: the first pose fits them
    better."""
    lean = np.linalg.norm(cMt[:, :, :3, :3] @ up_t - up_c, axis=-1)
    return np.where(np.abs(lean[:, 0] - lean[:, 1]) < ALIKE, 0, lean.argmin(axis=1))


def angles_about(R: np.ndarray, up: np.ndarray) -> np.ndarray:
    """(N,) [rad]: by how much each of (N, 3, 3) is turned about ``up`` against the first."""
    turns = Rotation.from_matrix(R @ R[0].T).as_rotvec()
    return np.unwrap(turns @ up)


def _common_axis(R: np.ndarray, weights: np.ndarray) -> np.ndarray:
    apart = np.einsum("aij,bkj->abik", R, R).reshape(-1, 3, 3)
    w = Rotation.from_matrix(apart).as_rotvec() * np.sqrt(np.outer(weights, weights).reshape(-1, 1))
    axis = np.linalg.eigh(w.T @ w)[1][:, -1]
    return -axis if axis[1] > 0 else axis  # up is against the camera's y axis


def _centre(poses: np.ndarray, up: np.ndarray) -> np.ndarray:
    """c with R_k o + t_k = c across up, for a point o fixed to the tag: o and c by linear least squares.

    o and c slide along the axis together, and along it t_k says nothing: lstsq takes the shortest of them.
    """
    R, t = poses[:, :3, :3], poses[:, :3, 3]
    across = np.eye(3) - np.outer(up, up)
    A = np.concatenate([across @ R, -np.broadcast_to(across, R.shape)], axis=2).reshape(-1, 6)
    solution = np.linalg.lstsq(A, -(t @ across).ravel(), rcond=1e-9)[0]
    return across @ solution[3:]


def guess_drive(
    cMt_turn: np.ndarray,
    cMt_straight: np.ndarray,
    up_c: np.ndarray,
    centre_c: np.ndarray,
    *,
    forward: bool = True,
    pan_rad: float | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """bMc (4, 4), wMt (4, 4) of the tag, theta (N,), s (M,), start (4,), from the tag's poses in the turn (N, 4, 4) and
    in the drive (M, 4, 4), M may be 0; ``forward``: False if it drove backwards.

    The base's axes in the camera's frame are the rows of R: z = up, x = against the tag's motion while driving.
    """
    if len(cMt_straight):
        t = cMt_straight[:, :3, 3]
        third = max(len(t) // 3, 1)
        x = -(t[-third:].mean(axis=0) - t[:third].mean(axis=0)) * (1.0 if forward else -1.0)
        if np.linalg.norm(t[-1] - t[0]) < MIN_DRIVE_M:
            raise CalibrationError(
                f"the robot drove {np.linalg.norm(t[-1] - t[0]) * 1e3:.0f} mm only while the tag was seen: let it "
                f"drive "
                "straight for half a metre or more"
            )
        _check_one_way(t)
        x = x - (x @ up_c) * up_c
    else:
        x = _ahead(up_c, 0.0 if pan_rad is None else pan_rad)
    x /= np.linalg.norm(x)
    bMc = np.eye(4)
    bMc[:3, :3] = np.stack([x, np.cross(up_c, x), up_c])
    bMc[:3, 3] = -bMc[:3, :3] @ centre_c
    bMc[2, 3] = 0.0
    wMt = bMc @ cMt_turn[0]
    theta = -angles_about(cMt_turn[:, :3, :3], up_c)  # a robot that turns left sees the world turn right
    start, s = np.zeros(4), np.zeros(len(cMt_straight))
    if len(cMt_straight):
        wMb = wMt @ inverse(cMt_straight) @ inverse(bMc)
        start[:2] = wMb[0, :2, 3]
        start[2] = math.atan2(wMb[0, 1, 0], wMb[0, 0, 0])
        ahead = np.array([math.cos(start[2]), math.sin(start[2])])
        s = (wMb[:, :2, 3] - start[:2]) @ ahead
        s = s - s[0]
    return bMc, wMt, theta, s, start


def _check_one_way(places_m: np.ndarray) -> None:
    """CalibrationError if (M, 3) successive places lead back by more than MAX_BACK of the whole way: then neither their
    order nor --backwards says which direction is forward."""
    main = np.linalg.svd(places_m - places_m.mean(axis=0))[2][0]
    along = places_m @ main
    back = min((np.maximum.accumulate(way) - way).max() for way in (along, -along))
    if back > MAX_BACK * np.ptp(along):
        raise CalibrationError(
            f"in the straight drive the robot went back by {back:.2f} m: let it drive in one direction only"
        )


def _ahead(up_c: np.ndarray, pan_rad: float) -> np.ndarray:
    """The base's x axis in the camera's frame if the camera pans by that much."""
    level = np.array([0.0, 0.0, 1.0]) - up_c[2] * up_c  # where the camera looks, on the ground
    level /= np.linalg.norm(level)
    return math.cos(pan_rad) * level - math.sin(pan_rad) * np.cross(up_c, level)


def drive_of(
    guess: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    wMt: np.ndarray,
    turning: np.ndarray,
    frames: np.ndarray,
) -> Drive:
    """The Drive of a guess with all tags (T, 4, 4), its pictures, ``frames`` (N,), in the order that ``turning`` (N,)
    says."""
    bMc, _, theta, s, start = guess
    path = np.zeros(len(turning))
    path[turning], path[~turning] = theta, s
    return Drive(bMc, wMt, turning, path, start, np.zeros((len(turning), 3)), frames)

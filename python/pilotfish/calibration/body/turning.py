"""The axis about which the body turned in front of a camera that stood still: its base's z axis and origin.

A body that turns on flat ground keeps one direction n of its own upright, and one point o of its own in place, while
its poses (R_f, t_f) in the camera change: R_f n = m and, across m, R_f o + t_f = c for all frames f.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.errors import BodyLearningError

MIN_TURN = 0.98  # length of the mean of exp(i angle): an even turn by 40 degrees; more, and the axis is a guess
MIN_CLEAR = 5  # frames whose pose is unambiguous, to begin with
MAX_TILT = 0.6  # the camera's down axis against the turning axis: some 50 degrees


@dataclass(frozen=True)
class TurningAxis:
    """The axis about which a body turned, as its reference tag and the camera have it."""

    up: np.ndarray  # (3,) unit vector n in the reference tag's frame
    origin_m: np.ndarray  # (3,) the point o in it, at the height of the reference tag's centre
    up_c: np.ndarray  # (3,) unit vector m in the camera's frame
    centre_c_m: np.ndarray  # (3,) the point c in it
    wander_m: float  # RMS of where o really was around c, on the ground
    wobble_rad: float  # RMS angle between R_f n and m


def fit_turning_axis(cMr: np.ndarray, weights: np.ndarray | None = None) -> TurningAxis:
    """From the poses (N, 4, 4) of the reference tag in the camera, each counting ``weights`` (N,) times.

    Raises BodyLearningError if they did not turn enough, or not about an axis that is upright in the picture.
    """
    weights = np.ones(len(cMr)) if weights is None else weights
    weights = weights / weights.sum()
    R, t = cMr[:, :3, :3], cMr[:, :3, 3]
    # sum |R_f n - m|^2 is smallest where m . mean(R) n is largest: the first singular vectors of the mean.
    mean_R = np.einsum("n,nij->ij", weights, R)
    left, lengths, right = np.linalg.svd(mean_R)
    m, n = left[:, 0], right[0]
    if lengths[1] > MIN_TURN:
        raise BodyLearningError(
            "the robot hardly turned over the frames that can be used (those that show two tags, if it wears several): "
            "let it turn in place, by a quarter of a turn or more, with two tags in view, or give the reference tag's "
            "place on the robot with --reference-position"
        )
    if abs(m[1]) < MAX_TILT:
        raise BodyLearningError(
            "the turning axis lies across the picture: keep the camera still and upright while the robot turns in "
            "place, or give the reference tag's place on the robot with --reference-position"
        )
    if m[1] > 0:  # up is against the camera's y axis
        m, n = -m, -n
    # c is the mean of R_f o + t_f, so (R_f - mean R) o = mean t - t_f across m; o . n = 0 names one point of the axis.
    mean_t = weights @ t
    across = np.eye(3) - np.outer(m, m)
    A, b = across @ (R - mean_R), (mean_t - t) @ across
    normal = np.einsum("n,nki,nkj->ij", weights, A, A) + np.outer(n, n)
    origin = np.linalg.solve(normal, np.einsum("n,nki,nk->i", weights, A, b))
    origin -= (origin @ n) * n
    off_centre = np.einsum("nij,j->ni", A, origin) - b
    tilt = np.linalg.norm(np.cross(R @ n, m), axis=1)
    return TurningAxis(
        up=n,
        origin_m=origin,
        up_c=m,
        centre_c_m=mean_R @ origin + mean_t,
        wander_m=float(np.sqrt(weights @ (off_centre**2).sum(axis=1))),
        wobble_rad=float(np.sqrt(weights @ tilt**2)),
    )


def settle_flips(cMt: np.ndarray, errors_px: np.ndarray) -> np.ndarray:
    """cMr (N, 4, 4) of a lonely tag: in each frame the one of its two poses (N, 2, 4, 4) that turns about the axis.

    The frames whose corners decide by themselves (errors (N, 2) a factor of two apart) say where the axis is; with it
    the others are decided, which says better where it is.
    """
    everyone, chosen = np.arange(len(cMt)), np.zeros(len(cMt), dtype=int)
    clear = errors_px[:, 1] > 2.0 * errors_px[:, 0]
    weights = np.where(clear, 1.0, 1e-3 if clear.sum() >= MIN_CLEAR else 1.0)
    for _ in range(10):
        axis = fit_turning_axis(cMt[everyone, chosen], weights)
        lean = np.linalg.norm(cMt[..., :3, :3] @ axis.up - axis.up_c, axis=-1)
        centre = cMt[..., :3, :3] @ axis.origin_m + cMt[..., :3, 3] - axis.centre_c_m
        across = centre - (centre @ axis.up_c)[..., None] * axis.up_c
        lever_m = max(float(np.linalg.norm(axis.origin_m)), 1e-3)
        choice = (lean**2 + (across**2).sum(axis=-1) / lever_m**2).argmin(axis=1)
        if (choice == chosen).all() and (weights == 1.0).all():
            break
        chosen, weights = choice, np.ones(len(cMt))
    return cMt[everyone, chosen]


def turned_rad(axis: TurningAxis, cMr: np.ndarray) -> float:
    """The arc that the frames cover: what is left of the full circle without the largest gap between two of them."""
    body_axis = np.linalg.svd(axis.up[None])[2][1]  # any direction across it
    first = np.linalg.svd(axis.up_c[None])[2][1]
    seen = cMr[:, :3, :3] @ body_axis
    angles = np.sort(np.arctan2(seen @ np.cross(axis.up_c, first), seen @ first))
    return float(2 * np.pi - np.diff(angles, append=angles[0] + 2 * np.pi).max())

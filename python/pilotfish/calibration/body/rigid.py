"""Rigid motions as (..., 4, 4) arrays, and the small turns that least squares moves them by.

A pose is moved in its own frame: ``R = R0 exp(w)``, ``t = t0 + R0 v`` with the step ``(v, w)`` in metres and
radians.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation


def skew(vectors: np.ndarray) -> np.ndarray:
    """(..., 3) to the (..., 3, 3) matrices of the cross product from the left."""
    matrices = np.zeros((*vectors.shape, 3))
    matrices[..., 0, 1], matrices[..., 0, 2], matrices[..., 1, 2] = -vectors[..., 2], vectors[..., 1], -vectors[..., 0]
    return matrices - np.swapaxes(matrices, -1, -2)


def inverse(poses: np.ndarray) -> np.ndarray:
    """(..., 4, 4) likewise."""
    result = np.zeros_like(poses)
    result[..., :3, :3] = np.swapaxes(poses[..., :3, :3], -1, -2)
    result[..., :3, 3] = -np.einsum("...ji,...j->...i", poses[..., :3, :3], poses[..., :3, 3])
    result[..., 3, 3] = 1.0
    return result


def transform(poses: np.ndarray, points_m: np.ndarray) -> np.ndarray:
    """(..., 4, 4) applied to (..., P, 3)."""
    return np.einsum("...ij,...pj->...pi", poses[..., :3, :3], points_m) + poses[..., None, :3, 3]


def moved(poses: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """(N, 4, 4) poses moved by (N, 6) steps (v, w), each in its own frame."""
    result = poses.copy()
    result[:, :3, :3] = poses[:, :3, :3] @ Rotation.from_rotvec(steps[:, 3:]).as_matrix()
    result[:, :3, 3] += np.einsum("nij,nj->ni", poses[:, :3, :3], steps[:, :3])
    return result


def step_between(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The (N, 6) steps that move ``start`` to ``end``: the inverse of ``moved``."""
    difference = inverse(start) @ end
    return np.concatenate([difference[:, :3, 3], Rotation.from_matrix(difference[:, :3, :3]).as_rotvec()], axis=1)


def right_jacobian(turns_rad: np.ndarray) -> np.ndarray:
    """(N, 3, 3) with exp(w + dw) = exp(w) exp(J dw) to first order, for (N, 3) turns w.

    J = I - (1 - cos a) / a^2 [w] + (a - sin a) / a^3 [w]^2 with a = |w|; below 1e-4 rad by its series.
    """
    angle = np.linalg.norm(turns_rad, axis=1)[:, None, None]
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5, (1.0 - np.cos(safe)) / safe**2)
    second = np.where(small, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
    cross = skew(turns_rad)
    return np.eye(3) - first * cross + second * (cross @ cross)


def mean_pose(poses: np.ndarray) -> np.ndarray:
    """(N, 4, 4) to one: the mean turn, and the median place."""
    result = np.eye(4)
    result[:3, :3] = Rotation.from_matrix(poses[:, :3, :3]).mean().as_matrix()
    result[:3, 3] = np.median(poses[:, :3, 3], axis=0)
    return result

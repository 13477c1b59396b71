"""Poses from known points, many at once: of a tag in one sighting, of a body in one frame.

A square seen from afar has two poses that explain its corners: the depths of its corners, along the line of sight,
may all be turned round. Nearly frontal views and noise decide between them by luck, so both are kept here; who
compares several frames can tell them apart.
"""

from __future__ import annotations

import math

import numpy as np

from pilotfish.calibration.body.projection import project
from pilotfish.calibration.body.rigid import moved, skew, transform
from pilotfish.calibration.body.sightings import Sightings
from pilotfish.core import BodyTag, CameraModel, LeaderBody, TagDetection
from pilotfish.vision import estimate_leader_pose

_ITERATIONS = 15


def both_tag_poses(camera: CameraModel, sightings: Sightings) -> tuple[np.ndarray, np.ndarray]:
    """cMt of each sighting's tag: (S, 2, 4, 4), better one first, and (S, 2) reprojection errors [px].

    A sighting that no pose explains has infinite errors.
    """
    first = np.tile(np.eye(4), (len(sightings), 1, 1))
    usable = np.zeros(len(sightings), dtype=bool)
    for k, (tag, corners_px) in enumerate(zip(sightings.tag, sightings.corners_px, strict=True)):
        body_tag = BodyTag(size_m=float(sightings.sizes_m[tag]), facing_rad=math.pi)
        seen = TagDetection(id=body_tag.id, corners_px=corners_px)
        pose = estimate_leader_pose(camera=camera, body=LeaderBody([body_tag]), tags=[seen])
        if pose is not None:
            first[k], usable[k] = pose.cMo @ body_tag.oMt, True
    starts = np.concatenate([first, flipped(first)])
    twice = [np.concatenate([each, each]) for each in (sightings.corners_m, sightings.corners_px)]
    poses, errors = refine_poses(camera, starts, *twice)
    errors[~np.concatenate([usable, usable])] = np.inf
    poses, errors = poses.reshape(2, -1, 4, 4).swapaxes(0, 1), errors.reshape(2, -1).T
    order = np.argsort(errors, axis=1)
    return np.take_along_axis(poses, order[..., None, None], axis=1), np.take_along_axis(errors, order, axis=1)


def flipped(cMt: np.ndarray) -> np.ndarray:
    """(N, 4, 4): the other pose of a plane seen from afar.

    With v the line of sight, H = I - 2 v v^T turns the depths of the axes x and y round and leaves what is seen of
    them; the third axis is their cross product, H x times H y = -H z.
    """
    sight = cMt[:, :3, 3] / np.maximum(np.linalg.norm(cMt[:, :3, 3], axis=1, keepdims=True), 1e-12)
    mirror = np.eye(3) - 2.0 * np.einsum("ni,nj->nij", sight, sight)
    result = cMt.copy()
    result[:, :3, :3] = mirror @ cMt[:, :3, :3] * np.array([1.0, 1.0, -1.0])
    return result


def refine_poses(
    camera: CameraModel, starts: np.ndarray, points_m: np.ndarray, pixels: np.ndarray, weights: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Levenberg-Marquardt on N poses at once: (N, 4, 4) and (N,) RMS reprojection errors [px].

    ``points_m`` (N, P, 3) in the object's frame are seen at ``pixels`` (N, P, 2); ``weights`` (N, P): 0 where a
    place is empty.
    """
    weights = np.ones(pixels.shape[:2]) if weights is None else weights
    poses, damping = starts.copy(), np.full(len(starts), 1e-4)
    cost = _cost(camera, poses, points_m, pixels, weights)
    for _ in range(_ITERATIONS):
        points_c = transform(poses, points_m)
        seen, derivative = project(camera, points_c)
        rotation = poses[:, None, :3, :3]
        jacobian = np.concatenate([derivative @ rotation, -derivative @ rotation @ skew(points_m)], axis=-1)
        weighted = jacobian * weights[..., None, None]
        gradient = np.einsum("npka,npk->na", weighted, pixels - seen)
        hessian = np.einsum("npka,npkb->nab", weighted, jacobian)
        diagonal = np.einsum("naa->na", hessian)
        damped = hessian + np.eye(6) * (damping[:, None] * diagonal + 1e-12)[:, None, :]
        candidates = moved(poses, np.linalg.solve(damped, gradient[..., None])[..., 0])
        new_cost = _cost(camera, candidates, points_m, pixels, weights)
        better = new_cost < cost
        poses[better], cost[better] = candidates[better], new_cost[better]
        damping = np.where(better, damping / 5.0, damping * 10.0).clip(1e-9, 1e9)
    return poses, np.sqrt(cost / np.maximum(weights.sum(axis=1), 1.0))


def _cost(
    camera: CameraModel, poses: np.ndarray, points_m: np.ndarray, pixels: np.ndarray, weights: np.ndarray
) -> np.ndarray:
    return (((project(camera, transform(poses, points_m))[0] - pixels) ** 2).sum(axis=-1) * weights).sum(axis=1)

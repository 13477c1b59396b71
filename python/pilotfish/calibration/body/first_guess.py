"""A first layout: from tag to tag along the pairs that were seen together most often."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree

from pilotfish.calibration.body.pairs import Pair
from pilotfish.calibration.body.rigid import inverse, transform
from pilotfish.calibration.body.sightings import Sightings
from pilotfish.calibration.body.single_pose import refine_poses
from pilotfish.core import CameraModel
from pilotfish.errors import BodyLearningError

MIN_COMMON = 3  # frames that join two tags
MIN_AGREEING = 0.5  # share of the voters: fewer, and the two move against each other


def guess_layout(ids: np.ndarray, pairs: list[Pair], reference: int) -> np.ndarray:
    """rMt (T, 4, 4) of every tag in the frame of the tag at place ``reference``.

    Raises BodyLearningError, with the groups, if some tags were never seen together with the others.
    """
    joining = [pair for pair in pairs if pair.agreeing >= max(MIN_COMMON, MIN_AGREEING * pair.voters)]
    tags = len(ids)
    # The tree with the most agreeing frames is the one with the least 1 / frames.
    rows, columns = [pair.a for pair in joining], [pair.b for pair in joining]
    graph = coo_array(([1.0 / pair.agreeing for pair in joining], (rows, columns)), shape=(tags, tags)).tocsr()
    groups, group = connected_components(graph, directed=False)
    if groups > 1:
        raise BodyLearningError(_apart([ids[group == g].tolist() for g in range(groups)]))
    between = {(pair.a, pair.b): pair.aMb for pair in joining}
    between |= {(b, a): inverse(aMb) for (a, b), aMb in between.items()}
    order, before = breadth_first_order(minimum_spanning_tree(graph), reference, directed=False)
    layout = np.tile(np.eye(4), (tags, 1, 1))
    for tag in order[1:]:
        layout[tag] = layout[before[tag]] @ between[int(before[tag]), int(tag)]
    return layout


def _apart(groups: list[list[int]]) -> str:
    named = "; ".join("{" + ", ".join(map(str, group)) + "}" for group in groups)
    return (
        f"these groups of tags were never seen together, or move against each other: {named}. Film so that a tag of "
        f"one and a tag of the other are in one picture for at least {MIN_COMMON} frames (turn more slowly, from a "
        "little farther away), put another tag between them, or name tags that are not on the robot with --ignore ID"
    )


def pose_frames(
    camera: CameraModel, sightings: Sightings, cMt: np.ndarray, layout: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """cMr (N, 4, 4) of each frame and its (N,) RMS error [px]: the best that either pose of any of its tags leads to.

    ``cMt`` (S, 2, 4, 4): both poses of each sighting.
    """
    starts = (cMt @ inverse(layout)[sightings.tag][:, None]).reshape(-1, 4, 4)
    frame = np.repeat(sightings.frame, 2)
    points_m, pixels, weights = _by_frame(sightings, layout)
    poses, errors = refine_poses(camera, starts, points_m[frame], pixels[frame], weights[frame])
    best_first = np.lexsort((errors, frame))
    best = best_first[np.unique(frame[best_first], return_index=True)[1]]
    return poses[best], errors[best]


def _by_frame(sightings: Sightings, layout: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The corners of each frame with a place for every tag: (N, 4 T, 3) [m], (N, 4 T, 2) [px], (N, 4 T) 0 or 1."""
    shape = (sightings.frame_count, len(sightings.ids), 4)
    points_m, pixels, weights = np.zeros((*shape, 3)), np.zeros((*shape, 2)), np.zeros(shape)
    here = (sightings.frame, sightings.tag)
    points_m[here] = transform(layout[sightings.tag], sightings.corners_m)
    pixels[here], weights[here] = sightings.corners_px, 1.0
    frames, corners = shape[0], shape[1] * 4
    return points_m.reshape(frames, corners, 3), pixels.reshape(frames, corners, 2), weights.reshape(frames, corners)

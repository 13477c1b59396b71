"""How near and how far each tag can be followed with a given camera."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from pilotfish.core import BodyTag, CameraModel, CameraMounting, LeaderBody
from pilotfish.vision import LeaderObserverConfig, TagFamily, nearest_visible_distance_m

# Pixels that a cell must keep so that the detector finds the tag (docs/vision.md, "Acquisition").
FOUND_CELL_PX = 1.55
# Pixels that a cell must have so that the tracker follows the tag: measured on renders (blur of 0.7 px), where every
# tag was followed at 1.0 and none at 0.95. vision.min_cell_px, if it is larger, ends it earlier.
FOLLOWED_CELL_PX = 1.0


@dataclass(frozen=True)
class Viewer:
    """Who looks: the coordinator's camera, where it sits, and how it looks for tags."""

    camera: CameraModel
    mounting: CameraMounting
    config: LeaderObserverConfig = field(default_factory=LeaderObserverConfig)


@dataclass(frozen=True)
class TagReach:
    """Distances between the robots' turning centres [m] at which one tag, straight ahead and looking at the camera, can
    be used: nearest_m (inf: never within 5 m), found_to_m (by a detector, without knowing where), followed_to_m."""

    id: int
    nearest_m: float
    found_to_m: float
    followed_to_m: float


def tag_reach(body: LeaderBody, viewer: Viewer) -> list[TagReach]:
    """Of each tag of the body.

    Seen squarely at the depth Z, a cell is f size / (n Z) pixels wide, n cells to the black square. It is followed down
    to FOLLOWED_CELL_PX or vision.min_cell_px, and found down to FOUND_CELL_PX, but not beyond
    vision.acquisition_range_m, to which the search is tuned. Between the turning centres lie also the camera's place
    ahead of its own, and the tag's place on the leader."""
    focal_px = min(viewer.camera.fx, viewer.camera.fy)
    cells = TagFamily(body.family).cells_at_border
    reaches = []
    for tag in body.tags:
        cell_m = tag.size_m / cells
        between_m = float(viewer.mounting.position_m[0]) + _towards_viewer_m(tag)
        found_m = min(focal_px * cell_m / FOUND_CELL_PX, viewer.config.acquisition_range_m)
        followed_m = focal_px * cell_m / max(FOLLOWED_CELL_PX, viewer.config.gates.min_cell_px)
        alone = LeaderBody([tag], family=body.family, name=body.name)
        nearest_m = nearest_visible_distance_m(viewer.camera, viewer.mounting, alone)
        reaches.append(TagReach(tag.id, nearest_m, found_m + between_m, followed_m + between_m))
    return reaches


def _towards_viewer_m(tag: BodyTag) -> float:
    """How far the tag is in front of the leader's turning centre for who looks at it from where it faces."""
    looks = -tag.oMt[:2, 2]
    length = float(np.linalg.norm(looks))
    return float(looks @ np.asarray(tag.position_m)[:2]) / length if length > 1e-6 else 0.0


def reach_of_body(reaches: list[TagReach]) -> tuple[float, float, float]:
    """Nearest, found to, followed to: of the tag that is best at each."""
    nearest = min((reach.nearest_m for reach in reaches), default=math.inf)
    return nearest, max(reach.found_to_m for reach in reaches), max(reach.followed_to_m for reach in reaches)

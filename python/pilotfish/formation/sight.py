"""Whether a robot sees another one: a whole tag in the picture, turned towards the camera, and nothing before it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pilotfish.core import LeaderBody
from pilotfish.leader.reach import Viewer, reach_of_body, tag_reach
from pilotfish.leader.sheets import sheet_of

MIN_FACING = 0.2  # cosine of the largest viewing angle at which a tag is followed (vision/tag_tracker.hpp)
_STEP_RAD = math.radians(0.1)

Pose = tuple[float, float, float]  # (x_m, y_m, heading_rad) in the frame of whoever looks


@dataclass(frozen=True)
class Outlook:
    """What every robot of a formation looks with, and what each looks like: one camera, one body, one box
    ((length, width) [m], around the turning centre)."""

    viewer: Viewer
    body: LeaderBody
    box_m: tuple[float, float]

    @cached_property
    def sheets_m(self) -> np.ndarray:
        """(T, 5, 3): of each tag the centre of its paper and its corners, in the base frame of who wears it."""
        sheets = [sheet_of(tag, self.body.family) for tag in self.body.tags]
        return np.array([[sheet.centre_m, *sheet.corners_m()] for sheet in sheets])

    @cached_property
    def into_wall(self) -> np.ndarray:
        """(T, 3) units: away from who reads the tag, in the same frame."""
        return np.array([tag.oMt[:3, 2] for tag in self.body.tags])

    @cached_property
    def camera_from_base(self) -> np.ndarray:
        """(4, 4): from the base to the camera."""
        return np.linalg.inv(self.viewer.mounting.bMc)

    @cached_property
    def footprint_m(self) -> tuple[float, float, float, float]:
        """(rear, front, right, left) [m] of what hides others: box and tags, seen from above."""
        length_m, width_m = self.box_m
        x_m, y_m = self.sheets_m[..., 0].ravel(), self.sheets_m[..., 1].ravel()
        return (
            min(-length_m / 2, float(x_m.min())),
            max(length_m / 2, float(x_m.max())),
            min(-width_m / 2, float(y_m.min())),
            max(width_m / 2, float(y_m.max())),
        )

    @cached_property
    def radius_m(self) -> float:
        """Of the circle around the turning centre that the footprint lies in [m]."""
        rear, front, right, left = self.footprint_m
        return math.hypot(max(front, -rear), max(left, -right))

    @cached_property
    def reach_m(self) -> tuple[float, float]:
        """(nearest, farthest) [m] between turning centres at which a tag can be followed and found: the coordinator's
        own rule (``vision.nearest_visible_distance_m``) and ``pilotfish leader check``'s."""
        nearest_m, found_to_m, _ = reach_of_body(tag_reach(self.body, self.viewer))
        return nearest_m, found_to_m


def whole_tags(outlook: Outlook, leader: Pose, others: Iterable[Pose] = ()) -> list[int]:
    """Which tags of a leader at ``leader`` are seen as a whole: all corners of the paper in the picture, at an angle at
    which a tag can be read, and no straight line from the camera to its corners or its centre through one of the
    ``others``. Indices into the body's tags."""
    return list(_whole_tags(outlook, leader, others))


def sees(outlook: Outlook, leader: Pose, others: Iterable[Pose] = ()) -> bool:
    """Whether there is one of ``whole_tags``."""
    return any(True for _ in _whole_tags(outlook, leader, others))


def _whole_tags(outlook: Outlook, leader: Pose, others: Iterable[Pose]) -> Iterator[int]:
    x_m, y_m, heading_rad = leader
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    bRo = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    points_b = outlook.sheets_m @ bRo.T + (x_m, y_m, 0.0)
    points_c = points_b @ outlook.camera_from_base[:3, :3].T + outlook.camera_from_base[:3, 3]
    away_c = outlook.into_wall @ (outlook.camera_from_base[:3, :3] @ bRo).T
    eye_m = tuple(outlook.viewer.mounting.position_m[:2])
    # Who is farther away than any tag, and half of himself, hides none.
    reach_m = math.hypot(x_m, y_m) + 2.0 * outlook.radius_m
    near = [pose for pose in others if pose[0] ** 2 + pose[1] ** 2 <= reach_m**2]
    for k in range(len(points_c)):
        if not (_faces(points_c[k, 0], away_c[k]) and _in_picture(outlook, points_c[k])):
            continue
        lines = points_b[k, :, :2].tolist() if near else []
        if not any(_hidden(outlook, eye_m, lines, pose) for pose in near):
            yield k


def bearing_range_rad(outlook: Outlook, distance_m: float) -> tuple[float, float] | None:
    """(rightmost, leftmost) bearing at which a leader at that distance that looks the same way is seen, around the
    middle of the picture; None if it is not seen there at all. To 0.1 degrees."""
    middle_rad = outlook.viewer.mounting.pan_rad
    at = lambda k: pose_at(distance_m, middle_rad + k * _STEP_RAD)  # noqa: E731
    seen = [k for k in range(-900, 901) if sees(outlook, at(k))]
    return (middle_rad + seen[0] * _STEP_RAD, middle_rad + seen[-1] * _STEP_RAD) if seen else None


def pose_at(distance_m: float, bearing_rad: float, heading_rad: float = 0.0) -> Pose:
    """The pose of a leader at that distance and bearing."""
    return distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad), heading_rad


def seen_from(own: Pose, other: Pose) -> Pose:
    """``other``, given in the frame in which ``own`` is, in the frame of ``own``."""
    dx, dy = other[0] - own[0], other[1] - own[1]
    c, s = math.cos(own[2]), math.sin(own[2])
    return c * dx + s * dy, -s * dx + c * dy, other[2] - own[2]


def _faces(centre_c: np.ndarray, away_c: np.ndarray) -> bool:
    return bool(centre_c[2] > 0.0 and centre_c @ away_c >= MIN_FACING * np.linalg.norm(centre_c))


def _in_picture(outlook: Outlook, points_c: np.ndarray) -> bool:
    camera = outlook.viewer.camera
    for point in points_c:
        if point[2] <= 0.0:
            return False
        pixel = camera.project(point)
        if pixel is None or not (-0.5 <= pixel[0] <= camera.width - 0.5 and -0.5 <= pixel[1] <= camera.height - 0.5):
            return False
    return True


def _hidden(outlook: Outlook, eye_m: Sequence[float], points_m: Sequence[Sequence[float]], obstacle: Pose) -> bool:
    """Whether a straight line from the eye to one of the points crosses the obstacle's footprint."""
    rear, front, right, left = outlook.footprint_m
    start = seen_from(obstacle, (eye_m[0], eye_m[1], 0.0))
    ends = (seen_from(obstacle, (x_m, y_m, 0.0)) for x_m, y_m in points_m)
    return any(_crosses(start, end, (rear, front), (right, left)) for end in ends)


def _crosses(start: Pose, end: Pose, *sides: tuple[float, float]) -> bool:
    """Whether the segment has a point within both intervals: the slabs of a rectangle along the axes."""
    first, last = 0.0, 1.0
    for axis, (low, high) in enumerate(sides):
        at, along = start[axis], end[axis] - start[axis]
        if abs(along) < 1e-12:
            if not low <= at <= high:
                return False
            continue
        ends = sorted(((low - at) / along, (high - at) / along))
        first, last = max(first, ends[0]), min(last, ends[1])
    return first <= last

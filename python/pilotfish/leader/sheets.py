"""Tags as sheets in space: rectangles that can hide each other, or be in each other's way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.core import BodyTag
from pilotfish.vision import TagFamily

WHITE_CELLS = 1  # the border that a tag needs
APART_M = 0.001  # sheets that are nearer lie on each other


@dataclass(frozen=True)
class Sheet:
    """A square in the leader's base frame: centre_m (3,), axes (3, 3) with columns right, down and into the wall as one
    reads it, half_m (half of its side)."""

    centre_m: np.ndarray
    axes: np.ndarray
    half_m: float

    @property
    def looks(self) -> np.ndarray:
        """(3,) unit: where it faces."""
        return -self.axes[:, 2]

    def corners_m(self) -> np.ndarray:
        """(4, 3): bottom left, bottom right, top right, top left."""
        signs = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]])
        return self.centre_m + self.half_m * signs @ self.axes[:, :2].T

    def shrunk(self, by_m: float) -> Sheet:
        """The same, with that much cut off on all sides."""
        return Sheet(self.centre_m, self.axes, max(self.half_m - by_m, 0.0))

    def hides(self, eye_m: np.ndarray, point_m: np.ndarray) -> np.ndarray:
        """Whether it is between the eyes (N, 3) and a point (3,) that lies a millimetre or more behind it. Tags that
        are glued onto one board do not hide each other."""
        normal = self.axes[:, 2]
        before, after = (eye_m - self.centre_m) @ normal, (point_m - self.centre_m) @ normal
        crosses = (before * after < 0.0) & (np.abs(after) >= APART_M)
        share = np.where(crosses, before / np.where(crosses, before - after, 1.0), 0.0)
        through = eye_m + share[:, None] * (point_m - eye_m)
        return crosses & (np.abs((through - self.centre_m) @ self.axes[:, :2]) < self.half_m).all(axis=-1)

    def on_line(self, point_m: np.ndarray, direction: np.ndarray) -> tuple[float, float]:
        """From where to where a line in its plane, point_m + t direction, is inside of it: t; the first is the larger
        if it is nowhere."""
        first, last = -np.inf, np.inf
        for axis in (self.axes[:, 0], self.axes[:, 1]):
            at, slope = float((point_m - self.centre_m) @ axis), float(direction @ axis)
            if abs(slope) < 1e-12:
                if abs(at) >= self.half_m:
                    return 1.0, -1.0
                continue
            ends = sorted(((-self.half_m - at) / slope, (self.half_m - at) / slope))
            first, last = max(first, ends[0]), min(last, ends[1])
        return first, last


def sheet_of(tag: BodyTag, family: str, *, with_border: bool = True) -> Sheet:
    """The paper of a tag: its black square, and the white border around it."""
    oMt = tag.oMt
    side_m = tag.size_m
    if with_border:
        bitmap = TagFamily(family)
        side_m *= max(bitmap.bitmap(tag.id).shape[0], bitmap.cells_at_border + 2 * WHITE_CELLS) / bitmap.cells_at_border
    return Sheet(oMt[:3, 3], oMt[:3, :3], side_m / 2)


def overlap(a: Sheet, b: Sheet) -> bool:
    """Whether two sheets are in each other's way: they cross, or lie on each other, nearer than APART_M in parallel
    planes.

    Two squares cross if they share a part of the line in which their planes meet.
    """
    normals = a.axes[:, 2], b.axes[:, 2]
    if abs(normals[0] @ normals[1]) > np.cos(np.radians(1.0)):
        return bool(abs(normals[0] @ (b.centre_m - a.centre_m)) < APART_M and _overlap_in_plane(a, b))
    direction = np.cross(*normals)
    direction /= np.linalg.norm(direction)
    offsets = [normals[0] @ a.centre_m, normals[1] @ b.centre_m, direction @ a.centre_m]
    point = np.linalg.solve(np.array([*normals, direction]), offsets)
    parts = a.on_line(point, direction), b.on_line(point, direction)
    return max(first for first, _ in parts) < min(last for _, last in parts)


def to_fold_m(a: Sheet, b: Sheet) -> tuple[float, float] | None:
    """How far each centre is from the line in which the planes of two sheets meet, if an edge of both is parallel to it
    and they lie beside each other there: two faces of one folded sheet. None for others."""
    direction = np.cross(a.axes[:, 2], b.axes[:, 2])
    length = float(np.linalg.norm(direction))
    if length < np.sin(np.radians(10.0)):
        return None
    direction /= length
    if any(np.abs(direction @ sheet.axes[:, :2]).max() < np.cos(np.radians(3.0)) for sheet in (a, b)):
        return None
    if abs(float((b.centre_m - a.centre_m) @ direction)) > min(a.half_m, b.half_m):
        return None  # one is above the other
    offsets = [a.axes[:, 2] @ a.centre_m, b.axes[:, 2] @ b.centre_m, direction @ a.centre_m]
    point = np.linalg.solve(np.array([a.axes[:, 2], b.axes[:, 2], direction]), offsets)
    away = [(sheet.centre_m - point) - direction * ((sheet.centre_m - point) @ direction) for sheet in (a, b)]
    return float(np.linalg.norm(away[0])), float(np.linalg.norm(away[1]))


def _overlap_in_plane(a: Sheet, b: Sheet) -> bool:
    """Two squares in one plane overlap unless one of their four edge directions separates them (separating axes)."""
    for axes in (a.axes, b.axes):
        for axis in (axes[:, 0], axes[:, 1]):
            one, other = a.corners_m() @ axis, b.corners_m() @ axis
            if one.max() <= other.min() or other.max() <= one.min():
                return False
    return True

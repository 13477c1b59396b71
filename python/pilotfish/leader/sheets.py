"""Tags as sheets in space: rectangles that can hide each other, or be in each other's way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pilotfish.core import BodyTag
from pilotfish.vision import TagFamily

WHITE_CELLS = 1  # the border that a tag needs


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

    def is_crossed(self, start_m: np.ndarray, end_m: np.ndarray) -> np.ndarray:
        """Whether the segments from start_m to end_m (..., 3) go through it."""
        normal = self.axes[:, 2]
        before, after = (start_m - self.centre_m) @ normal, (end_m - self.centre_m) @ normal
        crosses = before * after < 0.0
        share = np.where(crosses, before / np.where(crosses, before - after, 1.0), 0.0)
        point = start_m + share[..., None] * (end_m - start_m)
        return crosses & (np.abs((point - self.centre_m) @ self.axes[:, :2]) < self.half_m).all(axis=-1)


def sheet_of(tag: BodyTag, family: str, *, with_border: bool = True) -> Sheet:
    """The paper of a tag: its black square, and the white border around it."""
    oMt = tag.oMt
    side_m = tag.size_m
    if with_border:
        bitmap = TagFamily(family)
        side_m *= max(bitmap.bitmap(tag.id).shape[0], bitmap.cells_at_border + 2 * WHITE_CELLS) / bitmap.cells_at_border
    return Sheet(oMt[:3, 3], oMt[:3, :3], side_m / 2)


def overlap(a: Sheet, b: Sheet, *, apart_m: float = 0.001) -> bool:
    """Whether two sheets are in each other's way: they cross, or lie on each other, nearer than apart_m in parallel
    planes."""
    if abs(a.axes[:, 2] @ b.axes[:, 2]) > np.cos(np.radians(1.0)):
        return bool(abs(a.axes[:, 2] @ (b.centre_m - a.centre_m)) < apart_m and _overlap_in_plane(a, b))
    edges = [(s, *edge) for s, other in ((a, b), (b, a)) for edge in _edges(other)]
    return any(bool(sheet.is_crossed(start, end)) for sheet, start, end in edges)


def _edges(sheet: Sheet) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    corners = sheet.corners_m()
    for k in range(4):
        yield corners[k], corners[(k + 1) % 4]


def _overlap_in_plane(a: Sheet, b: Sheet) -> bool:
    """Two squares in one plane overlap unless one of their four edge directions separates them (separating axes)."""
    for axes in (a.axes, b.axes):
        for axis in (axes[:, 0], axes[:, 1]):
            one, other = a.corners_m() @ axis, b.corners_m() @ axis
            if one.max() <= other.min() or other.max() <= one.min():
                return False
    return True

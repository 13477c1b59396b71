"""From which directions which tags of a leader can be read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.core import LeaderBody
from pilotfish.leader.sheets import Sheet, sheet_of

# The cosine of the largest viewing angle at which a tag is followed: TagTracker::kMinFacing, vision/tag_tracker.hpp.
MIN_FACING = 0.2
_SAME_PLANE_RAD, _SAME_PLANE_M = np.radians(3.0), 0.005


@dataclass(frozen=True)
class Sector:
    """Directions from from_deg to to_deg, counter-clockwise; from_deg is in [0, 360) and to_deg may be above 360."""

    from_deg: float
    to_deg: float

    @property
    def width_deg(self) -> float:
        """360 for all round."""
        return self.to_deg - self.from_deg

    def __str__(self) -> str:
        return "all round" if self.width_deg >= 360.0 else f"{self.from_deg:g}° to {self.to_deg % 360.0:g}°"


@dataclass(frozen=True)
class Visibility:
    """What is seen of a leader all round. azimuth_deg (N,): direction from the leader to who looks: 0 from its front,
    90 from its left, 180 from behind; seen (N, T) bool: which of the body's tags; planes (N,): in how many planes those
    are; distance_m and height_m: of who looks, from the leader's turning centre and above the ground."""

    azimuth_deg: np.ndarray
    seen: np.ndarray
    planes: np.ndarray
    distance_m: float
    height_m: float

    def sectors(self, wanted: np.ndarray) -> list[Sector]:
        """Where the mask ``wanted`` (N,) holds, as sectors of whole steps."""
        step = 360.0 / len(self.azimuth_deg)
        if wanted.all():
            return [Sector(0.0, 360.0)]
        starts = np.flatnonzero(wanted & ~np.roll(wanted, 1))
        found = []
        for start in starts:
            count = next(k for k in range(1, len(wanted) + 1) if not wanted[(start + k) % len(wanted)])
            found.append(Sector(float(self.azimuth_deg[start]), float(self.azimuth_deg[start] + (count - 1) * step)))
        return found

    def blind(self) -> list[Sector]:
        """From where no tag is seen."""
        return self.sectors(~self.seen.any(axis=1))

    def at(self, azimuth_deg: float) -> np.ndarray:
        """(T,) bool: the tags seen from the nearest direction that was looked from."""
        return self.seen[int(np.argmin(np.abs((self.azimuth_deg - azimuth_deg + 180.0) % 360.0 - 180.0)))]


def look_all_round(
    body: LeaderBody, *, distance_m: float = 1.1, height_m: float = 0.25, steps: int = 360
) -> Visibility:
    """Looks at the leader from ``steps`` directions.

    A tag counts as seen where it is turned towards the camera by MIN_FACING at least and no other tag's sheet hides its
    centre or a corner. The robots' own bodies are in no file and hide nothing here; nor does the picture's edge, nor
    the distance.
    """
    azimuth = np.arange(steps) * 360.0 / steps
    angle = np.radians(azimuth)
    eyes = np.column_stack([distance_m * np.cos(angle), distance_m * np.sin(angle), np.full(steps, height_m)])
    black = [sheet_of(tag, body.family, with_border=False) for tag in body.tags]
    paper = [sheet_of(tag, body.family) for tag in body.tags]
    seen = np.column_stack([_is_seen(eyes, k, black, paper) for k in range(len(black))])
    plane = _planes(black)
    planes = np.array([len(set(plane[row])) for row in seen])
    return Visibility(azimuth, seen, planes, distance_m, height_m)


def number_of_planes(body: LeaderBody) -> int:
    """In how many planes a body's tags are: two or more determine its heading from one picture."""
    return len(set(_planes([sheet_of(tag, body.family, with_border=False) for tag in body.tags])))


def _is_seen(eyes: np.ndarray, k: int, black: list[Sheet], paper: list[Sheet]) -> np.ndarray:
    to_eye = eyes - black[k].centre_m
    seen = to_eye @ black[k].looks >= MIN_FACING * np.linalg.norm(to_eye, axis=1)
    points = [black[k].centre_m, *black[k].corners_m()]
    for other, sheet in enumerate(paper):
        if other != k:
            for point in points:
                seen &= ~sheet.hides(eyes, point)
    return seen


def _planes(sheets: list[Sheet]) -> np.ndarray:
    """(T,) int: tags with the same number are in one plane, within 3 degrees and 5 mm."""
    number: list[int] = []
    first: list[Sheet] = []
    for sheet in sheets:
        for k, other in enumerate(first):
            is_parallel = other.looks @ sheet.looks > np.cos(_SAME_PLANE_RAD)
            if is_parallel and abs(other.looks @ (sheet.centre_m - other.centre_m)) < _SAME_PLANE_M:
                number.append(k)
                break
        else:
            number.append(len(first))
            first.append(sheet)
    return np.array(number)

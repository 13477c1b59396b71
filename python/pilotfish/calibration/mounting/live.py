"""A turn and a drive as a camera sees them now: which pictures to keep, and how far each part has come.

The operator says when a part begins and ends, so each picture's part is known. Of a robot that stands, or that is slow,
one picture is kept, not thirty a second: equal pictures would weigh the place where it waited.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from pilotfish.calibration.body.sightings import (
    Collected,
    TagSizes,
    check_known,
    check_size,
    checked,
    corner_finder,
    no_tag,
)
from pilotfish.calibration.mounting.calibrate import MIN_DRIVE_PICTURES, MIN_TURN_PICTURES
from pilotfish.calibration.mounting.phases import Phases
from pilotfish.core import CameraModel, Frame, Reason

AIM_TURN, TURN, AIM_DRIVE, DRIVE = "before the turn", "turn", "before the drive", "drive"
MIN_STEP_PX = 1.0  # a corner has moved by this since the last picture that was kept
LATELY = 15  # pictures: half a second
MISREAD = 3  # sightings of an id that has no size before it counts as there


@dataclass(frozen=True)
class LiveState:
    """After a picture. ``part``: one of AIM_TURN, TURN, AIM_DRIVE, DRIVE; ``tags``: id -> centre (2,) [px] in it;
    ``pictures``: kept of the (turn, drive); ``turned_rad``, ``driven_m``: about how far, from the picture alone;
    ``refused``: why the part was not ended although it was asked for, else empty."""

    part: str
    tags: dict[int, np.ndarray]
    pictures: tuple[int, int]
    turned_rad: float
    driven_m: float
    refused: str = ""


@dataclass
class _Part:
    """What was kept of a turn or a drive."""

    found: list[tuple[int, int, np.ndarray]] = field(default_factory=list)
    frames: int = 0
    last: dict[int, np.ndarray] = field(default_factory=dict)
    extent: dict[int, tuple[float, float]] = field(default_factory=dict)  # of bearing [rad], or of range [m]

    @property
    def most_of_one_tag(self) -> int:
        ids = [tag_id for _, tag_id, _ in self.found]
        return max((ids.count(tag_id) for tag_id in set(ids)), default=0)

    @property
    def way(self) -> float:
        return max((high - low for low, high in self.extent.values()), default=0.0)


def collect_live(
    frames: Iterable[Frame],
    camera: CameraModel,
    sizes: TagSizes,
    *,
    turn_only: bool = False,
    forward: bool = True,
    family: str = "tag36h11",
    ignored_ids: frozenset[int] = frozenset(),
    advance: Callable[[], bool],
    on_picture: Callable[[LiveState], None] | None = None,
) -> tuple[Collected, Phases]:
    """The sightings of a turn and a straight drive (``forward`` or backwards), and which is which.

    ``advance`` is asked after every picture whether the part has ended: before the turn, the turn, before the drive,
    the drive. A part does not end before enough was seen of it. BodyLearningError: frames of another size than the
    calibration's, a tag without a size.
    """
    corners_in = corner_finder(camera, family, ignored_ids)
    order = (AIM_TURN, TURN) if turn_only else (AIM_TURN, TURN, AIM_DRIVE, DRIVE)
    kept = {TURN: _Part(), DRIVE: _Part()}
    place, number, read, undecodable = 0, 0, 0, 0
    lately: deque[int] = deque(maxlen=LATELY)
    seen: dict[int, int] = {}
    for frame in frames:
        part = order[place]
        read += 1
        if frame.defect != Reason.none:
            undecodable += 1
            continue
        check_size(frame, read, camera)
        tags = corners_in(frame)
        lately.append(len(tags))
        for tag_id, _ in tags:
            seen[tag_id] = seen.get(tag_id, 0) + 1
        check_known((tag_id for tag_id, count in seen.items() if count >= MISREAD), sizes)
        if part in kept and _keep(kept[part], tags, number):
            number += 1
        if part in kept:
            _measure(kept[part], tags, camera, sizes, as_bearing=part == TURN)
        refused = ""
        if advance():
            refused = _why_not(part, kept, any(lately))
            place += not refused
        if on_picture:
            on_picture(_state(order[min(place, len(order) - 1)], tags, kept, refused))
        if place == len(order):
            break
    found = kept[TURN].found + kept[DRIVE].found
    if not found:
        raise no_tag(family, read)
    collected = checked(found, sizes, read, undecodable)
    of_turn = np.isin(collected.frame_numbers, [row[0] for row in kept[TURN].found])
    return collected, Phases(of_turn, ~of_turn, forward)


def _keep(part: _Part, tags: list[tuple[int, np.ndarray]], number: int) -> bool:
    """Keeps the tags as frame ``number`` if any has moved since the last that was kept."""
    moved = [
        tag_id not in part.last or np.linalg.norm(corners - part.last[tag_id], axis=1).max() >= MIN_STEP_PX
        for tag_id, corners in tags
    ]
    if not any(moved):
        return False
    part.found += [(number, tag_id, corners) for tag_id, corners in tags]
    part.last.update(tags)
    part.frames += 1
    return True


def _measure(
    part: _Part, tags: list[tuple[int, np.ndarray]], camera: CameraModel, sizes: TagSizes, *, as_bearing: bool
) -> None:
    """Extends what each tag has passed: its bearing in a turn, its range in a drive; without distortion and tilt, which
    is enough for a hint."""
    for tag_id, corners in tags:
        if as_bearing:
            value = math.atan2(corners[:, 0].mean() - camera.cx, camera.fx)
        else:
            size_m = sizes.of(tag_id)
            side_px = math.sqrt(max(_area(corners), 1.0))
            value = (size_m or 0.0) * math.sqrt(camera.fx * camera.fy) / side_px
        low, high = part.extent.get(tag_id, (value, value))
        part.extent[tag_id] = min(low, value), max(high, value)


def _area(corners: np.ndarray) -> float:
    """Of a quadrilateral (4, 2): the shoelace formula."""
    x, y = corners.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


def _why_not(part: str, kept: dict[str, _Part], seen_lately: bool) -> str:
    """Why ``part`` must not end yet; empty if it may."""
    if part in (AIM_TURN, AIM_DRIVE):
        return "" if seen_lately else "no tag is in the picture: turn the robot until one is"
    needed = MIN_TURN_PICTURES if part == TURN else MIN_DRIVE_PICTURES
    count = kept[part].most_of_one_tag
    if count >= needed:
        return ""
    return f"only {count} different pictures of a tag yet, {needed} are needed at least: let the robot {part}, slowly"


def _state(part: str, tags: list[tuple[int, np.ndarray]], kept: dict[str, _Part], refused: str) -> LiveState:
    turn, drive = kept[TURN], kept[DRIVE]
    centres = {tag_id: corners.mean(axis=0) for tag_id, corners in tags}
    return LiveState(part, centres, (turn.frames, drive.frames), turn.way, drive.way, refused)

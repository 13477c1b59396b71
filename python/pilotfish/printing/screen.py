"""A leader whose tags sit side by side on one sheet that is folded between them, like a folding screen."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pilotfish.calibration.body.leader_file import body_tag
from pilotfish.core import BodyTag, LeaderBody
from pilotfish.errors import UsageError
from pilotfish.printing.tag_art import tag_art

MOST_FACES = 12  # what a leader may wear


def folded_screen(
    ids: Sequence[int],
    size_m: float,
    angle_rad: float,
    *,
    position_m: Sequence[float] = (-0.20, 0.0, 0.25),
    facing_rad: float = math.pi,
    tilt_rad: float = 0.0,
    family: str = "tag36h11",
    border_cells: float = 1.0,
    name: str = "leader",
) -> LeaderBody:
    """The tags of such a sheet in the leader's base frame. UsageError names what is out of range.

    ids: from left to right as one reads the sheet; angle_rad: by which every face turns away from its neighbour, to the
    back (0: a flat sheet); position_m: of the middle of the sheet: the centre of the middle tag, or of the middle fold;
    facing_rad, tilt_rad: the direction the middle of the sheet looks, as a tag's.

    The sheet in its own frame, before it is folded, has the axes of a tag: x right and y down as one reads it, z into
    the wall. Every face is as wide as a tag with its white border, w, and the folds are the lines between them. Seen
    from above, face k is turned about its folds by a_k = (k - (n - 1) / 2) angle from the middle, and its direction to
    the right is r(a) = (cos a, sin a) in (x, z): positive a goes to the right and back into the wall. The centres are
    half a face from the folds, so from one centre to the next it is w/2 r(a_k) + w/2 r(a_k+1). For an odd number of
    faces the middle one's centre is the origin; for an even number the middle fold is, w/2 r(a) away from the centre
    next to it.
    """
    count = len(ids)
    if not 1 <= count <= MOST_FACES:
        raise UsageError(f"--faces: {count}; a leader has 1 to {MOST_FACES} tags")
    if angle_rad < 0.0 or count * angle_rad > 2 * math.pi + 1e-9:
        most = 360.0 / count
        raise UsageError(
            f"--angle-deg: {math.degrees(angle_rad):g}; {count} faces can be folded by 0 to {most:g} degrees each:"
            f" all round is 360"
        )
    width_m = tag_art(family, ids[0], size_m, border_cells).side_m
    turns = [(k - (count - 1) / 2) * angle_rad for k in range(count)]
    right = [np.array([math.cos(turn), 0.0, math.sin(turn)]) for turn in turns]
    middle = count // 2
    start = np.zeros(3) if count % 2 else width_m / 2 * right[middle]
    centres = {middle: start}
    for k in range(middle + 1, count):
        centres[k] = centres[k - 1] + width_m / 2 * (right[k - 1] + right[k])
    for k in range(middle - 1, -1, -1):
        centres[k] = centres[k + 1] - width_m / 2 * (right[k + 1] + right[k])
    oMs = BodyTag(id=0, position_m=list(position_m), facing_rad=facing_rad, tilt_rad=tilt_rad).oMt
    tags = []
    for k, tag_id in enumerate(ids):
        sMt = np.eye(4)
        sMt[:3, 0], sMt[:3, 2], sMt[:3, 3] = right[k], [-math.sin(turns[k]), 0.0, math.cos(turns[k])], centres[k]
        tags.append(body_tag(tag_id, size_m, oMs @ sMt))
    return LeaderBody(tags, family=family, name=name)

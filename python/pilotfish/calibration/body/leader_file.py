"""A learned body as a leader's YAML file, in the words and units of data/leaders."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from pilotfish.coordinator import load_leader_body
from pilotfish.core import BodyTag, LeaderBody
from pilotfish.whole_files import write_whole

# Nothing is known better than this.
METRES_DIGITS, DEGREES_DIGITS = 5, 3
# The axes of a tag that faces forward, upright: x to the robot's left, y down, z to the rear.
FORWARD = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def body_tag(tag_id: int, size_m: float, oMt: np.ndarray) -> BodyTag:
    """The tag whose ``oMt`` is this (4, 4): the inverse of ``BodyTag.oMt``.

    oMt = Rz(facing) Ry(-tilt) Rx(-roll) FORWARD: facing turns it left about z; looking up is a negative turn about y;
    clockwise, as one reads it, is a negative turn about the direction it looks. A tag that looks straight up or down
    has only the difference of facing and roll; facing takes it all.
    """
    turned = oMt[:3, :3] @ FORWARD.T
    tilt = math.asin(float(np.clip(turned[2, 0], -1.0, 1.0)))
    if abs(turned[2, 0]) < 1.0 - 1e-9:
        facing = math.atan2(turned[1, 0], turned[0, 0])
        roll = -math.atan2(turned[2, 1], turned[2, 2])
    else:
        facing, roll = math.atan2(-turned[0, 1], turned[1, 1]), 0.0
    position = [float(value) for value in oMt[:3, 3]]
    return BodyTag(id=tag_id, size_m=size_m, position_m=position, facing_rad=facing, tilt_rad=tilt, roll_rad=roll)


def write_leader_body(file: Path, body: LeaderBody, remarks: Sequence[str] = ()) -> LeaderBody:
    """Writes ``body`` with ``remarks`` as comments above it; what the product's own reader makes of the file.

    OSError if it cannot be written.
    """
    write_whole(file, leader_text(body, remarks))
    return load_leader_body(file) if file.is_file() else body  # /dev/stdout cannot be read back


def leader_text(body: LeaderBody, remarks: Sequence[str] = ()) -> str:
    """The file's text."""
    text = "".join(f"# {line}\n" for line in remarks)
    text += yaml.safe_dump({"name": body.name, "family": body.family}, sort_keys=False)
    text += "tags:\n"
    for tag in body.tags:
        first, *others = yaml.safe_dump(_plain(tag), sort_keys=False, default_flow_style=None).splitlines()
        text += "".join([f"  - {first}\n", *(f"    {line}\n" for line in others)])
    return text


def _plain(tag: BodyTag) -> dict[str, object]:
    angles = {"facing_deg": tag.facing_rad, "tilt_deg": tag.tilt_rad, "roll_deg": tag.roll_rad}
    return {
        "id": tag.id,
        "size_m": round(tag.size_m, METRES_DIGITS + 1),
        "position_m": [round(value, METRES_DIGITS) + 0.0 for value in tag.position_m],
        **{key: round(math.degrees(value), DEGREES_DIGITS) + 0.0 for key, value in angles.items()},
    }

"""Whether tags are in a camera's picture, before it is rendered."""

from __future__ import annotations

import math

import numpy as np

from pilotfish.calibration.rehearsal.lens import project
from pilotfish.core import BodyTag, CameraModel

STEEPEST_DEG = 65.0  # between the tag's normal and the line of sight
_BORDER_PX = 3.0


def faces_camera(cMo: np.ndarray, tag: BodyTag, steepest_deg: float = STEEPEST_DEG) -> bool:
    """Whether the tag, on what is at ``cMo`` (4, 4), is before the camera and seen less steeply than that."""
    cMt = cMo @ tag.oMt
    distance = float(np.linalg.norm(cMt[:3, 3]))
    # z of a tag's frame points into the wall: along the line of sight when it is seen frontally.
    return cMt[2, 3] > 0 and cMt[:3, 2] @ cMt[:3, 3] > distance * math.cos(math.radians(steepest_deg))


def inside_picture(camera: CameraModel, cMo: np.ndarray, tag: BodyTag) -> bool:
    """Whether all corners of the tag are, some pixels away from its border."""
    points_c = tag.corners_m @ cMo[:3, :3].T + cMo[:3, 3]
    if (points_c[:, 2] <= 0).any():
        return False
    pixels = project(camera, points_c)
    return bool(((pixels > _BORDER_PX) & (pixels < [camera.width - _BORDER_PX, camera.height - _BORDER_PX])).all())


def shortest_side_px(camera: CameraModel, cMo: np.ndarray, tag: BodyTag) -> float:
    """Of the tag's outline in the picture."""
    pixels = project(camera, tag.corners_m @ cMo[:3, :3].T + cMo[:3, 3])
    return float(np.linalg.norm(pixels - np.roll(pixels, 1, axis=0), axis=1).min())

"""How many pictures a video has, for the time that is left."""

from __future__ import annotations

from pathlib import Path

from pilotfish.errors import MissingPackageError
from pilotfish.extras import require


def pictures_in_video(file: Path) -> int | None:
    """What the video says of itself, which may be off by a few; None if it says nothing or OpenCV is not installed."""
    try:
        cv2 = require("cv2", "calibrate")
    except MissingPackageError:
        return None
    video = cv2.VideoCapture(str(file))
    try:
        count = video.get(cv2.CAP_PROP_FRAME_COUNT) if video.isOpened() else 0
    finally:
        video.release()
    return int(count) if 0 < count < 1e9 else None

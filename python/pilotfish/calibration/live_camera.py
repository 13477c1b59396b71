"""A camera that runs, as a stream of frames: what every calibration from ``camera:N`` looks through."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pilotfish.capture import CaptureError, open_camera
from pilotfish.core import Frame
from pilotfish.errors import CameraError


def camera_number(source: str) -> int | None:
    """N of ``camera:N``; None if the source is spelled otherwise."""
    match = re.fullmatch(r"camera:(\d+)", source)
    return int(match[1]) if match else None


def camera_frames(number: int, size: tuple[int, int], rate_hz: float) -> Iterator[Frame]:
    """Frames of /dev/videoN at ``size`` (width, height) px without end, also those that cannot be decoded
    (``Frame.defect``). CameraError if it cannot be opened, and when it ends."""
    try:
        source = open_camera(number, width=size[0], height=size[1], frame_rate_hz=rate_hz)
    except CaptureError as error:
        raise CameraError(str(error)) from error
    while not source.ended:
        frame = source.next()
        if frame is not None:
            yield frame
    raise CameraError(source.why_ended or f"camera:{number} has ended")

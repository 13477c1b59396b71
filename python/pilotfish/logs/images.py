"""The images of a recording, one after the other: they are read and decoded when they are asked for, and never kept."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pilotfish.black_box.log import Event
from pilotfish.black_box.messages import COPY_MARK
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.logs.messages import decode, kind_of
from pilotfish.logs.sources import OnProgress, events_of, recordings_in, size_of

JPEG = image_t.PIXEL_FORMAT_MJPEG
_CHANNELS = {
    image_t.PIXEL_FORMAT_GRAY: 1,
    image_t.PIXEL_FORMAT_RGB: 3,
    image_t.PIXEL_FORMAT_BGR: 3,
}
_MAX_SIDE_PX = 32768


@dataclass(frozen=True)
class RecordedImage:
    """One image as it was recorded. ``data``: a JPEG, or rows of ``row_stride`` bytes in one of image_t's formats."""

    robot: str  # of the channel
    log_utime: int
    utime: int
    width: int
    height: int
    row_stride: int
    pixelformat: int  # image_t.PIXEL_FORMAT_...
    data: bytes
    is_copy: bool  # a JPEG that a black box has made of raw pixels

    def pixels(self) -> NDArray[np.uint8] | None:
        """(height, width, 3), RGB; None if the bytes are no such image."""
        if not (0 < self.width <= _MAX_SIDE_PX and 0 < self.height <= _MAX_SIDE_PX):
            return None
        if self.pixelformat == JPEG:
            return self._decoded()
        channels = _CHANNELS.get(self.pixelformat)
        if channels is None or self.row_stride < self.width * channels:
            return None
        if len(self.data) < self.row_stride * (self.height - 1) + self.width * channels:
            return None
        padded = self.data.ljust(self.row_stride * self.height, b"\0")  # the last row may end with its pixels
        rows = np.frombuffer(padded, np.uint8, self.row_stride * self.height).reshape(self.height, self.row_stride)
        pixels = rows[:, : self.width * channels].reshape(self.height, self.width, channels)
        if self.pixelformat == image_t.PIXEL_FORMAT_BGR:
            pixels = pixels[:, :, ::-1]
        return np.ascontiguousarray(np.broadcast_to(pixels, (self.height, self.width, 3)))

    def _decoded(self) -> NDArray[np.uint8] | None:
        try:
            with Image.open(io.BytesIO(self.data), formats=["JPEG"]) as picture:
                if picture.size != (self.width, self.height):
                    return None
                return np.asarray(picture.convert("RGB"))
        except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):  # whatever the bytes lead to
            return None


def images_in(
    path: str | Path, robot: str | None = None, on_progress: OnProgress | None = None
) -> Iterator[RecordedImage]:
    """Every image of a recording, of a robot's camera if one is named. MissingFileError."""
    recordings = recordings_in(Path(path), robot)
    total = sum(map(size_of, recordings))
    before = 0
    for files in recordings:
        for event in events_of(files, before, total, on_progress):
            if isinstance(event, Event) and kind_of(event) == "IMAGE":
                image = image_of(event)
                if image is not None and robot in (None, image.robot):
                    yield image
        before += size_of(files)


def image_of(event: Event) -> RecordedImage | None:
    """The image in an event; None if its bytes are damaged."""
    message = decode(event, "IMAGE")
    if message is None:
        return None
    content = message.content
    return RecordedImage(
        robot=message.robot,
        log_utime=event.utime,
        utime=content.utime,
        width=content.width,
        height=content.height,
        row_stride=content.row_stride,
        pixelformat=content.pixelformat,
        data=bytes(content.data),
        is_copy=any(extra.key == COPY_MARK for extra in content.metadata),
    )

"""A picture on its way to a browser: a JPEG as it came, or one made of raw pixels."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.view.messages import MalformedError

MAX_SIDE_PX = 8192
MAX_WIDTH_SENT_PX = 1280
_QUALITY = 80
_SHRINK = "pilotfish_shrink"  # extra of a preview: so many times smaller than the camera's picture on each side
_MAX_SHRINK = 1000


@dataclass(frozen=True)
class Picture:
    """What a page shows."""

    utime_us: int  # exposure
    jpeg: bytes
    width: int  # of the JPEG [px]
    height: int
    source_width: int  # of the camera's picture, which the tags' corners refer to [px]
    source_height: int


def picture_of(data: bytes) -> Picture:
    """An encoded ``bot_core.image_t`` in any of Pilotfish's pixel formats. Raises MalformedError."""
    try:
        message = image_t.decode(data)
    except Exception as error:  # lcm-gen's decoders raise whatever the bytes lead to
        raise MalformedError(f"no image_t: {type(error).__name__}") from error
    pixels = bytes(message.data)
    if not (0 < message.width <= MAX_SIDE_PX and 0 < message.height <= MAX_SIDE_PX):
        raise MalformedError(f"a picture of {message.width} x {message.height} px")
    if message.pixelformat == image_t.PIXEL_FORMAT_MJPEG:
        if not pixels.startswith(b"\xff\xd8"):
            raise MalformedError("a JPEG that is none")
        shrink = _shrink(message)
        return Picture(
            message.utime, pixels, message.width, message.height, message.width * shrink, message.height * shrink
        )
    return encode(_raw(message, pixels), message.utime)


def encode(image: NDArray[np.uint8], utime_us: int) -> Picture:
    """Of an image (H, W) or (H, W, 3) RGB, uint8; wider ones than MAX_WIDTH_SENT_PX are made smaller."""
    height, width = image.shape[:2]
    picture = Image.fromarray(image)
    if width > MAX_WIDTH_SENT_PX:
        picture = picture.reduce(-(-width // MAX_WIDTH_SENT_PX))
    file = io.BytesIO()
    picture.save(file, "JPEG", quality=_QUALITY)
    return Picture(utime_us, file.getvalue(), picture.width, picture.height, width, height)


def _raw(message: image_t, pixels: bytes) -> NDArray[np.uint8]:
    channels = {image_t.PIXEL_FORMAT_GRAY: 1, image_t.PIXEL_FORMAT_RGB: 3, image_t.PIXEL_FORMAT_BGR: 3}.get(
        message.pixelformat
    )
    if channels is None:
        raise MalformedError(f"pixel format {message.pixelformat}")
    row = message.width * channels
    if message.row_stride < row or len(pixels) < message.row_stride * (message.height - 1) + row:
        raise MalformedError("fewer bytes than its size promises")
    padded = pixels + bytes(message.row_stride - row)
    rows = np.frombuffer(padded, np.uint8, message.row_stride * message.height).reshape(message.height, -1)[:, :row]
    if channels == 1:
        return np.ascontiguousarray(rows)
    image = rows.reshape(message.height, message.width, 3)
    return np.ascontiguousarray(image[:, :, ::-1] if message.pixelformat == image_t.PIXEL_FORMAT_BGR else image)


def _shrink(message: image_t) -> int:
    """1 unless a preview says otherwise."""
    for entry in message.metadata:
        factor = bytes(entry.value).decode("ascii", "replace").strip("\0")
        if entry.key == _SHRINK and factor.isdecimal() and len(factor) < 5 and 1 <= int(factor) <= _MAX_SHRINK:
            return int(factor)
    return 1

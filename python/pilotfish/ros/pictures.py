"""Pictures: sensor_msgs/Image and sensor_msgs/CompressedImage to ``bot_core.image_t``, with the same bytes."""

from __future__ import annotations

import struct
from typing import Any

from pilotfish.lcmtypes.bot_core.image_t import image_t

# ROS's name: FourCC and bytes per pixel
_ENCODINGS = {
    "mono8": (image_t.PIXEL_FORMAT_GRAY, 1),
    "8UC1": (image_t.PIXEL_FORMAT_GRAY, 1),
    "rgb8": (image_t.PIXEL_FORMAT_RGB, 3),
    "bgr8": (image_t.PIXEL_FORMAT_BGR, 3),
}
_MAX_SIDE_PX = 32767
_LOSSLESS_BYTES = 100_000  # with a stock kernel's receive buffer; more fragments than fit into it are lost
_ROOMY_BYTES = 4_194_304
_START, _END, _START_OF_SCAN = b"\xff\xd8", 0xD9, 0xDA
# SOF0 to SOF15 without DHT (C4), JPG (C8) and DAC (CC)
_FRAME_HEADERS = set(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}


def buffer_warning(picture: image_t, granted_bytes: int) -> str:
    """What to tell people about pictures of this size, where a receive buffer of ``granted_bytes`` is the most that
    the kernel grants (net.core.rmem_max); empty if they fit."""
    if picture.size <= _LOSSLESS_BYTES or granted_bytes >= _ROOMY_BYTES:
        return ""
    return (
        f"pictures of {picture.size} bytes get lost in a receive buffer of {granted_bytes}: "
        f"sudo sysctl -w net.core.rmem_max={_ROOMY_BYTES}, or bridge the compressed topic"
    )


class PictureError(ValueError):
    """A picture that Pilotfish cannot read; the message says what it can."""


def picture_from_image(image: Any, utime: int) -> image_t:
    """An ``image_t`` with the same pixels, stamped ``utime`` [us]. PictureError if it is of an encoding that
    Pilotfish does not read, or its sizes contradict each other."""
    if image.encoding not in _ENCODINGS:
        raise PictureError(f"encoding {image.encoding!r}: Pilotfish reads {', '.join(_ENCODINGS)}")
    pixel_format, pixel_bytes = _ENCODINGS[image.encoding]
    _check_size(image.width, image.height)
    if image.step < image.width * pixel_bytes:
        raise PictureError(f"step {image.step}: a row of {image.width} px needs {image.width * pixel_bytes} bytes")
    data = bytes(image.data)
    if len(data) != image.step * image.height:
        raise PictureError(f"{len(data)} bytes: {image.height} rows of {image.step} are {image.step * image.height}")
    return _image(utime, image.width, image.height, image.step, pixel_format, data)


def picture_from_compressed(image: Any, utime: int) -> image_t:
    """An ``image_t`` with the same JPEG. PictureError if it is another format, or its header cannot be read."""
    data = bytes(image.data)
    if not data.startswith(_START):
        raise PictureError(f"format {image.format!r}: Pilotfish reads JPEG, and this does not begin as one")
    width, height = jpeg_size(data)
    _check_size(width, height)
    return _image(utime, width, height, 0, image_t.PIXEL_FORMAT_MJPEG, data)


def jpeg_size(data: bytes) -> tuple[int, int]:
    """Width and height [px], from the frame header (ITU-T T.81, B.2.2). PictureError if there is none."""
    at = len(_START)
    while at + 4 <= len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], struct.unpack_from(">H", data, at + 2)[0]
        if marker == 0xFF:  # fill byte
            at += 1
            continue
        if marker in _FRAME_HEADERS and at + 9 <= len(data):
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        if marker in (_START_OF_SCAN, _END):
            break
        at += 2 + length
    raise PictureError(f"a JPEG of {len(data)} bytes without a frame header")


def _check_size(width: int, height: int) -> None:
    if not (1 <= width <= _MAX_SIDE_PX and 1 <= height <= _MAX_SIDE_PX):
        raise PictureError(f"{width}x{height} px: each must be 1 to {_MAX_SIDE_PX}")


def _image(utime: int, width: int, height: int, row_stride: int, pixel_format: int, data: bytes) -> image_t:
    message = image_t()
    message.utime = utime
    message.width, message.height, message.row_stride = width, height, row_stride
    message.pixelformat, message.size, message.data = pixel_format, len(data), data
    return message

"""Pictures on the wire, by another library than Pilotfish's own: ``bot_core.image_t`` to NumPy and back."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from pilotfish.lcmtypes.bot_core import image_t

GrayImage = NDArray[np.uint8]

JPEG_QUALITY = 95


class WireError(ValueError):
    """Bytes that are not a picture we can read; the message says why."""


@dataclass(frozen=True)
class WireImage:
    """A picture (H, W) uint8 and the instant of its exposure [us]."""

    image: GrayImage
    utime: int


def decode_image(data: bytes) -> WireImage:
    """The picture in an encoded ``image_t``, converted to gray. Raises WireError."""
    try:
        message = image_t.decode(data)
    except Exception as error:  # lcm-gen's decoders raise whatever the bytes lead to
        raise WireError(f"not a bot_core.image_t: {error}") from error
    if message.pixelformat == image_t.PIXEL_FORMAT_MJPEG:
        image = _from_jpeg(message)
    elif message.pixelformat == image_t.PIXEL_FORMAT_GRAY:
        image = _from_raw(message, channels=1)[:, :, 0]
    elif message.pixelformat in (image_t.PIXEL_FORMAT_RGB, image_t.PIXEL_FORMAT_BGR):
        colours = _from_raw(message, channels=3)
        if message.pixelformat == image_t.PIXEL_FORMAT_BGR:
            colours = colours[:, :, ::-1]
        image = np.asarray(Image.fromarray(np.ascontiguousarray(colours)).convert("L"))
    else:
        raise WireError(f"unknown pixel format {message.pixelformat}")
    return WireImage(np.ascontiguousarray(image), message.utime)


def encode_image(image: GrayImage, *, utime: int, jpeg: bool = False) -> bytes:
    """An encoded ``image_t`` of a gray picture (H, W) uint8: raw, or as JPEG of quality 95."""
    if image.ndim != 2 or image.dtype != np.uint8:
        raise ValueError(f"expected a gray image of shape (H, W) and dtype uint8, got {image.shape} {image.dtype}")
    message = image_t()
    message.utime = utime
    message.height, message.width = image.shape
    message.row_stride = message.width
    if jpeg:
        buffer = io.BytesIO()
        Image.fromarray(image).save(buffer, format="JPEG", quality=JPEG_QUALITY)
        message.data = buffer.getvalue()
        message.pixelformat = image_t.PIXEL_FORMAT_MJPEG
    else:
        message.data = image.tobytes()
        message.pixelformat = image_t.PIXEL_FORMAT_GRAY
    message.size = len(message.data)
    return message.encode()


def _from_raw(message: image_t, channels: int) -> GrayImage:
    height, width, stride = message.height, message.width, message.row_stride
    row_bytes = width * channels
    if width < 1 or height < 1 or stride < row_bytes or len(message.data) < stride * (height - 1) + row_bytes:
        raise WireError(f"{len(message.data)} bytes are not {width}x{height} pixels with rows {stride} bytes apart")
    padded = bytes(message.data).ljust(stride * height, b"\0")  # the last row may come without its padding
    rows = np.frombuffer(padded, np.uint8, stride * height).reshape(height, stride)
    return rows[:, :row_bytes].reshape(height, width, channels)


def _from_jpeg(message: image_t) -> GrayImage:
    try:
        with Image.open(io.BytesIO(message.data), formats=["JPEG"]) as picture:
            if picture.size != (message.width, message.height):  # before anything is decoded
                raise WireError(f"the JPEG is {picture.size}, the message says {(message.width, message.height)}")
            return np.asarray(picture.convert("L"))
    except OSError as error:
        raise WireError(f"damaged JPEG: {error}") from error

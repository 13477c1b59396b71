"""A picture from the bus in gray, and the tags in it: what is in view, where a coordinator says what is not."""

from __future__ import annotations

import io

import numpy as np

from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.watching.feed import ImageHead

_MAX_PIXELS = 64_000_000
_CHANNELS = {image_t.PIXEL_FORMAT_GRAY: 1, image_t.PIXEL_FORMAT_RGB: 3, image_t.PIXEL_FORMAT_BGR: 3}


def gray(head: ImageHead) -> np.ndarray | None:
    """(H, W) uint8; None for a picture that is damaged, of an unknown format or absurdly large."""
    if head.width < 8 or head.height < 8 or head.width * head.height > _MAX_PIXELS:
        return None
    try:
        message = image_t.decode(head.data)
        if message.pixelformat == image_t.PIXEL_FORMAT_MJPEG:
            return _from_jpeg(message.data, message.width, message.height)
        channels = _CHANNELS[message.pixelformat]
        rows = np.frombuffer(message.data, np.uint8)[: message.height * message.row_stride]
        rows = rows.reshape(message.height, message.row_stride)[:, : message.width * channels]
        if channels == 1:
            return np.ascontiguousarray(rows)
        # Tags are black on white: the plain mean tells them apart as well as the eye's weights.
        return rows.reshape(message.height, message.width, 3).mean(axis=2).astype(np.uint8)
    except Exception:  # lcm-gen's decoder and Pillow raise whatever the bytes lead to
        return None


def _from_jpeg(data: bytes, width: int, height: int) -> np.ndarray | None:
    from PIL import Image

    with Image.open(io.BytesIO(data)) as picture:
        if picture.format != "JPEG" or picture.size != (width, height):
            return None
        return np.asarray(picture.convert("L"))


def ids_in_view(images: list[np.ndarray], family: str) -> dict[int, int]:
    """In how many of the ``images`` each id of the family was found, as the detector finds them without knowledge."""
    from pilotfish.vision import TagDetector

    detector = TagDetector(family)
    found: dict[int, int] = {}
    for image in images:
        if 8 <= image.shape[0] < 32768 and 8 <= image.shape[1] < 32768:
            for tag in {tag.id for tag in detector.detect(image).tags}:
                found[tag] = found.get(tag, 0) + 1
    return dict(sorted(found.items()))

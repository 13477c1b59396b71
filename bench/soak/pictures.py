"""The pictures that are shown, rendered once and encoded as messages, of which only the stamp is written anew.

A leader sways before the camera of the line scenario, 1.4 to 2.0 m away: always farther than the 1.10 m that are to be
kept, so that a coordinator that sees it drives. The loop closes smoothly. One picture in ten comes as a JPEG.
"""

from __future__ import annotations

import io
import math
import struct
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageFilter

from pilotfish import data, sim
from pilotfish.lcmtypes.bot_core.image_t import image_t

LOOP_S = 10.0
WIDTH, HEIGHT = 640, 480
_STAMP_AT = 8  # bytes: behind the type's fingerprint
_STATIC = 12  # pictures of every bad series: their noise differs from one to the next


class Message:
    """An encoded image_t."""

    def __init__(self, image: np.ndarray, *, jpeg: bool = False, keep_share: float = 1.0) -> None:
        pixels = _jpeg(image) if jpeg else image.tobytes()
        self._set(pixels[: int(len(pixels) * keep_share)], image.shape[1], image.shape[0], jpeg)

    @classmethod
    def of_bytes(cls, pixels: bytes) -> Message:
        """What says it is a JPEG of the right size."""
        message = cls.__new__(cls)
        message._set(pixels, WIDTH, HEIGHT, True)
        return message

    def _set(self, pixels: bytes, width: int, height: int, jpeg: bool) -> None:
        message = image_t()
        message.width, message.height, message.row_stride = width, height, width
        message.pixelformat = image_t.PIXEL_FORMAT_MJPEG if jpeg else image_t.PIXEL_FORMAT_GRAY
        message.data, message.size = pixels, len(pixels)
        self._encoded = bytearray(message.encode())

    def stamped(self, utime: int) -> bytes:
        struct.pack_into(">q", self._encoded, _STAMP_AT, utime)
        return bytes(self._encoded)


@dataclass(frozen=True)
class Pictures:
    good: list[Message]  # one loop
    bad: dict[str, list[Message]]  # series: no leader can be measured in any of them


def render(rate_hz: float) -> Pictures:
    scenario = sim.load_scenario(str(data.path("scenarios/line.yaml")))
    leader = next(robot for robot in scenario.robots if not robot.follows)
    camera = next(robot for robot in scenario.robots if robot.follows).camera
    renderer = sim.Renderer(camera.model, camera.imperfections, camera.mounting, clutter_seed=1)
    cMb = np.linalg.inv(camera.mounting.bMc)
    count = round(LOOP_S * rate_hz)
    images = [
        renderer.render([(leader.body, cMb @ _leader_pose(2 * math.pi * k / count))], seed=k + 1) for k in range(count)
    ]
    return Pictures([Message(image, jpeg=k % 10 == 9) for k, image in enumerate(images)], _bad(images[0]))


def _leader_pose(phase: float) -> np.ndarray:
    """bMo (4, 4) of a leader whose distance, bearing and heading sway."""
    distance_m = 1.7 + 0.3 * math.sin(phase)
    bearing_rad = math.radians(-8.0 + 6.0 * math.cos(phase))
    heading_rad = math.radians(15.0 * math.sin(phase + 1.0))
    bMo = np.eye(4)
    bMo[:2, :2] = [
        [math.cos(heading_rad), -math.sin(heading_rad)],
        [math.sin(heading_rad), math.cos(heading_rad)],
    ]
    bMo[:2, 3] = distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad)
    return bMo


def _bad(image: np.ndarray) -> dict[str, list[Message]]:
    noisy = [np.random.default_rng(k).integers(-3, 4, image.shape) for k in range(_STATIC)]

    def with_noise(picture: np.ndarray | int) -> list[Message]:
        return [Message(np.clip(picture + noise, 0, 255).astype(np.uint8)) for noise in noisy]

    blurred = np.asarray(Image.fromarray(image).filter(ImageFilter.GaussianBlur(12.0))).astype(int)
    return {
        "gray": with_noise(128),
        "black": with_noise(4),
        "saturated": [Message(np.full_like(image, 255))],
        "blurred": with_noise(blurred),
        "wrong size": [Message(image[:240, :320].copy()), Message(np.zeros((720, 1280), np.uint8))],
        "cut-off JPEG": [Message(image, jpeg=True, keep_share=share) for share in (0.9, 0.66, 0.3, 0.02)],
    }


def _jpeg(image: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(image).save(file, "JPEG", quality=95)
    return file.getvalue()

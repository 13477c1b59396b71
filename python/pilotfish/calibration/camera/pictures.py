"""The pictures to calibrate from: a folder, a video file, or a camera that runs."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pilotfish.calibration.live_camera import camera_frames, camera_number
from pilotfish.calibration.video_length import pictures_in_video
from pilotfish.capture import PICTURE_SUFFIXES, CaptureError, open_video
from pilotfish.core import Reason
from pilotfish.errors import CalibrationError, MissingFileError
from pilotfish.extras import require

DEFAULT_SIZE = (640, 480)
FOLDER, VIDEO, CAMERA = "folder", "video", "camera"


@dataclass(frozen=True)
class Picture:
    """``image``: (H, W) uint8 gray; None if it cannot be decoded."""

    name: str
    image: np.ndarray | None


@dataclass(frozen=True)
class Pictures:
    """``kind``: folder, video or camera; iterate for the pictures. ``total``: how many, if that is known."""

    kind: str
    total: int | None
    _source: Iterator[Picture]

    def __iter__(self) -> Iterator[Picture]:
        """The pictures; of a camera without end. CalibrationError at one of another size than the first, by its
        name."""
        first: tuple[str, tuple[int, int]] | None = None
        for picture in self._source:
            if picture.image is not None:
                size = (picture.image.shape[1], picture.image.shape[0])
                first = first or (picture.name, size)
                if size != first[1]:
                    raise CalibrationError(
                        f"{picture.name} has {size[0]}x{size[1]} px, {first[0]} has {first[1][0]}x{first[1][1]}: a "
                        "calibration holds for one size; take all pictures at it"
                    )
            yield picture


def open_pictures(source: str, size: tuple[int, int] = DEFAULT_SIZE, rate_hz: float = 30.0) -> Pictures:
    """``source``: a folder, a video file, or ``camera:N`` (then at ``size`` and ``rate_hz``); ``images:DIR`` and
    ``video:FILE`` as the coordinator spells them. MissingFileError, CalibrationError."""
    if (number := camera_number(source)) is not None:
        return Pictures(CAMERA, None, _camera(number, size, rate_hz))
    path = Path(re.sub(r"^(images|video):", "", source))
    if path.is_dir():
        files = sorted((f for f in path.iterdir() if f.suffix.lower() in PICTURE_SUFFIXES), key=_natural)
        if not files:
            known = ", ".join(sorted(PICTURE_SUFFIXES))
            raise CalibrationError(f"{path}: no picture in this folder ({known})")
        return Pictures(FOLDER, len(files), _folder(files))
    if not path.exists():
        raise MissingFileError(f"{source}: no such file or folder; a camera is spelled camera:0")
    if path.suffix.lower() in PICTURE_SUFFIXES:
        raise CalibrationError(f"{path}: one picture is not enough; name the folder with all of them")
    return Pictures(VIDEO, pictures_in_video(path), _video(path))


def _natural(file: Path) -> list[tuple[int, int, str]]:
    """Sorts 2.png before 10.png."""
    parts = re.findall(r"\d+|\D+", file.name)
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts]


def _folder(files: list[Path]) -> Iterator[Picture]:
    cv2 = require("cv2", "calibrate")
    # A phone's picture may say that it is to be turned for display: the lens is that of the picture as it was taken.
    flags = cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
    for file in files:
        data = np.frombuffer(file.read_bytes(), np.uint8)
        image = cv2.imdecode(data, flags) if len(data) else None
        yield Picture(file.name, image)


def _video(path: Path) -> Iterator[Picture]:
    try:
        source = open_video(str(path))
    except CaptureError as error:
        raise CalibrationError(str(error)) from error
    for number, frame in enumerate(source):
        yield Picture(f"frame {number}", frame.image if frame.defect == Reason.none else None)


def _camera(number: int, size: tuple[int, int], rate_hz: float) -> Iterator[Picture]:
    for count, frame in enumerate(camera_frames(number, size, rate_hz), 1):
        yield Picture(f"picture {count}", frame.image if frame.defect == Reason.none else None)

"""A Video4Linux camera at the edge of the system calls: tests/probes/fake_camera.cpp, loaded into the program under
test, plays what a FakeCamera says. Everything but the pictures can be changed while the program runs:

    camera = FakeCamera(tmp_path, pictures={"leader": noisy(image), "black": noisy(np.full_like(image, 16))})
    with CameraRobot(camera, tmp_path) as robot: ...
        camera.show("black"); camera.late_us = 150_000; camera.pulled_out = 1
"""

from __future__ import annotations

import io
import mmap
import os
import struct
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageFilter

from build_tree import built

NUMBER = 90  # /dev/video90: hardly anyone has one

# tests/probes/fake_camera.hpp, field by field
SETUP = ["number", "rate_hz", "buffer_bytes"]
FAULTS = ["pulled_out", "blocked", "late_us", "stamp_shift_us", "stamp_kind", "error_flag", "bytes_short"]
FAULTS += ["open_errno", "stream_errno", "granted_width", "slept_us"]
SHOWN = ["first_picture", "picture_count"]
COUNTERS = ["opens", "closes", "streaming", "filled", "dropped", "taken"]
FIELDS = [*SETUP, *FAULTS, *SHOWN, *COUNTERS, "format_count"]
FORMATS, PICTURES = 8, 256
HEADER_BYTES = 8 * (len(FIELDS) + 4 * FORMATS + 2 * PICTURES)
LUMA_STEPS = {"YUYV": (0, 2), "UYVY": (1, 2)}


def fourcc(name: str) -> int:
    return struct.unpack("<I", name.encode())[0]


def encode(image: np.ndarray, name: str) -> bytes:
    """A gray picture as a camera of this format would lay it into its buffer, colour all neutral but not constant
    (so that reading colour for luma shows)."""
    height, width = image.shape
    if name in LUMA_STEPS:
        first, step = LUMA_STEPS[name]
        packed = np.full((height, width * 2), 77, np.uint8)
        packed[:, first::step] = image
        return packed.tobytes()
    if name == "MJPG":
        file = io.BytesIO()
        Image.fromarray(image).save(file, "JPEG", quality=95)
        return file.getvalue()
    colour = bytes([77]) * (width * height // 2)
    return image.tobytes() + (b"" if name == "GREY" else colour)


def noisy(image: np.ndarray, count: int = 20, sigma: float = 2.0, seed: int = 3) -> list[np.ndarray]:
    """The same scene as a sensor sees it several times: no two pictures are equal."""
    rng = np.random.default_rng(seed)
    return [
        np.clip(np.rint(image + rng.normal(0.0, sigma, image.shape)), 0, 255).astype(np.uint8) for _ in range(count)
    ]


def blurred(image: np.ndarray, radius_px: float = 12.0) -> np.ndarray:
    return np.asarray(Image.fromarray(image).filter(ImageFilter.GaussianBlur(radius_px)))


class FakeCamera:
    """/dev/video90 for the programs started with ``environment()``. Reading and writing the attributes in FIELDS goes
    to the shared file."""

    def __init__(
        self,
        folder: Path,
        pictures: Mapping[str, Sequence[np.ndarray | bytes]],
        *,
        format: str = "GREY",
        formats: Sequence[tuple[str, int, int, int]] | None = None,
        rate_hz: int = 30,
    ) -> None:
        """``pictures``: series by name, the first is shown; images, or the raw bytes of a buffer. ``formats``: (fourcc,
        width, height, rate_hz) that the camera claims to have, if not just the one of the pictures."""
        first = next(image for series in pictures.values() for image in series if not isinstance(image, bytes))
        height, width = first.shape
        self.series: dict[str, tuple[int, int]] = {}
        chunks: list[bytes] = []
        for name, images in pictures.items():
            self.series[name] = (len(chunks), len(images))
            chunks += [image if isinstance(image, bytes) else encode(image, format) for image in images]
        assert len(chunks) <= PICTURES
        self.path = folder / "fake_camera.shared"
        table = [fourcc_value for row in formats or [(format, width, height, rate_hz)] for fourcc_value in _row(row)]
        places, offset = [], HEADER_BYTES
        for chunk in chunks:
            places += [offset, len(chunk)]
            offset += len(chunk)
        numbers = [0] * len(FIELDS) + table + [0] * (4 * FORMATS - len(table))
        numbers += places + [0] * (2 * PICTURES - len(places))
        self.path.write_bytes(struct.pack(f"<{len(numbers)}q", *numbers) + b"".join(chunks))
        with self.path.open("r+b") as file:
            self._shared = np.frombuffer(mmap.mmap(file.fileno(), HEADER_BYTES), np.int64)
        self.number, self.rate_hz = NUMBER, rate_hz
        self.buffer_bytes = max(2 * width * height, *map(len, chunks))
        self.format_count = len(table) // 4
        self.show(next(iter(pictures)))

    def __getattr__(self, name: str) -> int:
        if name not in FIELDS:
            raise AttributeError(name)
        return int(self._shared[FIELDS.index(name)])

    def __setattr__(self, name: str, value: object) -> None:
        if name in FIELDS:
            self._shared[FIELDS.index(name)] = value
        else:
            object.__setattr__(self, name, value)

    def show(self, name: str) -> None:
        """This series from now on. A series of one picture is a frozen camera."""
        first, count = self.series[name]
        self.picture_count = 1  # never points beyond the table, whenever it is looked at
        self.first_picture, self.picture_count = first, count

    def heal(self) -> None:
        """Ends every fault; the pictures stay."""
        for name in FAULTS:
            setattr(self, name, 0)

    def environment(self) -> dict[str, str]:
        library = built("libfake_camera.so")
        assert library.exists(), f"{library} is missing: configure with -DPILOTFISH_TESTS=ON"
        # A sanitizer's runtime wants to be the first library, and says no if it is not.
        asan = ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "verify_asan_link_order=0"]))
        return {"LD_PRELOAD": str(library), "PILOTFISH_FAKE_CAMERA": str(self.path), "ASAN_OPTIONS": asan}

    def prefix(self) -> list[str]:
        """In front of a command line: the command sees the camera."""
        return ["env", *(f"{name}={value}" for name, value in self.environment().items())]


def _row(row: tuple[str, int, int, int]) -> tuple[int, int, int, int]:
    name, width, height, rate_hz = row
    return fourcc(name), width, height, rate_hz

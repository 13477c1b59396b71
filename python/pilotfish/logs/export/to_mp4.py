"""MP4 (H.264, yuv420p): every recorded image, at the time of its exposure, with what was seen in it."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pilotfish.errors import MissingPackageError, RecordingError
from pilotfish.extras import require
from pilotfish.logs.clock import RunClock
from pilotfish.logs.columns import CORNERS, NONE
from pilotfish.logs.export.overlay import Seen, with_overlay
from pilotfish.logs.images import RecordedImage, images_in
from pilotfish.logs.notes import RunNotes
from pilotfish.logs.reader import read_run
from pilotfish.logs.run import RobotRun, Run
from pilotfish.logs.sources import OnProgress
from pilotfish.whole_files import written_whole

TIME_BASE = Fraction(1, 1_000_000)  # microseconds, as the stamps
_QUALITY = {"crf": "20", "preset": "veryfast", "bf": "0"}
_INSTALL = "pip install 'pilotfish[export]'"
_NOMINAL_RATE_HZ = 30


def export_mp4(
    path: Path,
    out: Path,
    *,
    robot: str | None = None,
    overlay: bool = True,
    on_progress: OnProgress | None = None,
    notes: RunNotes | None = None,
) -> int:
    """The number of frames written. Images of another size than the first's are scaled to it.

    RecordingError if there is no image, or if several cameras were recorded and none is named; MissingFileError,
    MissingPackageError, OSError."""
    av = require("av", "export")
    first, second = _halves(on_progress)
    run = read_run(path, on_progress=first, notes=notes)
    camera = _camera(path, list(run.cameras), robot)
    known = _Known(_whose(run, camera))
    try:
        with written_whole(out) as partial, av.open(str(partial), "w", format="mp4") as container:
            video = _Video(av, container)
            for image, pixels, t_s in _timed(images_in(path, None, second), camera, simulated=known.simulated):
                video.add(with_overlay(pixels, known.of(image, t_s)) if overlay else _even(pixels), t_s)
            if not video.count:
                raise RecordingError(f"{path}: no image of '{camera}' that can be read")
            video.finish()
    except av.codec.codec.UnknownCodecError as error:
        raise MissingPackageError(f"this PyAV has no encoder for H.264 ({error}): {_INSTALL}") from error
    except av.error.FFmpegError as error:
        raise OSError(error.errno, error.strerror, str(out)) from error
    return video.count


def _timed(
    images: Iterator[RecordedImage], camera: str, *, simulated: bool
) -> Iterator[tuple[RecordedImage, NDArray[np.uint8], float]]:
    """The camera's images that can be read, with their pixels and their times."""
    clock: RunClock | None = None
    for image in images:
        if image.robot != camera:
            continue
        clock = clock or RunClock(image.log_utime)
        t_s = clock.of_frame(image.utime, image.log_utime, NONE, simulated=simulated)
        pixels = image.pixels()
        if pixels is not None:  # else damaged, or of a format that is not read
            yield image, pixels, t_s


class _Video:
    def __init__(self, av: Any, container: Any) -> None:
        self._av, self._container, self._stream = av, container, None
        self._last_pts = -1
        self.count = 0

    def add(self, pixels: NDArray[np.uint8], t_s: float) -> None:
        if self._stream is None:
            self._stream = self._container.add_stream("libx264", rate=_NOMINAL_RATE_HZ, options=_QUALITY)
            self._stream.height, self._stream.width = pixels.shape[:2]
            self._stream.pix_fmt = "yuv420p"
            self._stream.codec_context.time_base = self._stream.time_base = TIME_BASE
        frame = self._av.VideoFrame.from_ndarray(pixels, format="rgb24")
        if (frame.width, frame.height) != (self._stream.width, self._stream.height):
            frame = frame.reformat(self._stream.width, self._stream.height)
        self._last_pts = max(round(t_s / TIME_BASE), self._last_pts + 1)
        frame.pts, frame.time_base = self._last_pts, TIME_BASE
        self._container.mux(self._stream.encode(frame))
        self.count += 1

    def finish(self) -> None:
        self._container.mux(self._stream.encode(None))


class _Known:
    """What was seen in the image with a stamp: the first frame of that stamp."""

    def __init__(self, robot: RobotRun | None) -> None:
        self._frames, self._tags = (robot.frames, robot.tags) if robot else (None, None)
        self.simulated = robot is not None and robot.simulated
        self._rows: dict[int, int] = {}
        self._tag_rows: dict[int, list[int]] = {}
        if robot is None:
            return
        for row, utime in enumerate(robot.frames["utime_us"].tolist()):
            self._rows.setdefault(utime, row)
        for row, utime in enumerate(robot.tags["utime_us"].tolist()):
            self._tag_rows.setdefault(utime, []).append(row)
        self._status, self._reason = robot.frames.words("status"), robot.frames.words("reason")

    def of(self, image: RecordedImage, t_s: float) -> Seen:
        if self._frames is None or self._tags is None or (row := self._rows.get(image.utime)) is None:
            return Seen(t_s)
        measured = bool(self._frames["measured"][row])
        tags = []
        for at in self._tag_rows.get(image.utime, []) if measured else []:
            corners = np.array([self._tags[name][at] for name in CORNERS]).reshape(4, 2)
            tags.append((int(self._tags["id"][at]), corners))
        return Seen(
            t_s,
            status=str(self._status[row]),
            reason=str(self._reason[row]),
            distance_m=float(self._frames["distance_m"][row]) if measured else None,
            bearing_rad=float(self._frames["bearing_rad"][row]) if measured else None,
            tags=tuple(tags),
        )


def _halves(on_progress: OnProgress | None) -> tuple[OnProgress | None, OnProgress | None]:
    """The file is read twice: for what was seen, and for the images."""
    if on_progress is None:
        return None, None

    def first(done: int, total: int | None) -> None:
        on_progress(done, 2 * (total or 0))

    def second(done: int, total: int | None) -> None:
        on_progress((total or 0) + done, 2 * (total or 0))

    return first, second


def _whose(run: Run, camera: str) -> RobotRun | None:
    """The coordinator that looked through it: of the same name, or the only one if there is one camera."""
    alone = len(run.coordinators) == 1 and len(run.cameras) == 1
    return next((one for one in run.coordinators if alone or one.name.lower() == camera), None)


def _camera(path: Path, cameras: list[str], robot: str | None) -> str:
    if robot is not None:
        if robot.lower() not in cameras:
            there = ", ".join(cameras) or "none"
            raise RecordingError(f"{path}: no image of robot '{robot}' in it; cameras in it: {there}")
        return robot.lower()
    if not cameras:
        raise RecordingError(
            f"{path}: no image in it: a black box keeps images as they come only as JPEG, and copies of others at "
            "black_box.picture_rate_hz; lcm-logger keeps all"
        )
    if len(cameras) > 1:
        raise RecordingError(f"{path}: several cameras recorded here, name one with --robot: {', '.join(cameras)}")
    return cameras[0]


def _even(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height, width = pixels.shape[:2]
    return np.pad(pixels, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")

"""A camera without any coordinator: any one tag, its pose by Pilotfish's tracker, also without a calibration."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import math
import threading
import time
from collections import Counter, OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pilotfish import capture, coordinator, core
from pilotfish.errors import ConfigError, MissingFileError, SilentRobotError
from pilotfish.view.feed import Feed
from pilotfish.view.messages import Values
from pilotfish.view.one_tag import OneTag
from pilotfish.view.pictures import Picture, encode
from pilotfish.view.samples import Samples
from pilotfish.view.setup import axes_px

DEFAULT_FOV_DEG = 60.0
_IDLE_S = 0.05
_ENCODE_EVERY_S = 0.05
_OVERLAYS = 32


@dataclass(frozen=True)
class CameraSource:
    """What is looked at and with what lens; camera None: as wide as fov_deg, whatever size its pictures have."""

    name: str
    open: Callable[[], capture.FrameSource]
    camera: core.CameraModel | None
    fov_deg: float


def open_source(camera: str, *, camera_file: Path | None, fov_deg: float | None, size: str) -> CameraSource:
    """``camera``: a number, camera:N, images:DIR or video:FILE. Opens it once, so that an error shows at the start.

    ValueError for words that mean no source or size; ConfigError, MissingFileError or SilentRobotError for what they
    name.
    """
    calibration = None
    if camera_file is not None:
        try:
            calibration = coordinator.load_calibration(camera_file)
        except ValueError as error:
            raise ConfigError(str(error)) from error
    width, height = (calibration.width, calibration.height) if calibration else _size(size)
    kind, _, where = ("camera", "", camera) if camera.isdecimal() else camera.partition(":")
    if kind == "camera" and where.isdecimal():
        opener = lambda: capture.open_camera(int(where), width=width, height=height)  # noqa: E731
    elif kind == "images" and where:
        opener = lambda: capture.open_images(where)  # noqa: E731
    elif kind == "video" and where:
        opener = lambda: capture.open_video(where)  # noqa: E731
    else:
        raise ValueError(f"--camera {camera}: a camera's number, images:DIR or video:FILE")
    try:
        opener()  # and closed again: it is opened when somebody watches
    except capture.CaptureError as error:
        kind_of_error = SilentRobotError if kind == "camera" else MissingFileError
        raise kind_of_error(str(error)) from error
    return CameraSource(camera, opener, calibration, fov_deg or DEFAULT_FOV_DEG)


def assumed_camera(width: int, height: int, fov_deg: float) -> core.CameraModel:
    """A pinhole without distortion, its axis in the middle: f = (w / 2) / tan(fov / 2)."""
    f_px = 0.5 * width / math.tan(0.5 * math.radians(fov_deg))
    return core.CameraModel(width=width, height=height, fx=f_px, fy=f_px, cx=0.5 * (width - 1), cy=0.5 * (height - 1))


class CameraFeed(Feed):
    """Looks only while a page watches, in a thread of its own."""

    mode = "camera"

    def __init__(self, source: CameraSource, tag_size_m: float) -> None:
        super().__init__("camera")
        self._source, self._tag_size_m = source, tag_size_m
        self._camera = source.camera
        self._samples = Samples()
        self._seen: Values | None = None
        self._overlays: OrderedDict[int, Values] = OrderedDict()  # by the picture's utime
        self._picture: tuple[Picture, float] | None = None
        self._arrived_s: float | None = None
        self._problem = ""
        self._frame_size: tuple[int, int] | None = None
        self._period_s: float | None = None
        self._counts: Counter[str] = Counter()
        self._stop, self._wanted = threading.Event(), threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """Begins the thread; it waits until somebody watches."""
        self._thread = threading.Thread(target=self._run, args=(loop,), name="camera", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Ends it."""
        self._stop.set()
        self._wanted.set()
        if self._thread is not None:
            self._thread.join(3.0)

    def watch(self, on_news: Callable[[str], None]) -> None:
        """As Feed's."""
        super().watch(on_news)
        self._wanted.set()

    def unwatch(self, on_news: Callable[[str], None]) -> None:
        """As Feed's."""
        super().unwatch(on_news)
        if not self.watched:
            self._wanted.clear()
            self._picture = self._seen = None

    def hello(self) -> dict[str, Any]:
        """As Feed's."""
        calibrated = self._source.camera is not None
        return {
            "mode": self.mode,
            "robot": self.name,
            "configured": calibrated,
            "source": self._source.name,
            "tag_size_m": self._tag_size_m,
            "assumed_fov_deg": None if calibrated else self._source.fov_deg,
        }

    def state(self, samples_from: int, now_s: float) -> tuple[dict[str, Any], int]:
        """As Feed's."""
        next_sample, rows = self._samples.since(samples_from)
        age_s = None if self._arrived_s is None else round(now_s - self._arrived_s, 4)
        return {
            "ages_s": {} if age_s is None else {"observation": age_s, "picture": age_s},
            "observation": self._seen,
            "words": self._words(),
            "assumed_fov_deg": None if self._source.camera else self._source.fov_deg,
            "frame_rate_hz": None if not self._period_s else 1.0 / self._period_s,
            "rejected": dict(self._counts),
            "samples": rows,
        }, next_sample

    def picture(self) -> tuple[Picture, float] | None:
        """As Feed's."""
        return self._picture

    def overlay(self, utime_us: int) -> dict[str, Any] | None:
        """As Feed's."""
        return self._overlays.get(utime_us)

    def _words(self) -> dict[str, Any]:
        if self._problem:
            return {"headline": "No pictures", "tone": "bad", "why": self._problem, "lines": []}
        if self._seen is None:
            return {"headline": "Waiting for the first picture", "tone": "wait", "why": "", "lines": []}
        camera, lines = self._camera, []
        if camera is not None:
            lens = "calibrated" if self._source.camera else f"not calibrated: {self._source.fov_deg:g}° wide is assumed"
            lines.append(f"picture {camera.width} x {camera.height}, {lens}")
        if self._seen["reason"] == "frame_size_not_calibrated" and camera is not None:
            return self._words_of_another_size(self._seen["text"], camera)
        if not self._seen["detected"]:
            return {"headline": "No tag", "tone": "wait", "why": self._seen["text"], "lines": lines}
        tag = self._seen["tags"][0]["id"]
        lines.append(f"reprojection error {self._seen['reprojection_error_px']:.2f} px")
        return {"headline": f"Tag {tag}", "tone": "good", "why": f"{self._seen['range_m']:.3f} m away", "lines": lines}

    def _words_of_another_size(self, sizes: str, calibration: core.CameraModel) -> dict[str, Any]:
        """Nothing is measured: what mends it."""
        recorded, size = self._source.name.startswith(("images:", "video:")), ""
        if not recorded and self._frame_size is not None:
            size = " --size {}x{}".format(*self._frame_size)
        source = "PICTURES_OF_A_BOARD" if recorded else f"camera:{self._source.name.removeprefix('camera:')}"
        lines = [
            "nothing is measured: a calibration holds for its own picture size alone. One of this size is made by",
            f"pilotfish calibrate camera {source}{size} --board board.yaml --out camera.yaml",
            f"or take pictures of {calibration.width} x {calibration.height}; without --camera-file, a lens is assumed",
        ]
        headline = "The calibration is of another picture size"
        return {"headline": headline, "tone": "bad", "why": sizes, "lines": lines}

    def _run(self, loop: asyncio.AbstractEventLoop) -> None:
        """The thread."""
        while not self._stop.is_set():
            self._wanted.wait()
            if self._stop.is_set():
                return
            try:
                self._play(self._source.open(), loop)
            except (capture.CaptureError, ValueError) as error:
                self._problem = str(error)
                self._post(loop, lambda: self.tell("state"))
                self._stop.wait(1.0)

    def _play(self, frames: capture.FrameSource, loop: asyncio.AbstractEventLoop) -> None:
        """Until the source ends, after which it is opened again, or nobody watches: then others may have the camera."""
        tag = OneTag(self._tag_size_m)
        started_s = first_us = encoded_s = last_s = None
        while self._wanted.is_set() and not self._stop.is_set():
            frame = frames.next()
            if frame is None:
                if frames.ended:
                    if frames.live:
                        self._problem = frames.why_ended
                    self._stop.wait(1.0 if frames.live else _IDLE_S)
                    return
                self._stop.wait(_IDLE_S / 10)
                continue
            if not frames.live:  # a recording is played at its own rate
                if started_s is None or first_us is None:
                    started_s, first_us = time.monotonic(), frame.utime
                self._stop.wait(max(0.0, started_s + (frame.utime - first_us) * 1e-6 - time.monotonic()))
            now_s = time.monotonic()
            camera = self._camera_of(frame)
            self._frame_size = frame.width, frame.height
            seen = tag.look(frame, camera)
            if self._source.camera is None:
                seen["sigma"] = None  # the noise's share, beside which an assumed lens may be 20 % off
            overlay = self._overlay_of(seen, camera)
            picture = None
            if encoded_s is None or now_s - encoded_s >= _ENCODE_EVERY_S:
                encoded_s = now_s
                picture = encode(frame.image, frame.utime)
            period_s = None if last_s is None else now_s - last_s
            last_s = now_s
            show = functools.partial(self._show, seen, overlay, picture, period_s, now_s)
            self._post(loop, show)

    def _camera_of(self, frame: core.Frame) -> core.CameraModel:
        if self._camera is None:
            self._camera = assumed_camera(frame.width, frame.height, self._source.fov_deg)
        return self._camera

    def _overlay_of(self, seen: Values, camera: core.CameraModel) -> Values:
        pose = seen["camera_from_leader"]
        return {
            "utime_us": seen["utime_us"],
            "detected": seen["detected"],
            "text": seen["text"],
            "tags": seen["tags"],
            "axes_px": None if pose is None else axes_px(camera, pose),
            "calibrated_size": [camera.width, camera.height],
            "distance_m": seen["range_m"],  # to the tag: what every other number of this page says
            "bearing_rad": seen["bearing_rad"],
        }

    def _post(self, loop: asyncio.AbstractEventLoop, call: Callable[[], None]) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has just been closed
            loop.call_soon_threadsafe(call)

    def _show(
        self, seen: Values, overlay: Values, picture: Picture | None, period_s: float | None, now_s: float
    ) -> None:
        """On the event loop's thread."""
        self._overlays[seen["utime_us"]] = overlay
        self._overlays.move_to_end(seen["utime_us"])
        while len(self._overlays) > _OVERLAYS:
            self._overlays.popitem(last=False)
        self._problem = ""
        self._arrived_s = now_s
        self._seen = seen
        if period_s is not None:
            self._period_s = period_s if self._period_s is None else 0.9 * self._period_s + 0.1 * period_s
        if not seen["detected"]:
            self._counts[seen["reason"]] += 1
        if self._samples.due(now_s):
            d, b = seen["distance_m"], seen["bearing_rad"]
            place = (None, None) if d is None else (d * math.cos(b), d * math.sin(b))
            bearing_deg = None if b is None else math.degrees(b)
            self._samples.add(
                now_s, [None, bearing_deg, *(None, None, None), *(0.0, 0.0, 0.0), *place, seen["range_m"]]
            )
        self.tell("state")
        if picture is not None:
            self._picture = picture, now_s
            self.tell("picture")


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if width.isdecimal() and height.isdecimal() and 16 <= int(width) <= 8192 and 16 <= int(height) <= 8192:
        return int(width), int(height)
    raise ValueError(f"--size {text}: WIDTHxHEIGHT in pixels, each from 16 to 8192, e.g. 640x480")

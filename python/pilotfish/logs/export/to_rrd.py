"""RRD, which the Rerun viewer opens: images with the tags outlined, poses in space, every number over time, events.

Two time lines: ``exposure`` is the stamp of the frame, on the clock that stamps the images (without a date it begins in
1970), and ``logged`` the wall clock of the computer that recorded; events have no stamp, so they are put at that of the
frame before them. Rerun's pixels begin at the corner of the top-left pixel, ours at its centre: half a pixel between
them.
"""

from __future__ import annotations

import math
import uuid
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish.black_box.log import Event
from pilotfish.extras import require
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.logs.columns import CORNERS, FRAMES
from pilotfish.logs.export.rerun_columns import ScalarColumns
from pilotfish.logs.images import JPEG, RecordedImage, image_of
from pilotfish.logs.messages import Message
from pilotfish.logs.notes import RunNotes
from pilotfish.logs.rows import Row, everything_in
from pilotfish.logs.sources import OnProgress
from pilotfish.whole_files import written_whole

EXPOSURE, LOGGED = "exposure", "logged"
_OUTLINE = (213, 94, 0)  # Okabe and Ito's vermillion
_COLOURS = {image_t.PIXEL_FORMAT_GRAY: "L", image_t.PIXEL_FORMAT_RGB: "RGB", image_t.PIXEL_FORMAT_BGR: "BGR"}
_AXIS_M = 0.3
_LEVELS = {"gap": "WARN", "damage": "WARN", "counter": "WARN"}
# What a new window shows, of each robot: a title, and columns of FRAMES.
_CURVES = {
    "error": ("error_m",),
    "bearing": ("bearing_rad", "setpoint_bearing_rad"),
    "command": ("command_linear_mps", "command_angular_radps"),
    "latency": ("latency_s", "loop_latency_s"),
}


def export_rrd(
    path: Path,
    out: Path,
    *,
    robot: str | None = None,
    images: bool = True,
    on_progress: OnProgress | None = None,
    notes: RunNotes | None = None,
) -> int:
    """The number of frames and images written. RecordingError, MissingFileError, MissingPackageError, OSError."""
    rr = require("rerun", "rerun")
    notes, count = notes or RunNotes(), 0
    with written_whole(out) as partial:
        stream = rr.RecordingStream("pilotfish", recording_id=str(uuid.uuid5(uuid.NAMESPACE_URL, str(path.resolve()))))
        stream.set_log_time_enabled(False)  # when the export ran is of no interest
        stream.set_log_tick_enabled(False)
        stream.save(partial)
        try:
            writer = _Writer(rr, stream)
            for item in everything_in(path, robot, notes, on_progress):
                count += writer.take(item, images, notes)
            writer.end(notes)
        finally:
            stream.disconnect()
    return count


class _Writer:
    """One recording on its way into one stream."""

    def __init__(self, rr: Any, stream: Any) -> None:
        self._rr, self._stream = rr, stream
        self._numbers: dict[str, ScalarColumns] = {}
        self._last_utime: dict[str, int] = {}
        self._cameras: set[str] = set()

    def take(self, item: Row | Message | Event, images: bool, notes: RunNotes) -> int:
        """Writes it; 1 for a frame or an image, else 0."""
        if isinstance(item, Message):
            return 0
        if isinstance(item, Event):
            picture = image_of(item) if images else None
            return int(picture is not None and self._image(picture))
        if item.table == "frames":
            self._frame(item)
            return 1
        if item.table == "poses":
            self._pose(item)
        elif item.table == "events":
            self._event(item, notes)
        return 0

    def end(self, notes: RunNotes) -> None:
        """What was held back, the configuration's texts, and which views a new window opens."""
        for numbers in self._numbers.values():
            numbers.send()
        for robot, own in notes.robots.items():
            for start, settings in enumerate(own.settings):
                for file in settings.files:
                    entity = self._entity(robot, "settings", f"start{start}", file.role, Path(file.name).name)
                    text = self._rr.TextDocument(file.text, media_type="text/plain")
                    self._stream.log(entity, text, static=True)
        if blueprint := self._blueprint():
            self._stream.send_blueprint(blueprint)

    def _entity(self, *parts: str) -> str:
        return self._rr.new_entity_path(list(parts))

    def _at(self, utime: int, log_utime: int | None = None) -> None:
        self._stream.reset_time()
        self._stream.set_time(EXPOSURE, timestamp=np.datetime64(utime, "us"))
        if log_utime is not None:
            self._stream.set_time(LOGGED, timestamp=np.datetime64(log_utime, "us"))

    def _image(self, picture: RecordedImage) -> bool:
        entity = self._entity(picture.robot, "camera", "image")
        if picture.pixelformat == JPEG:
            shown = self._rr.EncodedImage(contents=picture.data, media_type="image/jpeg")
        elif picture.pixelformat in _COLOURS and (pixels := picture.pixels()) is not None:
            gray = picture.pixelformat == image_t.PIXEL_FORMAT_GRAY
            shown = self._rr.Image(pixels[:, :, 0] if gray else pixels, "L" if gray else "RGB")
        else:
            return False
        self._cameras.add(picture.robot)
        self._at(picture.utime, picture.log_utime)
        self._stream.log(entity, shown)
        return True

    def _frame(self, row: Row) -> None:
        values, utime = row.values, row.values["utime_us"]
        if row.robot not in self._numbers:
            entity = self._entity(row.robot, "frames")
            self._numbers[row.robot] = ScalarColumns(self._rr, self._stream, entity, FRAMES, EXPOSURE)
        self._numbers[row.robot].add(utime, values)
        self._last_utime[row.robot] = utime
        self._at(utime, values["log_utime_us"])
        self._tags(row)
        leader = self._entity(row.robot, "leader")
        where = [values.get(name, math.nan) for name in ("distance_m", "bearing_rad", "heading_rad")]
        if values.get("measured") and all(map(math.isfinite, where)):
            distance_m, bearing_rad, heading_rad = where
            place = (distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad), 0.0)
            self._stream.log(leader, *self._frame_at(place, heading_rad))
        else:  # else the last place stays until the next one
            self._stream.log(leader, self._rr.Clear(recursive=False))

    def _tags(self, row: Row) -> None:
        entity = self._entity(row.robot, "camera", "image", "tags")
        outlines, labels = [], []
        for tag in row.tags:
            corners = np.array([tag[name] for name in CORNERS]).reshape(4, 2) + 0.5
            if np.isfinite(corners).all():
                outlines.append(np.vstack([corners, corners[:1]]))
                labels.append(f"id {tag['id']}")
        if outlines:
            strips = self._rr.LineStrips2D(outlines, labels=labels, colors=[_OUTLINE] * len(outlines), radii=0.75)
            self._stream.log(entity, strips)
        else:
            self._stream.log(entity, self._rr.Clear(recursive=False))

    def _pose(self, row: Row) -> None:
        values = row.values
        where = [values.get(name, math.nan) for name in ("x_m", "y_m", "heading_rad")]
        if all(map(math.isfinite, where)):
            self._at(values["utime_us"])
            self._stream.log(self._entity(row.robot), *self._frame_at((where[0], where[1], 0.0), where[2]))

    def _frame_at(self, place_m: tuple[float, float, float], heading_rad: float) -> tuple[Any, Any]:
        """A base frame at a place of its parent's ground, turned about z, with its axes drawn."""
        turn = self._rr.Quaternion(xyzw=[0.0, 0.0, math.sin(heading_rad / 2), math.cos(heading_rad / 2)])
        return self._rr.Transform3D(translation=place_m, quaternion=turn), self._rr.TransformAxes3D(_AXIS_M)

    def _event(self, row: Row, notes: RunNotes) -> None:
        values = row.values
        log_utime = values["log_utime_us"]
        log_utime = log_utime if log_utime > 0 else notes.start_utime + round(1e6 * values["t_s"])
        self._stream.reset_time()
        if (utime := self._last_utime.get(row.robot)) is not None:
            self._at(utime, log_utime)
        else:
            self._stream.set_time(LOGGED, timestamp=np.datetime64(log_utime, "us"))
        text = f"{values['kind']}: {values['text']}"
        level = _LEVELS.get(values["kind"], "INFO")
        self._stream.log(self._entity(row.robot, "events"), self._rr.TextLog(text, level=level))

    def _blueprint(self) -> Any:
        """Per robot the image, the ground from above and curves; None without frames. Needs no viewer."""
        import rerun.blueprint as rrb

        tabs = []
        for robot in self._numbers:
            frames = self._entity(robot, "frames")
            curves = [
                rrb.TimeSeriesView(name=title, origin=frames, contents=[f"$origin/{name}" for name in names])
                for title, names in _CURVES.items()
            ]
            views = [rrb.Spatial3DView(name="poses", origin="/", contents=["$origin/**", "- /**/camera/**"])]
            if robot in self._cameras:
                views.insert(0, rrb.Spatial2DView(name="camera", origin=self._entity(robot, "camera", "image")))
            events = rrb.TextLogView(name="events", origin=self._entity(robot, "events"))
            left = rrb.Vertical(*views, events)
            tabs.append(rrb.Horizontal(left, rrb.Vertical(*curves), name=robot))
        return rrb.Blueprint(rrb.Tabs(*tabs), collapse_panels=True) if tabs else None

"""MCAP, which Foxglove opens: every message as JSON on a topic named as its channel, and beside them what Foxglove can
draw by itself (image, outlines of the tags, pose of the leader, events) and one row of joined columns a frame."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pilotfish.black_box.log import Event
from pilotfish.extras import require
from pilotfish.logs.columns import FRAMES, Column
from pilotfish.logs.export import foxglove, lcm_json
from pilotfish.logs.export.table_rows import cell
from pilotfish.logs.images import image_of
from pilotfish.logs.messages import TYPES, Message
from pilotfish.logs.notes import RunNotes
from pilotfish.logs.rows import Row, everything_in
from pilotfish.logs.sources import OnProgress
from pilotfish.whole_files import written_whole

_JSON_TYPES = {"float": "number", "int": "integer", "bool": "boolean", "word": "string", "text": "string"}
_SKIPPED = {"BOX"}  # its texts become attachments; what the core remembers is of use to a replay only


def export_mcap(
    path: Path,
    out: Path,
    *,
    robot: str | None = None,
    images: bool = True,
    on_progress: OnProgress | None = None,
    notes: RunNotes | None = None,
) -> int:
    """The number of MCAP messages written. RecordingError, MissingFileError, MissingPackageError, OSError."""
    writer_module, count, notes = require("mcap.writer", "export"), 0, notes or RunNotes()
    with written_whole(out) as partial, partial.open("wb") as stream:
        writer = writer_module.Writer(stream)
        writer.start(profile="", library="pilotfish")
        topics = _Topics(writer)
        for item in everything_in(path, robot, notes, on_progress):
            for topic, schema, log_utime, message in _messages(item, notes, images):
                topics.write(topic, schema, log_utime, message)
                count += 1
        _write_settings(writer, notes)
        writer.finish()
    return count


_Said = tuple[str, str, int, dict[str, Any]]  # topic, schema, wall clock [us], message


def _messages(item: Row | Message | Event, notes: RunNotes, images: bool) -> Iterator[_Said]:
    if isinstance(item, Message):
        if item.kind not in _SKIPPED:
            schema = f"pilotfish.{TYPES[item.kind].__name__}"
            yield item.event.channel, schema, item.event.utime, lcm_json.plain(item.content)
    elif isinstance(item, Event):
        picture = image_of(item) if images else None
        if picture is not None and (said := foxglove.image(picture)) is not None:
            schema, message = said
            topic = f"/{picture.robot}/image" if schema == "CompressedImage" else f"/{picture.robot}/image_raw"
            yield topic, f"foxglove.{schema}", item.utime, message
    elif item.table == "frames":
        yield from _of_frame(item)
    elif item.table == "events":
        values = item.values
        utime = values["log_utime_us"]
        utime = utime if utime > 0 else notes.start_utime + round(1e6 * values["t_s"])
        message = foxglove.log_line(utime, item.robot, values["kind"], values["text"])
        yield f"/{item.robot}/events", "foxglove.Log", utime, message


def _of_frame(row: Row) -> Iterator[_Said]:
    values = row.values
    log_utime, utime = values["log_utime_us"], values["utime_us"]
    columns = {column.name: _finite(cell(column, row)) for column in FRAMES}
    yield f"/{row.robot}/frames", "pilotfish.frames", log_utime, columns
    outlines = foxglove.annotations(utime, row.tags)
    yield f"/{row.robot}/tags", "foxglove.ImageAnnotations", log_utime, outlines
    if values.get("measured"):
        where = (values["distance_m"], values["bearing_rad"], values["heading_rad"])
        if all(lcm_json.finite(number) is not None for number in where):
            pose = foxglove.leader_pose(utime, row.robot, *where)
            yield f"/{row.robot}/leader_pose", "foxglove.PoseInFrame", log_utime, pose


def _finite(value: Any) -> Any:
    return lcm_json.finite(value) if isinstance(value, float) else value


class _Topics:
    """Registers schemas and channels as they are needed."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self._schemas: dict[str, int] = {}
        self._channels: dict[tuple[str, str], int] = {}
        self._sequences: dict[int, int] = {}

    def write(self, topic: str, schema: str, log_utime: int, message: dict[str, Any]) -> None:
        if (topic, schema) not in self._channels:
            if schema not in self._schemas:
                text = json.dumps(_schema(schema)).encode()
                self._schemas[schema] = self._writer.register_schema(name=schema, encoding="jsonschema", data=text)
            self._channels[topic, schema] = self._writer.register_channel(
                topic=topic, message_encoding="json", schema_id=self._schemas[schema]
            )
        channel = self._channels[topic, schema]
        self._sequences[channel] = sequence = (self._sequences.get(channel, -1) + 1) & 0xFFFFFFFF
        time_ns = max(0, log_utime) * 1000
        data = json.dumps(message, allow_nan=False, separators=(",", ":")).encode()
        self._writer.add_message(channel, log_time=time_ns, data=data, publish_time=time_ns, sequence=sequence)


def _schema(name: str) -> dict[str, Any]:
    package, _, kind = name.partition(".")
    if package == "foxglove":
        return foxglove.SCHEMAS[kind]
    if name == "pilotfish.frames":
        return {"title": name, "type": "object", "properties": {column.name: _property(column) for column in FRAMES}}
    return lcm_json.schema_of(next(one for one in TYPES.values() if one.__name__ == kind), name)


def _property(column: Column) -> dict[str, Any]:
    unit = f" [{column.unit}]" if column.unit else ""
    return {"type": _JSON_TYPES[column.kind], "description": f"{column.text}{unit}; null: not known"}


def _write_settings(writer: Any, notes: RunNotes) -> None:
    """The configuration's texts as attachments, what the command line said as metadata."""
    for robot, own in notes.robots.items():
        for start, settings in enumerate(own.settings):
            name = f"{robot}/start{start}"
            said = {"program": settings.program, "command_line": settings.command_line}
            writer.add_metadata(name=name, data=said | {"overrides": "\n".join(settings.overrides)})
            for file in settings.files:
                writer.add_attachment(
                    create_time=0,
                    log_time=notes.start_utime * 1000,
                    name=f"{name}/{file.role}/{Path(file.name).name}",
                    media_type="text/yaml",
                    data=file.text.encode(),
                )

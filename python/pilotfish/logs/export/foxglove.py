"""Messages in Foxglove's well-known schemas, as JSON: images, annotations, poses, logs.

Foxglove's pixels begin at the corner of the top-left pixel, ours at its centre: half a pixel between them. Its
quaternions are (x, y, z, w). Images, annotations and poses have the exposure's stamp, by which Foxglove puts them
together; a log line has the wall clock.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from typing import Any

from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.logs.columns import CORNERS
from pilotfish.logs.images import JPEG, RecordedImage

_TIME = {
    "title": "time",
    "type": "object",
    "properties": {
        "sec": {"type": "integer", "minimum": 0},
        "nsec": {"type": "integer", "minimum": 0, "maximum": 999999999},
    },
}
_BYTES = {"type": "string", "contentEncoding": "base64"}
_TEXT, _NUMBER, _INTEGER = {"type": "string"}, {"type": "number"}, {"type": "integer", "minimum": 0}


def _object(title: str, **properties: Any) -> dict[str, Any]:
    return {"title": f"foxglove.{title}", "type": "object", "properties": properties, "required": list(properties)}


def _list(items: dict[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": items}


_POINT2 = _object("Point2", x=_NUMBER, y=_NUMBER)
_VECTOR3 = _object("Vector3", x=_NUMBER, y=_NUMBER, z=_NUMBER)
_QUATERNION = _object("Quaternion", x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER)
_COLOR = _object("Color", r=_NUMBER, g=_NUMBER, b=_NUMBER, a=_NUMBER)
_POSE = _object("Pose", position=_VECTOR3, orientation=_QUATERNION)
_METADATA = _list(_object("KeyValuePair", key=_TEXT, value=_TEXT))
_CIRCLE = _object(
    "CircleAnnotation",
    timestamp=_TIME,
    position=_POINT2,
    diameter=_NUMBER,
    thickness=_NUMBER,
    fill_color=_COLOR,
    outline_color=_COLOR,
    metadata=_METADATA,
)
_POINTS = _object(
    "PointsAnnotation",
    timestamp=_TIME,
    type={"title": "foxglove.PointsAnnotationType", "oneOf": [{"title": "LINE_LOOP", "const": 2}]},
    points=_list(_POINT2),
    outline_color=_COLOR,
    outline_colors=_list(_COLOR),
    fill_color=_COLOR,
    thickness=_NUMBER,
    metadata=_METADATA,
)
_WORDS = _object(
    "TextAnnotation",
    timestamp=_TIME,
    position=_POINT2,
    text=_TEXT,
    font_size=_NUMBER,
    text_color=_COLOR,
    background_color=_COLOR,
    metadata=_METADATA,
)
_LEVELS = ("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL")
SCHEMAS: dict[str, dict[str, Any]] = {
    "CompressedImage": _object("CompressedImage", timestamp=_TIME, frame_id=_TEXT, data=_BYTES, format=_TEXT),
    "RawImage": _object(
        "RawImage",
        timestamp=_TIME,
        frame_id=_TEXT,
        width=_INTEGER,
        height=_INTEGER,
        encoding=_TEXT,
        step=_INTEGER,
        data=_BYTES,
    ),
    "ImageAnnotations": _object(
        "ImageAnnotations", circles=_list(_CIRCLE), points=_list(_POINTS), texts=_list(_WORDS), metadata=_METADATA
    ),
    "PoseInFrame": _object("PoseInFrame", timestamp=_TIME, frame_id=_TEXT, pose=_POSE),
    "Log": _object(
        "Log",
        timestamp=_TIME,
        level={"title": "foxglove.LogLevel", "oneOf": [{"title": name, "const": k} for k, name in enumerate(_LEVELS)]},
        message=_TEXT,
        name=_TEXT,
        file=_TEXT,
        line=_INTEGER,
    ),
}
_ENCODINGS = {
    image_t.PIXEL_FORMAT_GRAY: "mono8",
    image_t.PIXEL_FORMAT_RGB: "rgb8",
    image_t.PIXEL_FORMAT_BGR: "bgr8",
}
_OUTLINE = {"r": 0.835, "g": 0.369, "b": 0.0, "a": 1.0}  # Okabe and Ito's vermillion
_WHITE, _CLEAR, _SHADE = ({"r": v, "g": v, "b": v, "a": a} for v, a in ((1.0, 1.0), (0.0, 0.0), (0.0, 0.6)))
_ABOVE_PX = 3.0


def time_of(utime_us: int) -> dict[str, int]:
    """Of microseconds; Foxglove's times begin in 1970."""
    return {"sec": max(0, utime_us) // 1_000_000, "nsec": max(0, utime_us) % 1_000_000 * 1000}


def image(picture: RecordedImage) -> tuple[str, dict[str, Any]] | None:
    """(schema, message): a JPEG or raw pixels as they were recorded; None for a format that Foxglove does not know."""
    said = {"timestamp": time_of(picture.utime), "frame_id": f"{picture.robot}/camera"}
    data = base64.b64encode(picture.data).decode("ascii")
    if picture.pixelformat == JPEG:
        return "CompressedImage", said | {"data": data, "format": "jpeg"}
    if (encoding := _ENCODINGS.get(picture.pixelformat)) is None:
        return None
    size = {"width": picture.width, "height": picture.height, "step": picture.row_stride}
    return "RawImage", said | size | {"encoding": encoding, "data": data}


def annotations(utime: int, tags: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Outlines and ids of tags (rows of the table "tags") in the image with that stamp."""
    time, points, texts = time_of(utime), [], []
    for tag in tags:
        numbers = [tag[name] + 0.5 for name in CORNERS]
        corners = [{"x": u, "y": v} for u, v in zip(numbers[::2], numbers[1::2], strict=True)]
        points.append(
            {
                "timestamp": time,
                "type": 2,
                "points": corners,
                "outline_color": _OUTLINE,
                "outline_colors": [],
                "fill_color": _CLEAR,
                "thickness": 1.5,
                "metadata": [],
            }
        )
        texts.append(
            {
                "timestamp": time,
                "position": {"x": min(numbers[::2]), "y": min(numbers[1::2]) - _ABOVE_PX},
                "text": f"id {tag['id']}",
                "font_size": 12.0,
                "text_color": _WHITE,
                "background_color": _SHADE,
                "metadata": [],
            }
        )
    return {"circles": [], "points": points, "texts": texts, "metadata": []}


def leader_pose(utime: int, robot: str, distance_m: float, bearing_rad: float, heading_rad: float) -> dict[str, Any]:
    """The leader's base in the robot's: on the ground, at distance and bearing."""
    return {
        "timestamp": time_of(utime),
        "frame_id": f"{robot}/base",
        "pose": {
            "position": {"x": distance_m * math.cos(bearing_rad), "y": distance_m * math.sin(bearing_rad), "z": 0.0},
            "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(heading_rad / 2), "w": math.cos(heading_rad / 2)},
        },
    }


def log_line(log_utime: int, robot: str, kind: str, text: str) -> dict[str, Any]:
    """An event; gaps and damage are warnings."""
    level = 3 if kind in ("gap", "damage", "counter") else 2
    said = {"message": f"{kind}: {text}", "name": robot, "file": "", "line": 0}
    return {"timestamp": time_of(log_utime), "level": level} | said

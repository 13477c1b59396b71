"""Any LCM message as JSON, and the JSON schema of any LCM type, from what lcm-gen says of its fields.

Floats are written with as many digits as give the same bits back. JSON has no NaN and no infinity: they become null.
Bytes become base64, a mac is left out.
"""

from __future__ import annotations

import base64
import importlib
import math
from typing import Any

_NUMBERS = {"int8_t": "integer", "int16_t": "integer", "int32_t": "integer", "int64_t": "integer"}
_SIMPLE = _NUMBERS | {"float": "number", "double": "number", "string": "string", "boolean": "boolean"}
_LEFT_OUT = ("mac",)


def schema_of(kind: Any, title: str) -> dict[str, Any]:
    """The JSON schema of a class that lcm-gen has made."""
    properties = {}
    for name, type_name, dimensions in _fields(kind):
        properties[name] = _shape(_leaf(type_name), type_name, len(dimensions or ()))
    return {"title": title, "type": "object", "properties": properties}


def plain(message: Any) -> dict[str, Any]:
    """The message as dicts, lists, numbers and texts."""
    return {name: _plain(getattr(message, name), type_name) for name, type_name, _ in _fields(type(message))}


def finite(value: float) -> float | None:
    """None for what JSON cannot say."""
    return value if math.isfinite(value) else None


def _fields(kind: Any) -> list[tuple[str, str, Any]]:
    fields = zip(kind.__slots__, kind.__typenames__, kind.__dimensions__, strict=True)
    return [field for field in fields if field[0] not in _LEFT_OUT]


def _leaf(type_name: str) -> dict[str, Any]:
    if type_name == "byte":
        return {"type": "string", "contentEncoding": "base64"}
    if type_name in _SIMPLE:
        return {"type": _SIMPLE[type_name]}
    return schema_of(_class(type_name), type_name.rpartition(".")[2])


def _shape(leaf: dict[str, Any], type_name: str, depth: int) -> dict[str, Any]:
    for _ in range(0 if type_name == "byte" else depth):  # bytes are one text
        leaf = {"type": "array", "items": leaf}
    return leaf


def _class(type_name: str) -> Any:
    """lcm-gen says where a type is as "pilotfish.lcmtypes.pilotfish.stage_t"."""
    package, _, name = type_name.rpartition(".")
    return getattr(importlib.import_module(package), name)


def _plain(value: Any, type_name: str) -> Any:
    if type_name == "byte":
        return base64.b64encode(bytes(value)).decode("ascii")
    if isinstance(value, (list, tuple)):
        return [_plain(item, type_name) for item in value]
    if isinstance(value, float):
        return finite(value)
    if type_name == "boolean":
        return bool(value)
    return plain(value) if hasattr(value, "__slots__") else value

"""DDS types made from the .msg definitions that rosbags carries, and messages encoded by rosbags: nothing here was
written, or is encoded, by the bridge's side."""

from __future__ import annotations

import types

from cyclonedds.idl import IdlStruct, annotations
from cyclonedds.idl import types as idl
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Nodetype

STORE = get_typestore(Stores.ROS2_HUMBLE)
_BASES = {"string": str, "bool": bool}  # the others are called as in cyclonedds.idl.types


def dds_type(ros_name: str, *, raw: bool = False) -> type[IdlStruct]:
    """``geometry_msgs/msg/Twist`` as a DDS type of that shape. ``raw``: its samples hold ``.cdr``, the bytes on the
    wire with their four bytes of encapsulation, and are neither encoded nor decoded."""
    package, _, name = ros_name.split("/")
    fields = {field: _field_type(description) for field, description in STORE.fielddefs[ros_name][1]}

    def fill(namespace: dict) -> None:
        namespace["__annotations__"] = fields
        if raw:
            namespace["__init__"] = lambda self, cdr: setattr(self, "cdr", cdr)
            namespace["serialize"] = lambda self, **_: self.cdr
            namespace["deserialize_key"] = classmethod(lambda cls, data, **_: None)
            namespace["deserialize"] = classmethod(lambda cls, data, **_: cls(bytes(data)))

    kind = types.new_class(name, (IdlStruct,), {"typename": f"{package}::msg::dds_::{name}_"}, fill)
    return annotations.final(annotations.autoid("sequential")(kind))


def _field_type(description):
    node, detail = description
    if node == Nodetype.BASE:
        return _BASES.get(detail[0]) or getattr(idl, detail[0])
    if node == Nodetype.NAME:
        return dds_type(detail)
    element, size = detail
    return idl.array[_field_type(element), size] if node == Nodetype.ARRAY else idl.sequence[_field_type(element)]


def make(ros_name: str, *values):
    """A message of rosbags."""
    return STORE.types[ros_name](*values)


def encode(message) -> bytes:
    """CDR, with its four bytes of encapsulation."""
    return bytes(STORE.serialize_cdr(message, message.__msgtype__))


def decode(cdr: bytes, ros_name: str):
    """A message of rosbags."""
    return STORE.deserialize_cdr(cdr, ros_name)

"""DDS types made from the .msg definitions that rosbags carries, for a participant that shares no type with the
bridge's. Their samples hold ``.cdr``, the bytes on the wire with their four bytes of encapsulation, and are neither
encoded nor decoded by Cyclone DDS."""

from __future__ import annotations

import types

from cyclonedds.idl import IdlStruct, annotations
from cyclonedds.idl import types as idl
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Nodetype

_STORE = get_typestore(Stores.ROS2_HUMBLE)
_BASES = {"string": str, "bool": bool}  # the others are called as in cyclonedds.idl.types


def raw_type(ros_name: str) -> type[IdlStruct]:
    """``geometry_msgs/msg/Twist`` as a DDS type of that name and shape."""
    return _shape(
        ros_name,
        __init__=lambda self, cdr: setattr(self, "cdr", cdr),
        serialize=lambda self, **_: self.cdr,
        deserialize=classmethod(lambda cls, data, **_: cls(bytes(data))),
        deserialize_key=classmethod(lambda cls, data, **_: None),
    )


def _shape(ros_name: str, **methods) -> type[IdlStruct]:
    package, _, name = ros_name.split("/")
    fields = {field: _field_type(*description) for field, description in _STORE.fielddefs[ros_name][1]}
    kind = types.new_class(
        name,
        (IdlStruct,),
        {"typename": f"{package}::msg::dds_::{name}_"},
        lambda namespace: namespace.update(methods, __annotations__=fields),
    )
    return annotations.final(annotations.autoid("sequential")(kind))


def _field_type(node, detail):
    if node == Nodetype.BASE:
        return _BASES.get(detail[0]) or getattr(idl, detail[0])
    if node == Nodetype.NAME:
        return _shape(detail)
    element, size = detail
    return idl.array[_field_type(*element), size] if node == Nodetype.ARRAY else idl.sequence[_field_type(*element)]

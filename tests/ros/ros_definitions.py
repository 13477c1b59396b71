"""Messages made and encoded by rosbags, from the .msg definitions that it carries: an implementation of ROS 1's and
ROS 2's encodings that shares nothing with rospy, Cyclone DDS or the bridges."""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("rosbags", reason="the independent encoder of ROS messages: pip install rosbags")
from rosbags.typesys import Stores, get_typestore


class Definitions:
    """The messages of one distribution of ROS."""

    def __init__(self, store: Stores) -> None:
        self._ros1 = store == Stores.ROS1_NOETIC
        self._store = get_typestore(store)

    def make(self, ros_name: str, *values: Any) -> Any:
        """``make("geometry_msgs/msg/Vector3", 1.0, 2.0, 3.0)``."""
        return self._store.types[ros_name](*values)

    def fields(self, ros_name: str) -> dict[str, Any]:
        """(node, detail) of each field by its name, as rosbags describes them."""
        return dict(self._store.fielddefs[ros_name][1])

    def header(self, utime: int, frame_id: str) -> Any:
        """A std_msgs/Header; ``utime`` [us]."""
        stamp = self.make("builtin_interfaces/msg/Time", utime // 1_000_000, utime % 1_000_000 * 1000)
        return self.make("std_msgs/msg/Header", *([7] if self._ros1 else []), stamp, frame_id)

    def encode(self, message: Any) -> bytes:
        """As on the wire; of ROS 2 with the four bytes of encapsulation."""
        serialize = self._store.serialize_ros1 if self._ros1 else self._store.serialize_cdr
        return bytes(serialize(message, message.__msgtype__))

    def decode(self, data: bytes, ros_name: str) -> Any:
        """The message."""
        return (self._store.deserialize_ros1 if self._ros1 else self._store.deserialize_cdr)(data, ros_name)

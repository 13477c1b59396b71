"""The bridge's DDS types are ROS 2's: names, and every byte, compared with rosbags' encoding of the .msg definitions of
each distribution."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from ros_definitions import Definitions
from rosbags.typesys import Stores

from build_tree import ROOT

pytest.importorskip("cyclonedds", reason="pip install cyclonedds")


@pytest.fixture(scope="module")
def messages():
    """The example's module."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT / "examples" / "ros2")
        import messages

        yield messages
        del sys.modules["messages"]


NAMES = [
    "builtin_interfaces/msg/Time",
    "std_msgs/msg/Header",
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/PoseStamped",
    "nav_msgs/msg/Odometry",
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/CompressedImage",
    "diagnostic_msgs/msg/DiagnosticArray",
]
DISTRIBUTIONS = [Stores.ROS2_FOXY, Stores.ROS2_HUMBLE, Stores.ROS2_IRON, Stores.ROS2_JAZZY, Stores.ROS2_KILTED]


def drawn(definitions: Definitions, name, generator):
    """A message with random content, strings of every length modulo the alignment included."""
    return definitions.make(
        name, *(_value(definitions, *kind, generator) for kind in definitions.fields(name).values())
    )


def _value(definitions, node, detail, generator):
    kind = node.name
    if kind == "NAME":
        return drawn(definitions, detail, generator)
    if kind in ("SEQUENCE", "ARRAY"):
        (node, element), size = detail
        if kind == "SEQUENCE":
            size = int(generator.integers(0, 9))
        if node.name == "NAME" or element[0] == "string":
            return [_value(definitions, node, element, generator) for _ in range(size)]
        return generator.integers(0, 200, size).astype(element[0])
    if detail[0] == "string":
        return "aé€😀"[: int(generator.integers(0, 5))] * int(generator.integers(0, 4))
    if detail[0].startswith("float"):
        return float(generator.normal())
    return int(generator.integers(0, 100))


def ours(messages, definitions, theirs):
    """The same message, of the example's types."""
    if isinstance(theirs, list):
        return [ours(messages, definitions, each) for each in theirs]
    if isinstance(theirs, np.ndarray):
        return theirs.tolist()
    if not hasattr(theirs, "__msgtype__"):
        return theirs
    kind = getattr(messages, theirs.__msgtype__.split("/")[-1])
    names = definitions.fields(theirs.__msgtype__)
    return kind(**{name: ours(messages, definitions, getattr(theirs, name)) for name in names})


@pytest.mark.parametrize("name", NAMES)
def test_a_type_is_called_as_ros_2_calls_it(messages, name):
    package, _, short = name.split("/")
    assert getattr(messages, short).__idl_typename__.replace(".", "::") == f"{package}::msg::dds_::{short}_"


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
@pytest.mark.parametrize("name", NAMES)
def test_every_byte_is_as_ros_2_encodes_it(messages, name, distribution):
    definitions, generator = Definitions(distribution), np.random.default_rng(5)
    for _ in range(20):
        theirs = drawn(definitions, name, generator)
        mine, expected = ours(messages, definitions, theirs), definitions.encode(theirs)
        assert mine.serialize(use_version_2=False) == expected
        assert type(mine).deserialize(expected) == mine

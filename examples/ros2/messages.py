"""The ROS 2 messages that the bridge speaks, as DDS types: written after the .msg files of common_interfaces and
rcl_interfaces (builtin_interfaces). Names on the wire are ROS 2's: ``package::msg::dds_::Name_``; the encoding is plain
CDR of types that are final, in the order of the fields."""

from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct, annotations
from cyclonedds.idl.types import array, byte, float64, int32, sequence, uint8, uint32


def message(cls):
    """Final and numbered in order, as rosidl's types are; a dataclass, so that it has a constructor."""
    return dataclass(annotations.final(annotations.autoid("sequential")(cls)))


def nested(cls, **values):
    """A field's default: a message of its own for each instance."""
    return field(default_factory=lambda: cls(**values))


@message
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32 = 0
    nanosec: uint32 = 0


@message
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time = nested(Time)
    frame_id: str = ""


@message
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@message
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@message
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0
    w: float64 = 1.0


@message
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Point = nested(Point)
    orientation: Quaternion = nested(Quaternion)


@message
class PoseStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseStamped_"):
    header: Header = nested(Header)
    pose: Pose = nested(Pose)


@message
class PoseWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    pose: Pose = nested(Pose)
    covariance: array[float64, 36] = field(default_factory=lambda: [0.0] * 36)


@message
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3 = nested(Vector3)
    angular: Vector3 = nested(Vector3)


@message
class TwistStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TwistStamped_"):
    header: Header = nested(Header)
    twist: Twist = nested(Twist)


@message
class TwistWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::TwistWithCovariance_"):
    twist: Twist = nested(Twist)
    covariance: array[float64, 36] = field(default_factory=lambda: [0.0] * 36)


@message
class Odometry(IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
    header: Header = nested(Header)
    child_frame_id: str = ""
    pose: PoseWithCovariance = nested(PoseWithCovariance)
    twist: TwistWithCovariance = nested(TwistWithCovariance)


@message
class Image(IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    header: Header = nested(Header)
    height: uint32 = 0
    width: uint32 = 0
    encoding: str = ""
    is_bigendian: uint8 = 0
    step: uint32 = 0
    data: sequence[uint8] = field(default_factory=list)


@message
class CompressedImage(IdlStruct, typename="sensor_msgs::msg::dds_::CompressedImage_"):
    header: Header = nested(Header)
    format: str = ""
    data: sequence[uint8] = field(default_factory=list)


@message
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str = ""
    value: str = ""


@message
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: byte = 0
    name: str = ""
    message: str = ""
    hardware_id: str = ""
    values: sequence[KeyValue] = field(default_factory=list)


@message
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header = nested(Header)
    status: sequence[DiagnosticStatus] = field(default_factory=list)

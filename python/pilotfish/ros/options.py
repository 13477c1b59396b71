"""The options that the bridges to ROS 1 and ROS 2 share (for Typer), and what is wrong with a choice of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.options import between


def _topic(name: str) -> str:
    parts = name.removeprefix("/").split("/")
    if name and not all(part.isidentifier() and part.isascii() for part in parts):
        raise typer.BadParameter(
            f"{name!r} is no topic: letters, digits and underscores, separated by /: /base/cmd_vel"
        )
    return name


def _given_topic(name: str) -> str:
    if not name:
        raise typer.BadParameter("an empty text is no topic")
    return _topic(name)


RobotArgument = Annotated[str, typer.Argument(help="The robot's name on LCM, e.g. robot1.")]
UrlOption = Annotated[str, typer.Option(help="LCM bus. Default: $LCM_DEFAULT_URL, else this host alone.")]
KeyOption = Annotated[Path | None, typer.Option(dir_okay=False, help="The robot's key_file, if it has one.")]
FrameOption = Annotated[str, typer.Option(help="frame_id of the robot's base.")]

CommandTopicOption = Annotated[str, typer.Option(callback=_given_topic, help="Where the commands go.")]
StampedOption = Annotated[bool, typer.Option(help="geometry_msgs/TwistStamped, or Twist.")]
ZeroStampOption = Annotated[bool, typer.Option("--zero-stamp", help="Stamp with 0: for robots on simulated time.")]
RateOption = Annotated[
    float, typer.Option(callback=between(20.0, 200.0, "Hz"), help="Messages a second, 20 to 200; zeros, too.")
]

OdometryTopicOption = Annotated[str, typer.Option(callback=_topic, help="nav_msgs/Odometry, to NAME_POSE.")]
ImageTopicOption = Annotated[
    str, typer.Option(callback=_topic, help="sensor_msgs/Image (mono8, rgb8, bgr8), to NAME_IMAGE.")
]
CompressedTopicOption = Annotated[
    str, typer.Option(callback=_topic, help="sensor_msgs/CompressedImage (JPEG), to NAME_IMAGE.")
]

DiagnosticsTopicOption = Annotated[
    str, typer.Option(callback=_given_topic, help="diagnostic_msgs/DiagnosticArray of the status.")
]
LeaderTopicOption = Annotated[str, typer.Option(callback=_given_topic, help="geometry_msgs/PoseStamped of the leader.")]


def check_sensor_topics(odom: str, image: str, compressed: str) -> None:
    """A usage error unless there is something to bridge, and one camera at most: both would go to NAME_IMAGE."""
    if not (odom or image or compressed) or (image and compressed):
        raise typer.BadParameter("give --odom, or one of --image and --compressed, or --odom and one of them")

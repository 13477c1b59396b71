"""The robot's odometry and camera: from ROS 2 to a coordinator."""

import messages as msg
from ros_wire import DomainOption, join, utime_of

from pilotfish import ros
from pilotfish.cli.console import friendly_errors, warn
from pilotfish.ros import options


def sensors(
    robot: options.RobotArgument,
    odom: options.OdometryTopicOption = "",
    image: options.ImageTopicOption = "",
    compressed: options.CompressedTopicOption = "",
    lcm_url: options.UrlOption = "",
    domain: DomainOption = None,
) -> None:
    """Give a coordinator the robot's odometry and camera.

    Its configuration: `odometry: pose`, and `source: lcm`.
    """
    with friendly_errors():
        options.check_sensor_topics(odom, image, compressed)
        inlet, participant, stop = ros.SensorInlet(robot, lcm_url, warn), join(domain), ros.stop_on_signals()
        for topic, kind, take in (
            (odom, msg.Odometry, inlet.odometry),
            (image, msg.Image, inlet.image),
            (compressed, msg.CompressedImage, inlet.compressed),
        ):
            if topic:
                participant.on_message(
                    topic, kind, lambda message, take=take: take(message, utime_of(message.header.stamp))
                )
        while not stop.is_set():
            participant.handle(timeout_ms=100)

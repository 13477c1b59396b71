"""The robot's odometry and camera: from ROS 1 to a coordinator."""

import time

import rospy
from nav_msgs.msg import Odometry
from node import join, utime_of
from sensor_msgs.msg import CompressedImage, Image

from pilotfish import ros
from pilotfish.cli.console import friendly_errors, warn
from pilotfish.ros import options

PICTURE_BUFFER_BYTES = 2**24  # the default holds no picture, and old ones would wait in the socket


def sensors(
    robot: options.RobotArgument,
    odom: options.OdometryTopicOption = "",
    image: options.ImageTopicOption = "",
    compressed: options.CompressedTopicOption = "",
    lcm_url: options.UrlOption = "",
) -> None:
    """Give a coordinator the robot's odometry and camera.

    Its configuration: `odometry: pose`, and `source: lcm`.
    """
    with friendly_errors():
        options.check_sensor_topics(odom, image, compressed)
        inlet, stop = ros.SensorInlet(robot, lcm_url, warn), join("sensors")
        for topic, kind, take in (
            (odom, Odometry, inlet.odometry),
            (image, Image, inlet.image),
            (compressed, CompressedImage, inlet.compressed),
        ):
            if topic:
                rospy.Subscriber(
                    topic,
                    kind,
                    lambda message, take=take: take(message, utime_of(message.header.stamp)),
                    queue_size=1,
                    buff_size=PICTURE_BUFFER_BYTES,
                    tcp_nodelay=True,
                )
        while not stop.is_set():
            time.sleep(0.1)  # rospy's threads do the work

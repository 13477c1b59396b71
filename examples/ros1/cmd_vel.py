"""What the wheels are to do: from pilotfish-base to /cmd_vel."""

import time

import rospy
import typer
from geometry_msgs.msg import Twist, TwistStamped
from node import join, time_of

from pilotfish import ros
from pilotfish.cli.console import friendly_errors, warn
from pilotfish.ros import options


def cmd_vel(
    robot: options.RobotArgument,
    topic: options.CommandTopicOption = "/cmd_vel",
    stamped: options.StampedOption = False,
    zero_stamp: options.ZeroStampOption = False,
    frame: options.FrameOption = "base_link",
    rate_hz: options.RateOption = 50.0,
    key: options.KeyOption = None,
    lcm_url: options.UrlOption = "",
) -> None:
    """Drive a ROS 1 robot: what pilotfish-base commands, on /cmd_vel.

    Run `pilotfish-base --config base.yaml --driver dry_run` on the same computer: it checks and limits the
    coordinator's commands. /cmd_vel is zero 95 ms after the last good command or message of pilotfish-base, when
    the measurement expires, and when this ends; zeros are published for as long as it runs.

    Set the timeout of the robot's own driver, too (cmd_vel_timeout of diff_drive_controller): it is what stops the
    wheels when this process is killed.
    """
    with friendly_errors():
        link = ros.open_link(robot, lcm_url, key)
        if not ros.request_real_time():
            warn("no real-time priority (ulimit -r): a busy computer may delay a stop")
        stop = join("cmd_vel")
        # A queue of one: a stuck subscriber blocks nobody, and old commands wait nowhere.
        publisher = rospy.Publisher(topic, TwistStamped if stamped else Twist, queue_size=1, tcp_nodelay=True)

        def publish(command: ros.GatedCommand) -> None:
            message = TwistStamped()
            message.header.frame_id = frame
            if not zero_stamp:
                message.header.stamp = time_of(command.utime or time.time_ns() // 1000)
            message.twist.linear.x, message.twist.angular.z = command.twist.linear_mps, command.twist.angular_radps
            publisher.publish(message if stamped else message.twist)

        ros.forward_commands(
            link,
            robot,
            publish,
            stop=stop,
            rate_hz=rate_hz,
            on_reason=lambda reason: typer.echo(f"zero: {reason}" if reason else "driving", err=True),
        )
        time.sleep(0.1)  # rospy sends in the background, and does not say when it has

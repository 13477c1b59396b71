"""What the wheels are to do: from pilotfish-base to /cmd_vel."""

import time

import messages as msg
import typer
from cyclonedds.util import duration
from ros_wire import DomainOption, join, stamp

from pilotfish import ros
from pilotfish.cli.console import friendly_errors, warn
from pilotfish.ros import options


def cmd_vel(
    robot: options.RobotArgument,
    topic: options.CommandTopicOption = "/cmd_vel",
    stamped: options.StampedOption = True,
    zero_stamp: options.ZeroStampOption = False,
    frame: options.FrameOption = "base_link",
    rate_hz: options.RateOption = 50.0,
    key: options.KeyOption = None,
    lcm_url: options.UrlOption = "",
    domain: DomainOption = None,
) -> None:
    """Drive a ROS 2 robot: what pilotfish-base commands, on /cmd_vel.

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
        # A history of one: a stuck subscriber blocks nobody, and old commands wait nowhere.
        writer = join(domain).writer(topic, msg.TwistStamped if stamped else msg.Twist, depth=1)

        def publish(command: ros.GatedCommand) -> None:
            twist = msg.Twist(msg.Vector3(x=command.twist.linear_mps), msg.Vector3(z=command.twist.angular_radps))
            when = 0 if zero_stamp else command.utime or time.time_ns() // 1000
            writer.write(msg.TwistStamped(msg.Header(stamp(when), frame), twist) if stamped else twist)

        ros.forward_commands(
            link,
            robot,
            publish,
            stop=ros.stop_on_signals(),
            rate_hz=rate_hz,
            on_reason=lambda reason: typer.echo(f"zero: {reason}" if reason else "driving", err=True),
        )
        writer.wait_for_acks(duration(milliseconds=200))

"""A node of a ROS 1 graph, and its times."""

import threading

import rosgraph
import rospy

from pilotfish import ros
from pilotfish.errors import ConfigError, SilentRobotError


def join(duty: str) -> threading.Event:
    """Makes this process a node; the event is set when it is to end: by a signal, or by `rosnode kill`."""
    try:
        online = rosgraph.is_master_online()
    except ValueError as error:
        raise ConfigError(f"ROS_MASTER_URI: {error}; it is as http://localhost:11311") from error
    if not online:
        raise SilentRobotError(f"no ROS master at {rosgraph.get_master_uri()}: start roscore, or set ROS_MASTER_URI")
    rospy.init_node(f"pilotfish_{duty}", anonymous=True, disable_signals=True)
    stop = ros.stop_on_signals()
    rospy.on_shutdown(stop.set)
    return stop


def time_of(utime: int) -> rospy.Time:
    """Microseconds as ROS's time."""
    return rospy.Time(secs=utime // 1_000_000, nsecs=utime % 1_000_000 * 1000)


def utime_of(stamp: rospy.Time) -> int:
    """ROS's time in microseconds; what is below one is cut off."""
    return stamp.secs * 1_000_000 + stamp.nsecs // 1000

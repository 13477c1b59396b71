"""What a coordinator does and sees: from Pilotfish to ROS 1."""

import time

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped
from node import join, time_of

from pilotfish import ros
from pilotfish.cli.console import friendly_errors
from pilotfish.ros import options


def report(
    robot: options.RobotArgument,
    diagnostics: options.DiagnosticsTopicOption = "/diagnostics",
    leader: options.LeaderTopicOption = "/leader_pose",
    frame: options.FrameOption = "base_link",
    lcm_url: options.UrlOption = "",
) -> None:
    """Show ROS 1 what a coordinator does: its status as diagnostics, the leader's pose in every picture."""
    with friendly_errors():
        stop = join("report")
        statuses = rospy.Publisher(diagnostics, DiagnosticArray, queue_size=10)
        poses = rospy.Publisher(leader, PoseStamped, queue_size=10)

        def on_diagnosis(found: ros.Diagnosis) -> None:
            values = [KeyValue(key, value) for key, value in found.values]
            status = DiagnosticStatus(found.level, f"pilotfish: {robot}", found.message, robot, values)
            message = DiagnosticArray(status=[status])
            message.header.stamp = time_of(time.time_ns() // 1000)
            statuses.publish(message)

        def on_leader(seen: ros.LeaderPose) -> None:
            message = PoseStamped()
            message.header.stamp, message.header.frame_id = time_of(seen.utime), frame
            message.pose.position.x, message.pose.position.y = seen.x_m, seen.y_m
            message.pose.orientation.z, message.pose.orientation.w = seen.orientation_z, seen.orientation_w
            poses.publish(message)

        outlet = ros.ReportOutlet(robot, lcm_url, on_diagnosis, on_leader)
        while not stop.is_set():
            outlet.handle(timeout_ms=100)

"""What a coordinator does and sees: from Pilotfish to ROS 2."""

import time

import messages as msg
from ros_wire import DomainOption, join, stamp

from pilotfish import ros
from pilotfish.cli.console import friendly_errors
from pilotfish.ros import options


def report(
    robot: options.RobotArgument,
    diagnostics: options.DiagnosticsTopicOption = "/diagnostics",
    leader: options.LeaderTopicOption = "/leader_pose",
    frame: options.FrameOption = "base_link",
    lcm_url: options.UrlOption = "",
    domain: DomainOption = None,
) -> None:
    """Show ROS 2 what a coordinator does: its status as diagnostics, the leader's pose in every picture."""
    with friendly_errors():
        participant, stop = join(domain), ros.stop_on_signals()
        statuses = participant.writer(diagnostics, msg.DiagnosticArray)
        poses = participant.writer(leader, msg.PoseStamped)

        def on_diagnosis(found: ros.Diagnosis) -> None:
            values = [msg.KeyValue(key, value) for key, value in found.values]
            status = msg.DiagnosticStatus(found.level, f"pilotfish: {robot}", found.message, robot, values)
            statuses.write(msg.DiagnosticArray(msg.Header(stamp(time.time_ns() // 1000)), [status]))

        def on_leader(seen: ros.LeaderPose) -> None:
            turned = msg.Quaternion(z=seen.orientation_z, w=seen.orientation_w)
            pose = msg.Pose(msg.Point(seen.x_m, seen.y_m), turned)
            poses.write(msg.PoseStamped(msg.Header(stamp(seen.utime), frame), pose))

        outlet = ros.ReportOutlet(robot, lcm_url, on_diagnosis, on_leader)
        while not stop.is_set():
            outlet.handle(timeout_ms=100)

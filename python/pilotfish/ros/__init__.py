"""What a bridge between Pilotfish's LCM and ROS needs and what is the same for ROS 1 and ROS 2; the bridges themselves
are ``examples/ros1`` and ``examples/ros2``. Needs neither: messages are plain objects with ROS's field names."""

from pilotfish.ros.command_gate import CommandGate, GatedCommand
from pilotfish.ros.conversions import LeaderPose, leader_pose, pose_from_odometry
from pilotfish.ros.diagnosis import Diagnosis, diagnose, silent
from pilotfish.ros.forward import forward_commands, open_link, request_real_time, stop_on_signals
from pilotfish.ros.pictures import PictureError, buffer_warning, picture_from_compressed, picture_from_image
from pilotfish.ros.report_outlet import ReportOutlet
from pilotfish.ros.sensor_inlet import SensorInlet

__all__ = [
    "CommandGate",
    "Diagnosis",
    "GatedCommand",
    "LeaderPose",
    "PictureError",
    "ReportOutlet",
    "SensorInlet",
    "buffer_warning",
    "diagnose",
    "forward_commands",
    "leader_pose",
    "open_link",
    "picture_from_compressed",
    "picture_from_image",
    "pose_from_odometry",
    "request_real_time",
    "silent",
    "stop_on_signals",
]

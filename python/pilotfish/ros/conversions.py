"""Positions and motions: nav_msgs/Odometry in, geometry_msgs/PoseStamped of the leader out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from pilotfish.lcmtypes.bot_core.pose_t import pose_t
from pilotfish.lcmtypes.pilotfish.observation_t import observation_t

_UNIT_TOLERANCE = 0.01  # of a quaternion's norm; what a filter in single precision leaves is far smaller


def pose_from_odometry(odometry: Any, utime: int) -> pose_t:
    """``bot_core.pose_t`` [m, rad, s] of a nav_msgs/Odometry, stamped ``utime`` [us].

    Odometry has its pose in ``header.frame_id`` (the local frame) and its twist in ``child_frame_id`` (the body's);
    pose_t has both in the local frame. With R from body to local, vel = R linear and rotation_rate = R angular.
    Raises ValueError if the orientation is no unit quaternion: Pilotfish would refuse it.
    """
    position, q = odometry.pose.pose.position, odometry.pose.pose.orientation
    norm = math.sqrt(q.w**2 + q.x**2 + q.y**2 + q.z**2)
    if not abs(norm - 1.0) < _UNIT_TOLERANCE:
        raise ValueError(f"pose.pose.orientation: a quaternion of norm {norm:.3g}; it must be 1")
    body_to_local = _rotation(q.w / norm, q.x / norm, q.y / norm, q.z / norm)
    linear, angular = odometry.twist.twist.linear, odometry.twist.twist.angular
    message = pose_t()
    message.utime = utime
    message.pos = [position.x, position.y, position.z]
    message.vel = (body_to_local @ [linear.x, linear.y, linear.z]).tolist()
    message.orientation = [q.w / norm, q.x / norm, q.y / norm, q.z / norm]
    message.rotation_rate = (body_to_local @ [angular.x, angular.y, angular.z]).tolist()
    return message


def _rotation(w: float, x: float, y: float, z: float) -> np.ndarray:
    """3x3 of a unit quaternion."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@dataclass(frozen=True)
class LeaderPose:
    """The leader's base in the follower's base frame (x forward, y left): z, roll and pitch are not measured, 0."""

    utime: int
    """Exposure of the picture [us]."""
    x_m: float
    y_m: float
    orientation_z: float
    """Of the quaternion (0, 0, z, w)."""
    orientation_w: float


def leader_pose(observation: observation_t) -> LeaderPose | None:
    """From distance d, bearing theta and heading psi: (d cos theta, d sin theta), turned by psi about z. None if the
    leader was not measured in this picture."""
    measured = (observation.distance_m, observation.bearing_rad, observation.heading_rad)
    if not observation.detected or not all(map(math.isfinite, measured)):
        return None
    half_rad = 0.5 * observation.heading_rad
    return LeaderPose(
        observation.utime,
        observation.distance_m * math.cos(observation.bearing_rad),
        observation.distance_m * math.sin(observation.bearing_rad),
        math.sin(half_rad),
        math.cos(half_rad),
    )

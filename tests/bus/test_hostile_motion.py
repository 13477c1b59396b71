"""Odometry and leader intents that must not get past the edge."""

import math

import pytest
from edge import valid_motion, valid_pose

from pilotfish import bus, core


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"vel": [math.nan, 0.0, 0.0]}, "pose_not_finite"),
        ({"orientation": [math.inf, 0.0, 0.0, 0.0]}, "pose_not_finite"),
        ({"rotation_rate": [0.0, 0.0, -math.inf]}, "pose_not_finite"),
        ({"orientation": [0.0, 0.0, 0.0, 0.0]}, "pose_not_a_rotation"),
        ({"orientation": [1e200, 0.0, 0.0, 0.0]}, "pose_not_a_rotation"),
        ({"orientation": [1.0, 0.0, 0.0, 0.2]}, "pose_not_a_rotation"),
        ({"vel": [0.0, 10.1, 0.0]}, "pose_out_of_bounds"),
        ({"rotation_rate": [0.0, 0.0, 50.1]}, "pose_out_of_bounds"),
        ({"utime": -1}, "pose_time_invalid"),
        ({"utime": 2**63 - 1}, "pose_time_invalid"),
    ],
)
def test_odometry_that_makes_no_twist_is_refused(edge, changes, kind):
    assert edge.refuses("R1_POSE", valid_pose(**changes).encode()) == kind


def test_where_odometry_says_that_the_robot_is_does_not_matter(edge):
    lost = valid_pose(pos=[math.nan, 1e300, 0.0], accel=[math.inf, 0.0, 0.0])
    assert edge.accepts("R1_POSE", lost.encode()).twist == core.Twist(linear_mps=0.2)


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"linear_mps": math.nan}, "motion_not_finite"),
        ({"angular_radps": math.inf}, "motion_not_finite"),
        ({"linear_mps": -10.1}, "motion_out_of_bounds"),
        ({"angular_radps": 50.1}, "motion_out_of_bounds"),
        ({"utime": -1}, "motion_time_invalid"),
        ({"utime": 2**62 + 2**61}, "motion_time_invalid"),
    ],
)
def test_an_announcement_that_no_robot_could_mean_is_refused(edge, changes, kind):
    assert edge.refuses("R1_MOTION", valid_motion(**changes).encode()) == kind


def test_a_motion_that_is_not_a_number_is_not_sent_but_counted(link):
    link.bus.publish_motion("r1", bus.MotionReport(utime=1, twist=core.Twist(linear_mps=math.nan)))
    assert link.bus.rejected == {"motion_not_finite": 1}

"""Angles, frames of reference and what d, theta and psi mean."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import core


@settings(derandomize=True)
@given(st.floats(-50.0, 50.0))
def test_a_wrapped_angle_is_the_same_angle_within_half_a_turn(angle_rad):
    wrapped = core.wrap_angle(angle_rad)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle_rad), abs=1e-12)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle_rad), abs=1e-12)


def test_half_a_turn_wraps_to_plus_pi():
    assert core.wrap_angle(-math.pi) == math.pi
    assert core.wrap_angle(3 * math.pi) == pytest.approx(math.pi)


def test_a_camera_that_looks_ahead_sees_forward_as_z_left_as_minus_x_and_up_as_minus_y():
    rotation = core.CameraMounting().bMc[:3, :3]
    assert np.allclose(rotation @ [0, 0, 1], [1, 0, 0])
    assert np.allclose(rotation @ [-1, 0, 0], [0, 1, 0])
    assert np.allclose(rotation @ [0, -1, 0], [0, 0, 1])


def test_pan_looks_left_tilt_looks_up_and_roll_turns_clockwise_seen_from_behind():
    a = math.radians(30)
    forward, right = np.array([0, 0, 1]), np.array([1, 0, 0])
    pan = core.CameraMounting(pan_rad=a).bMc[:3, :3] @ forward
    assert np.allclose(pan, [math.cos(a), math.sin(a), 0])  # left is +y
    tilt = core.CameraMounting(tilt_rad=a).bMc[:3, :3] @ forward
    assert np.allclose(tilt, [math.cos(a), 0, math.sin(a)])  # up is +z
    roll = core.CameraMounting(roll_rad=a).bMc[:3, :3] @ right
    assert np.allclose(roll, [0, -math.cos(a), -math.sin(a)])  # clockwise: the right side goes down


def test_a_rear_tag_is_read_by_whoever_drives_behind():
    """The tag's x (right, as read) is the follower's right, -y in the leader's base; z goes into the wall, forward."""
    tag = core.BodyTag(id=0, size_m=0.2, position_m=[-0.15, 0.0, 0.3], facing_rad=math.pi)
    rotation = tag.oMt[:3, :3]
    assert np.allclose(rotation @ [1, 0, 0], [0, -1, 0])
    assert np.allclose(rotation @ [0, 1, 0], [0, 0, -1])
    assert np.allclose(rotation @ [0, 0, 1], [1, 0, 0])
    # Bottom left, bottom right, top right, top left, half a side of 0.2 m away from the centre.
    expected = [[-0.15, 0.1, 0.2], [-0.15, -0.1, 0.2], [-0.15, -0.1, 0.4], [-0.15, 0.1, 0.4]]
    assert np.allclose(tag.corners_m, expected)


def test_a_tag_that_looks_left_faces_plus_y():
    tag = core.BodyTag(id=0, size_m=0.2, position_m=[0, 0.1, 0], facing_rad=math.pi / 2)
    outward = -tag.oMt[:3, 2]
    assert np.allclose(outward, [0, 1, 0])


def test_a_tilted_tag_looks_up():
    tag = core.BodyTag(id=0, size_m=0.2, position_m=[0, 0, 0], facing_rad=math.pi, tilt_rad=math.radians(20))
    outward = -tag.oMt[:3, 2]
    assert np.allclose(outward, [-math.cos(math.radians(20)), 0, math.sin(math.radians(20))])


@settings(derandomize=True)
@given(st.floats(0.2, 5.0), st.floats(-3.1, 3.1), st.floats(-3.1, 3.1), st.floats(-0.5, 0.5))
def test_distance_bearing_and_heading_ignore_the_height(distance_m, bearing_rad, heading_rad, height_m):
    pose = np.eye(4)
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    pose[:3, :3] = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    pose[:3, 3] = [distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad), height_m]
    measured = core.relative_pose(bMo=pose)
    assert measured == pytest.approx((distance_m, bearing_rad, heading_rad), abs=1e-9)


@pytest.mark.parametrize("wrong", [np.eye(3), np.zeros((4, 4)), np.full((4, 4), np.nan), np.diag([1, 1, -1, 1])])
def test_something_that_is_not_a_pose_is_a_value_error(wrong):
    with pytest.raises(ValueError, match=r"pose|shape|rotation"):
        core.relative_pose(bMo=wrong)


def test_a_body_with_one_id_twice_is_refused_by_name():
    tag = core.BodyTag(id=3, size_m=0.1, position_m=[0, 0, 0])
    with pytest.raises(ValueError, match=r"leader\.tags\[1\]\.id: 3 is used twice"):
        core.LeaderBody([tag, tag])


def test_a_parameter_out_of_range_is_refused_with_its_value_and_range():
    with pytest.raises(ValueError, match=r"size_m: -1 is outside \[0\.005, 5\]"):
        core.BodyTag(size_m=-1.0)


def test_an_unknown_parameter_is_refused_by_name():
    with pytest.raises(TypeError, match=r"BodyTag has no parameter 'size_cm'; it has: .*position_m, roll_rad, size_m"):
        core.BodyTag(size_cm=16)

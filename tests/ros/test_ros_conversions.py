"""ROS's messages and Pilotfish's: the same motion, the same pixels. Needs no ROS: only the field names count."""

from __future__ import annotations

import io
import math
from types import SimpleNamespace as Message

import numpy as np
import pytest
from PIL import Image

from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.counter_t import counter_t
from pilotfish.lcmtypes.pilotfish.observation_t import observation_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t
from pilotfish.ros import (
    PictureError,
    buffer_warning,
    diagnose,
    leader_pose,
    picture_from_compressed,
    picture_from_image,
    pose_from_odometry,
)


def vector(x, y, z):
    return Message(x=x, y=y, z=z)


def odometry(q, position=(0, 0, 0), linear=(0, 0, 0), angular=(0, 0, 0)):
    w, x, y, z = q
    pose = Message(position=vector(*position), orientation=Message(w=w, x=x, y=y, z=z))
    return Message(
        pose=Message(pose=pose), twist=Message(twist=Message(linear=vector(*linear), angular=vector(*angular)))
    )


def product(p, q):
    """Hamilton's, of quaternions (w, x, y, z)."""
    (a, b, c, d), (e, f, g, h) = p, q
    return np.array(
        [
            a * e - b * f - c * g - d * h,
            a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e,
        ]
    )


def test_odometry_that_drives_ahead_and_looks_to_the_left_moves_to_the_left():
    # Turned by 90 degrees to the left, forward is the local frame's y.
    pose = pose_from_odometry(odometry((math.sqrt(0.5), 0, 0, math.sqrt(0.5)), (1, 2, 3), (0.5, 0, 0), (0, 0, 0.25)), 7)
    assert pose.utime == 7
    assert pose.pos == [1, 2, 3]
    assert pose.vel == pytest.approx([0, 0.5, 0])
    assert pose.rotation_rate == pytest.approx([0, 0, 0.25])


def test_velocities_are_turned_as_the_quaternion_says():
    generator = np.random.default_rng(3)
    for _ in range(200):
        q = generator.normal(size=4)
        q /= np.linalg.norm(q)
        linear, angular = generator.normal(size=(2, 3))
        pose = pose_from_odometry(odometry(q, linear=linear, angular=angular), 1)
        for turned, given in ((pose.vel, linear), (pose.rotation_rate, angular)):
            # q (0, v) q*: the definition, where the code uses the matrix
            expected = product(product(q, [0, *given]), q * [1, -1, -1, -1])[1:]
            assert turned == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("q", [(0, 0, 0, 0), (2, 0, 0, 0), (math.nan, 0, 0, 1)])
def test_an_orientation_that_is_no_rotation_is_refused_by_name(q):
    with pytest.raises(ValueError, match=r"pose\.pose\.orientation"):
        pose_from_odometry(odometry(q), 1)


def picture(encoding, width, height, step, data):
    return Message(encoding=encoding, width=width, height=height, step=step, data=data)


@pytest.mark.parametrize(
    ("encoding", "pixel_format", "channels"),
    [
        ("mono8", image_t.PIXEL_FORMAT_GRAY, 1),
        ("8UC1", image_t.PIXEL_FORMAT_GRAY, 1),
        ("rgb8", image_t.PIXEL_FORMAT_RGB, 3),
        ("bgr8", image_t.PIXEL_FORMAT_BGR, 3),
    ],
)
def test_a_picture_keeps_its_bytes_padding_included(encoding, pixel_format, channels):
    step = 5 * channels + 2
    data = np.random.default_rng(1).bytes(step * 4)
    out = picture_from_image(picture(encoding, 5, 4, step, data), 9)
    assert (out.utime, out.width, out.height, out.row_stride) == (9, 5, 4, step)
    assert (out.pixelformat, out.size, out.data) == (pixel_format, len(data), data)
    assert image_t.decode(out.encode()).data == data


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (picture("16UC1", 5, 4, 10, bytes(40)), "mono8, 8UC1, rgb8, bgr8"),
        (picture("rgb8", 5, 4, 14, bytes(56)), "step 14: a row of 5 px needs 15 bytes"),
        (picture("mono8", 5, 4, 5, bytes(19)), "19 bytes: 4 rows of 5 are 20"),
        (picture("mono8", 0, 4, 5, bytes(20)), "0x4 px"),
        (picture("mono8", 40000, 1, 40000, bytes(40000)), "40000x1 px"),
    ],
)
def test_a_picture_that_cannot_be_is_refused_with_what_is_allowed(wrong, says):
    with pytest.raises(PictureError, match=says):
        picture_from_image(wrong, 1)


def jpeg(width, height, **options):
    file = io.BytesIO()
    Image.new("RGB", (width, height), (10, 20, 30)).save(file, "JPEG", **options)
    return file.getvalue()


@pytest.mark.parametrize("options", [{}, {"progressive": True}, {"comment": b"c" * 300}])
@pytest.mark.parametrize("size", [(1, 1), (640, 480), (333, 77)])
def test_a_jpeg_keeps_its_bytes_and_says_its_size(size, options):
    data = jpeg(*size, **options)
    out = picture_from_compressed(Message(format="jpeg", data=data), 9)
    assert (out.width, out.height, out.pixelformat, out.data) == (*size, image_t.PIXEL_FORMAT_MJPEG, data)


def test_a_huffman_table_before_the_frame_header_is_no_frame_header():
    whole = jpeg(64, 48)
    table = b"\xff\xc4\x00\x0b" + bytes(9)
    assert picture_from_compressed(Message(format="jpeg", data=whole[:2] + table + whole[2:]), 1).width == 64


def test_what_is_no_jpeg_or_cut_off_is_refused():
    whole = jpeg(64, 48)
    for length in range(len(whole)):
        try:
            out = picture_from_compressed(Message(format="png", data=whole[:length]), 1)
        except PictureError:
            continue
        assert (out.width, out.height) == (64, 48), "the frame header had come by then"
    with pytest.raises(PictureError, match="format 'png'"):
        picture_from_compressed(Message(format="png", data=b"\x89PNG...."), 1)


def test_large_pictures_are_warned_of_where_the_kernel_grants_too_little():
    large = picture_from_image(picture("mono8", 640, 480, 640, bytes(640 * 480)), 1)
    small = picture_from_image(picture("mono8", 64, 48, 64, bytes(64 * 48)), 1)
    assert "sysctl" in buffer_warning(large, 212_992)
    assert buffer_warning(large, 4_194_304) == ""
    assert buffer_warning(small, 212_992) == ""


def observed(distance_m, bearing_rad, heading_rad, detected=True):
    message = observation_t()
    message.utime, message.detected = 5, detected
    message.distance_m, message.bearing_rad, message.heading_rad = distance_m, bearing_rad, heading_rad
    return message


def test_a_leader_on_the_left_has_a_positive_y():
    # 2 m away, 30 degrees to the left: (2 cos 30, 2 sin 30) = (sqrt 3, 1); turned by 90 degrees: half-angle 45 degrees
    pose = leader_pose(observed(2.0, math.radians(30), math.radians(90)))
    assert (pose.utime, pose.x_m, pose.y_m) == (5, pytest.approx(math.sqrt(3)), pytest.approx(1.0))
    assert (pose.orientation_z, pose.orientation_w) == (pytest.approx(math.sqrt(0.5)), pytest.approx(math.sqrt(0.5)))


@pytest.mark.parametrize(
    "nothing", [observed(0, 0, 0, detected=False), observed(math.nan, 0, 0), observed(1, math.inf, 0)]
)
def test_without_a_measurement_there_is_no_pose(nothing):
    assert leader_pose(nothing) is None


@pytest.mark.parametrize(
    ("status", "level"),
    [
        (command_t.STATUS_TRACKING, 0),
        (command_t.STATUS_STOPPED, 0),
        (command_t.STATUS_SEARCHING, 1),
        (command_t.STATUS_COASTING, 1),
        (command_t.STATUS_LOST, 2),
        (command_t.STATUS_INVALID_INPUT, 2),
        (99, 2),
    ],
)
def test_a_status_has_the_level_of_what_it_says_and_its_numbers(status, level):
    message = status_t()
    message.status, message.text, message.error_m = status, "as it is", -0.0125
    counter = counter_t()
    counter.name, counter.count = "frames_stale", 3
    message.rejected_count, message.rejected = 1, [counter]
    found = diagnose(message)
    assert (found.level, found.message) == (level, "as it is")
    assert {"error_m": "-0.0125", "rejected.frames_stale": "3"}.items() <= dict(found.values).items()

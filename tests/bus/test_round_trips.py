"""Every type between our C++ Bus and PyPI's lcm, over real multicast."""

import itertools
import threading

import numpy as np
import pytest
from bus_link import Link
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bench.common import wire
from pilotfish import bus, core
from pilotfish.lcmtypes.bot_core import image_t, pose_t
from pilotfish.lcmtypes.pilotfish import command_t, motion_t, observation_t, setpoint_t, status_t

_channel_numbers = itertools.count()


def textured(height, width, seed=1):
    return np.random.default_rng(seed).integers(0, 256, (height, width), dtype=np.uint8)


def smooth(height, width):
    v, u = np.mgrid[0:height, 0:width]
    return (128 + 60 * np.sin(u / 9) + 60 * np.cos(v / 7)).astype(np.uint8)


def setpoint_report(**setpoint):
    return bus.SetpointReport(utime=1, setpoint=core.Setpoint(**setpoint))


def test_a_command_goes_out_as_it_is(link):
    report = bus.CommandReport(
        utime=1_700_000_000_123_456,
        session=2**62 + 1,
        counter=41,
        base_session=7,
        valid_until_us=2**61 + 3,
        simulated=True,
        command=core.Twist(linear_mps=0.25, angular_radps=-1.5),
        status=core.Status.lost,
        reason=core.Reason.no_tag_found,
    )
    command = command_t.decode(link.catch("ROBOT1_COMMAND", lambda: link.bus.publish_command("robot1", report)))
    assert (command.utime, command.counter) == (1_700_000_000_123_456, 41)
    assert (command.session, command.base_session, command.simulated) == (2**62 + 1, 7, True)
    assert command.valid_until_us == 2**61 + 3
    assert command.mac == bytes(32)  # no key
    assert (command.linear_mps, command.angular_radps) == (0.25, -1.5)
    assert (command.status, command.text) == (command_t.STATUS_LOST, "lost: no tag in the picture")


def test_a_command_comes_in_as_it_is(link):
    received = []
    link.bus.on_command("robot1", received.append)
    message = command_t()
    message.utime, message.session, message.counter, message.base_session = 77, 2**62 + 1, 5, 9
    message.simulated, message.valid_until_us = True, -(2**61)
    message.linear_mps, message.angular_radps = -0.125, 2.0
    message.status, message.reason = command_t.STATUS_COASTING, int(core.Reason.tag_refused)
    message.text, message.mac = "any words", bytes(32)
    link.send("ROBOT1_COMMAND", message.encode())
    (report,) = received
    assert (report.utime, report.session, report.counter, report.base_session) == (77, 2**62 + 1, 5, 9)
    assert (report.simulated, report.valid_until_us) == (True, -(2**61))
    assert report.command == core.Twist(linear_mps=-0.125, angular_radps=2.0)
    assert (report.status, report.reason) == (core.Status.coasting, core.Reason.tag_refused)


def test_an_observation_goes_out_as_it_is(link):
    corners = np.array([[1.5, 20.25], [10.75, 20.0], [10.5, 3.0], [1.25, 3.5]])  # exact in single precision
    tag = core.TagDetection(id=586, corners_px=corners, hamming=1, decision_margin=42.5)
    observation = core.Observation(
        utime=9,
        distance_m=2.44,
        bearing_rad=-0.17,
        heading_rad=0.3,
        covariance=np.diag([1.0, 2.0, 3.0]),
        reprojection_error_px=0.125,
        ambiguity_ratio=7.5,
        min_decision_margin=41.5,
        tags=[tag],
    )
    report = bus.ObservationReport(utime=9, observation=observation, latency_s=0.004)
    message = observation_t.decode(link.catch("R2_OBSERVATION", lambda: link.bus.publish_observation("r2", report)))
    assert (message.detected, message.utime, message.latency_s) == (True, 9, 0.004)
    assert (message.distance_m, message.bearing_rad, message.heading_rad) == (2.44, -0.17, 0.3)
    assert (message.reprojection_error_px, message.ambiguity_ratio, message.min_decision_margin) == (0.125, 7.5, 41.5)
    np.testing.assert_array_equal(message.covariance, np.diag([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(message.camera_from_leader, observation.cMo[:3])
    (sighting,) = message.tags
    assert (sighting.id, sighting.hamming, sighting.decision_margin) == (586, 1, 42.5)
    np.testing.assert_array_equal(sighting.corners_px, corners)


def test_nothing_seen_is_an_observation_too_with_its_reason(link):
    report = bus.ObservationReport(utime=9, reason=core.Reason.pose_refused)
    message = observation_t.decode(link.catch("R2_OBSERVATION", lambda: link.bus.publish_observation("r2", report)))
    assert (message.detected, message.tag_count) == (False, 0)
    assert (message.reason, message.text) == (int(core.Reason.pose_refused), core.Reason.pose_refused.text)


def test_a_status_goes_out_as_it_is(link):
    strengths = np.linspace(0, 1, 56)
    report = bus.StatusReport(
        utime=3,
        status=core.Status.tracking,
        error_m=-0.5,
        error_change_m=0.01,
        output=0.75,
        strengths=strengths,
        setpoint=core.Setpoint(distance_m=1.1, bearing_rad=-0.1, run=False),
        frame_rate_hz=29.97,
        processing_ms=3.5,
        rejected={"image_corrupt": 3, "tag_refused": 1},
    )
    report.feed_forward_weight, report.leader_radial_mps, report.leader_tangential_mps = 0.875, 0.2, -0.05
    report.leader_turn_rate_radps, report.latency_s, report.configured_latency_s = 0.25, 0.041, 0.033
    report.ego_motion, report.leader_intent = status_t.EGO_MOTION_ODOMETRY, status_t.LEADER_INTENT_USED
    report.latency_from_exposure = True
    message = status_t.decode(link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", report)))
    assert (message.feed_forward_weight, message.leader_radial_mps, message.leader_tangential_mps) == (
        0.875,
        0.2,
        -0.05,
    )
    assert (message.leader_turn_rate_radps, message.latency_s, message.configured_latency_s) == (0.25, 0.041, 0.033)
    assert (message.ego_motion, message.leader_intent, message.latency_from_exposure) == (1, 3, True)
    assert (message.utime, message.status, message.text) == (3, command_t.STATUS_TRACKING, "tracking")
    assert (message.error_m, message.error_change_m, message.output) == (-0.5, 0.01, 0.75)
    np.testing.assert_array_equal(message.strengths, strengths.astype(np.float32))
    assert (message.setpoint_distance_m, message.setpoint_bearing_rad, message.setpoint_run) == (
        1.1,
        -0.1,
        False,
    )
    assert (message.frame_rate_hz, message.processing_ms) == (29.97, 3.5)
    assert {c.name: c.count for c in message.rejected} == {"image_corrupt": 3, "tag_refused": 1}


def test_a_pose_goes_out_with_its_heading_as_a_quaternion_and_its_speed_along_it(link):
    # A quarter turn to the left: the body's x axis is the world's y axis. The quaternion of a turn by h about
    # z is (cos h/2, 0, 0, sin h/2) = (0.7071, 0, 0, 0.7071); 0.2 m/s forward are (0, 0.2, 0) in the world.
    report = bus.PoseReport(
        utime=5, x_m=1, y_m=2, heading_rad=np.pi / 2, velocity=core.Twist(linear_mps=0.2, angular_radps=0.4)
    )
    message = pose_t.decode(link.catch("LEADER_POSE", lambda: link.bus.publish_pose("leader", report)))
    np.testing.assert_allclose(message.pos, [1, 2, 0])
    np.testing.assert_allclose(message.orientation, [np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    np.testing.assert_allclose(message.vel, [0, 0.2, 0], atol=1e-16)
    np.testing.assert_allclose(message.rotation_rate, [0, 0, 0.4])
    np.testing.assert_array_equal(message.accel, [0, 0, 0])


@pytest.mark.parametrize("heading_rad", [0.0, 1.0, np.pi / 2, -3.0])
@pytest.mark.parametrize(("linear_mps", "angular_radps"), [(0.2, 0.4), (-0.3, -1.0)])
def test_a_pose_comes_in_as_the_twist_that_went_out(link, heading_rad, linear_mps, angular_radps):
    """Whatever the heading: R^T turns the velocity back into the robot's own frame."""
    twist = core.Twist(linear_mps=linear_mps, angular_radps=angular_radps)
    report = bus.PoseReport(utime=7, x_m=3, y_m=-2, heading_rad=heading_rad, velocity=twist)
    data = link.catch("R1_POSE", lambda: link.bus.publish_pose("r1", report))
    received = []
    link.bus.on_pose("r1", received.append)
    link.send("R1_POSE", data)
    assert received[0].utime == 7
    assert received[0].twist.linear_mps == pytest.approx(linear_mps, abs=1e-15)
    assert received[0].twist.angular_radps == angular_radps


def test_of_a_robot_on_a_slope_the_speed_along_its_own_axis_counts(link):
    """Pitched by -30 degrees about y (nose up), q = (cos 15, 0, -sin 15, 0): its x axis is (cos 30, 0, sin 30), and
    0.4 m/s along it are (0.3464, 0, 0.2) m/s in the local frame. What is across it does not count."""
    message = pose_t()
    message.orientation = [np.cos(np.radians(15)), 0.0, -np.sin(np.radians(15)), 0.0]
    message.vel = [0.4 * np.cos(np.radians(30)), 0.7, 0.4 * np.sin(np.radians(30))]
    received = []
    link.bus.on_pose("r1", received.append)
    link.send("R1_POSE", message.encode())
    assert received[0].twist.linear_mps == pytest.approx(0.4)


def test_an_announcement_survives_both_ways(link):
    report = bus.MotionReport(utime=12, twist=core.Twist(linear_mps=-0.125, angular_radps=0.5))
    data = link.catch("LEADER_MOTION", lambda: link.bus.publish_motion("leader", report))
    message = motion_t.decode(data)
    assert (message.utime, message.linear_mps, message.angular_radps) == (12, -0.125, 0.5)
    received = []
    link.bus.on_motion("leader", received.append)
    link.send("LEADER_MOTION", data)
    assert (received[0].utime, received[0].twist) == (12, report.twist)


@pytest.mark.parametrize("run", [False, True])
def test_a_setpoint_survives_both_ways(link, run):
    setpoint = core.Setpoint(distance_m=0.65, bearing_rad=0.2, run=run)
    report = bus.SetpointReport(utime=12, session=2**62 + 1, counter=2**61, setpoint=setpoint)
    data = link.catch("R1_SETPOINT", lambda: link.bus.publish_setpoint("r1", report))
    message = setpoint_t.decode(data)
    assert (message.utime, message.session, message.counter) == (12, 2**62 + 1, 2**61)
    assert (message.distance_m, message.bearing_rad, message.run) == (0.65, 0.2, run)
    received = []
    link.bus.on_setpoint("r1", received.append)
    link.send("R1_SETPOINT", data)
    (back,) = received
    assert (back.utime, back.session, back.counter) == (12, 2**62 + 1, 2**61)
    assert (back.setpoint.distance_m, back.setpoint.bearing_rad, back.setpoint.run) == (0.65, 0.2, run)


def test_a_raw_picture_survives_both_ways_bit_for_bit(link):
    image = textured(40, 60)
    data = link.catch("IMAGE", lambda: link.bus.publish_image("IMAGE", core.Frame(image, utime=123)))
    decoded = wire.decode_image(data)
    assert decoded.utime == 123
    np.testing.assert_array_equal(decoded.image, image)
    received = []
    link.bus.on_image("IMAGE", received.append)
    link.send("IMAGE", wire.encode_image(image, utime=124))
    assert received[0].utime == 124
    np.testing.assert_array_equal(received[0].image, image)


def test_a_jpeg_from_python_is_decoded_as_pillow_decodes_it(link):
    image = smooth(480, 640)
    data = wire.encode_image(image, utime=1, jpeg=True)
    received = []
    link.bus.on_image("IMAGE", received.append)
    link.send("IMAGE", data)
    # Pillow is built on the same libjpeg-turbo, both with the accurate inverse DCT.
    np.testing.assert_array_equal(received[0].image, wire.decode_image(data).image)
    # Quality 95 quantises the lowest frequencies in steps of 2: a smooth picture is off by a level or two.
    assert np.abs(received[0].image.astype(int) - image).max() <= 3


def publish_format(link, image):
    message = image_t.decode(link.catch("IMAGE", lambda: link.bus.publish_image("IMAGE", core.Frame(image, utime=1))))
    return message.pixelformat


@pytest.mark.parametrize("asked_bytes", [65536, 262144, 4194304])
@pytest.mark.parametrize("shape", [(48, 64), (240, 320), (480, 640)])
def test_a_picture_travels_raw_only_if_four_of_them_fit_into_the_granted_buffer(url, asked_bytes, shape):
    link = Link(url.partition("?")[0] + f"?ttl=0&recv_buf_size={asked_bytes}")
    raw = 4 * shape[0] * shape[1] <= link.bus.receive_buffer_bytes
    expected = image_t.PIXEL_FORMAT_GRAY if raw else image_t.PIXEL_FORMAT_MJPEG
    assert publish_format(link, smooth(*shape)) == expected


def test_both_ways_of_travelling_occur_whatever_the_kernel_grants(url):
    # The kernel doubles what is asked for, and no kernel refuses 64 KiB: 131072 bytes hold four pictures of
    # 64 x 48 (12 288 bytes) and not four of 640 x 480 (1.2 MB).
    link = Link(url.partition("?")[0] + "?ttl=0&recv_buf_size=65536")
    assert link.bus.receive_buffer_bytes == 131072
    assert publish_format(link, smooth(48, 64)) == image_t.PIXEL_FORMAT_GRAY
    assert publish_format(link, smooth(480, 640)) == image_t.PIXEL_FORMAT_MJPEG


def test_inside_a_process_pictures_travel_raw_without_a_socket():
    local = bus.Bus("memq://")
    assert local.receive_buffer_bytes == 0
    received = []
    local.on_image("IMAGE", received.append)
    image = textured(1000, 2000)
    local.publish_image("IMAGE", core.Frame(image, utime=1))
    assert local.handle(1000) == 1
    np.testing.assert_array_equal(received[0].image, image)


@settings(
    max_examples=40,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    width=st.integers(1, 70),
    height=st.integers(1, 50),
    padding=st.integers(0, 9),
    pads_last_row=st.booleans(),
    pixel_format=st.sampled_from(["GRAY", "RGB", "BGR"]),
)
def test_any_consistent_raw_layout_is_read_as_the_python_side_reads_it(
    link, width, height, padding, pads_last_row, pixel_format
):
    channels = 1 if pixel_format == "GRAY" else 3
    row_bytes = width * channels
    message = image_t()
    message.utime = 1
    message.width, message.height, message.row_stride = width, height, row_bytes + padding
    message.pixelformat = getattr(image_t, f"PIXEL_FORMAT_{pixel_format}")
    message.data = textured(height, row_bytes + padding, seed=width).tobytes()
    if not pads_last_row:
        message.data = message.data[: len(message.data) - padding]
    message.size = len(message.data)

    received = []
    channel = f"IMAGE{next(_channel_numbers)}"  # a Bus keeps its subscriptions for good
    link.bus.on_image(channel, received.append)
    link.send(channel, message.encode())
    (frame,) = received
    assert (frame.width, frame.height) == (width, height)
    if frame.defect == core.Reason.none:  # below 16 pixels a side it is handed on, but it may not be used
        # Pillow's conversion to gray is the same BT.601 in 16-bit fixed point: an independent oracle, exact.
        np.testing.assert_array_equal(frame.image, wire.decode_image(message.encode()).image)


def test_messages_are_handled_in_their_order_and_all_at_once(link):
    received = []
    link.bus.on_command("r1", lambda report: received.append(report.counter))
    for counter in range(20):
        link.bus.publish_command("r1", bus.CommandReport(utime=1, counter=counter))
    handled = 0
    while handled < 20:
        count = link.bus.handle(5000)
        assert count > 0
        handled += count
    assert received == list(range(20))


def test_waiting_for_messages_lets_other_python_threads_run(link):
    received = []
    link.bus.on_setpoint("r1", received.append)
    message = setpoint_t()
    message.distance_m, message.mac = 1.0, bytes(32)
    sender = threading.Timer(0.05, lambda: link.lcm.publish("R1_SETPOINT", message.encode()))
    sender.start()
    # If handle() kept the GIL, the sender could not run until the wait is over, and nothing would have come.
    assert link.bus.handle(5000) == 1
    sender.join()
    assert len(received) == 1


def test_a_handlers_exception_comes_out_of_handle_and_loses_no_other_message(link):
    received = []

    def fussy(report):
        if report.setpoint.distance_m == 1.0:
            raise KeyError("not this one")
        received.append(report.setpoint.distance_m)

    link.bus.on_setpoint("r1", fussy)
    for distance_m in (1.0, 2.0):
        link.bus.publish_setpoint("r1", setpoint_report(distance_m=distance_m))
    with pytest.raises(KeyError, match="not this one"):
        link.bus.handle(5000)
    assert link.bus.handle(5000) == 1
    assert received == [2.0]


def test_handling_messages_inside_a_handler_is_refused(link):
    link.bus.on_setpoint("r1", lambda _: link.bus.handle(0))
    link.bus.publish_setpoint("r1", setpoint_report())
    with pytest.raises(RuntimeError, match="not re-entrant"):
        link.bus.handle(5000)


def test_a_robots_channels_are_its_name_in_capitals():
    assert bus.channel("robot1", "COMMAND") == "ROBOT1_COMMAND"


@pytest.mark.parametrize("robot", ["", "my robot", "r.*", "x" * 60, "robot\n", "rob\0t"])
def test_a_name_that_liblcm_would_misread_is_refused(robot):
    with pytest.raises(ValueError, match="letters, digits"):
        bus.channel(robot, "COMMAND")

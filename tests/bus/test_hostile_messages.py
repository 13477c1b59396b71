"""What must not get past the edge: it is counted under its kind and dropped, and the Bus goes on."""

import io
import math
import resource
import struct

import numpy as np
import pytest
from edge import VALID, counter, valid_base, valid_command, valid_image, valid_setpoint, valid_status
from PIL import Image

from bench.common import wire
from pilotfish import bus, core
from pilotfish.core import MAX_BEARING_RAD
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.lcmtypes.pilotfish import command_t, observation_t, setpoint_t, stage_t, status_t

INT32_MAX = 2**31 - 1


@pytest.mark.parametrize("channel", VALID)
def test_every_truncation_of_a_message_is_refused(edge, channel):
    data = VALID[channel].encode()
    for length in range(len(data)):
        assert edge.refuses(channel, data[:length]).endswith("_corrupt")
    edge.accepts(channel, data)


@pytest.mark.parametrize("channel", VALID)
def test_bytes_behind_the_end_of_a_message_are_refused(edge, channel):
    assert edge.refuses(channel, VALID[channel].encode() + b"\0").endswith("_corrupt")


@pytest.mark.parametrize("channel", VALID)
def test_random_bytes_are_refused(edge, channel):
    rng = np.random.default_rng(7)
    fingerprint = VALID[channel].encode()[:8]
    for _ in range(300):
        noise = rng.bytes(int(rng.integers(0, 400)))
        # Bytes without the fingerprint stop at once; with it, the counts inside are random as well.
        assert edge.refuses(channel, noise).endswith("_corrupt")
        kind = edge.refuses(channel, fingerprint + noise)
        assert kind.startswith(channel.lower().removeprefix("r1_"))


def test_flipped_bits_never_break_the_bus(edge):
    """A flipped bit may leave a message valid (a pixel, a word): it is either refused or handed on."""
    rng = np.random.default_rng(11)
    for channel, message in VALID.items():
        data = message.encode()
        for _ in range(500):
            flipped = bytearray(data)
            flipped[rng.integers(len(data))] ^= 1 << rng.integers(8)
            refused = sum(edge.link.bus.rejected.values())
            edge.link.send(channel, bytes(flipped))
            refused = sum(edge.link.bus.rejected.values()) - refused
            assert refused + len(edge.accepted) == 1
            edge.accepted.clear()


@pytest.mark.parametrize("wrong", [image_t, setpoint_t, status_t, observation_t], ids=lambda t: t.__name__)
def test_a_message_of_another_type_is_refused(edge, wrong):
    assert edge.refuses("R1_COMMAND", wrong().encode()) == "command_corrupt"


SIZE_AT, DATA_AT = 32, 36  # fingerprint 8, utime 8, then four int32; then the data itself


def peak_memory_bytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


@pytest.mark.parametrize("count", [INT32_MAX, INT32_MAX - 1, 2**30, -1, -(2**31), 321, 319])
@pytest.mark.parametrize("field", ["size", "nmetadata", "key length", "value length"])
def test_a_count_that_contradicts_the_messages_length_is_refused_without_allocating(edge, field, count):
    data = bytearray(valid_image().encode())
    metadata_at = DATA_AT + 320
    # nmetadata, then per entry: key length, key with its final zero, value length, value
    at = {
        "size": SIZE_AT,
        "nmetadata": metadata_at,
        "key length": metadata_at + 4,
        "value length": metadata_at + 13,
    }
    struct.pack_into(">i", data, at[field], count)
    before = peak_memory_bytes()
    assert edge.refuses("IMAGE", bytes(data)) == "image_corrupt"
    assert peak_memory_bytes() - before < 2**28  # lcm-gen's decoder would ask for 2 GiB and more


@pytest.mark.parametrize("length", [0, -1, -(2**31), INT32_MAX, 100])
def test_a_text_length_that_contradicts_the_messages_length_is_refused(edge, length):
    data = bytearray(valid_command().encode())
    struct.pack_into(">i", data, 8 + 5 * 8 + 2 * 8 + 3, length)
    assert edge.refuses("R1_COMMAND", bytes(data)) == "command_corrupt"


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"width": 0}, "image_size_mismatch"),
        ({"width": -20}, "image_size_mismatch"),
        ({"height": -(2**31)}, "image_size_mismatch"),
        ({"width": INT32_MAX}, "image_too_large"),
        ({"height": INT32_MAX, "width": INT32_MAX}, "image_too_large"),
        ({"width": 16385}, "image_too_large"),
        ({"row_stride": 19}, "image_size_mismatch"),
        ({"row_stride": -20}, "image_size_mismatch"),
        ({"row_stride": 0}, "image_size_mismatch"),
        ({"row_stride": INT32_MAX}, "image_size_mismatch"),
        ({"width": 21}, "image_size_mismatch"),
        ({"height": 17}, "image_size_mismatch"),
        ({"height": 15}, "image_size_mismatch"),  # more bytes than the picture has
        ({"data": b""}, "image_size_mismatch"),
        ({"pixelformat": image_t.PIXEL_FORMAT_RGB}, "image_size_mismatch"),
        ({"pixelformat": 1448695129}, "image_format_unknown"),  # YUYV
        ({"pixelformat": 0}, "image_format_unknown"),
        ({"pixelformat": -2}, "image_format_unknown"),
        ({"utime": -1}, "image_time_invalid"),
        ({"utime": 2**63 - 1}, "image_time_invalid"),
    ],
)
def test_a_picture_that_contradicts_itself_is_refused(edge, changes, kind):
    assert edge.refuses("IMAGE", valid_image(**changes).encode()) == kind
    edge.accepts("IMAGE", valid_image().encode())


def jpeg(width, height, **options):
    v, u = np.mgrid[0:height, 0:width]
    buffer = io.BytesIO()
    Image.fromarray(((u * 3 + v * 5) % 200).astype(np.uint8)).save(buffer, format="JPEG", quality=95, **options)
    return buffer.getvalue()


def jpeg_message(data, width, height):
    return valid_image(
        pixelformat=image_t.PIXEL_FORMAT_MJPEG, width=width, height=height, row_stride=0, data=data
    ).encode()


def with_claimed_size(data, width, height):
    """The same JPEG, but its header (FF C0, 2 of length, 1 of precision, height, width) says otherwise."""
    at = data.index(b"\xff\xc0") + 5
    return data[:at] + struct.pack(">HH", height, width) + data[at + 4 :]


def test_a_whole_jpeg_is_accepted(edge):
    assert edge.accepts("IMAGE", jpeg_message(jpeg(64, 48), 64, 48)).width == 64
    assert edge.accepts("IMAGE", jpeg_message(jpeg(64, 48, progressive=True), 64, 48)).width == 64


def test_stray_bytes_before_the_end_marker_are_forgiven_as_usb_cameras_leave_them(edge):
    data = jpeg(64, 48)
    expected = edge.accepts("IMAGE", jpeg_message(data, 64, 48)).image
    for count in (1, 40):  # the decoder reads a few bytes ahead and does not even warn of those
        stray = data[:-2] + b"\x55" * count + data[-2:]
        np.testing.assert_array_equal(edge.accepts("IMAGE", jpeg_message(stray, 64, 48)).image, expected)


def test_every_truncation_of_a_jpeg_is_refused(edge):
    data = jpeg(32, 24)
    for length in range(len(data)):
        assert edge.refuses("IMAGE", jpeg_message(data[:length], 32, 24)) == "image_jpeg_refused"


def test_a_jpeg_of_another_size_than_the_message_says_is_refused(edge):
    assert edge.refuses("IMAGE", jpeg_message(jpeg(64, 48), 64, 40)) == "image_jpeg_refused"
    assert edge.refuses("IMAGE", jpeg_message(jpeg(2000, 1500), 640, 480)) == "image_jpeg_refused"


def test_a_jpeg_bomb_is_refused_without_allocating(edge):
    bomb = with_claimed_size(jpeg(64, 48), 16384, 16384)  # 268 million pixels in two kilobytes
    before = peak_memory_bytes()
    assert edge.refuses("IMAGE", jpeg_message(bomb, 16384, 16384)) == "image_jpeg_refused"
    assert peak_memory_bytes() - before < 16384 * 16384 / 4


def test_other_kinds_of_picture_under_the_name_of_jpeg_are_refused(edge):
    buffer = io.BytesIO()
    Image.new("L", (64, 48)).save(buffer, format="PNG")
    assert edge.refuses("IMAGE", jpeg_message(buffer.getvalue(), 64, 48)) == "image_jpeg_refused"
    assert edge.refuses("IMAGE", jpeg_message(b"", 64, 48)) == "image_jpeg_refused"


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("field", ["distance_m", "bearing_rad"])
def test_a_setpoint_that_is_not_a_number_is_refused(edge, field, number):
    assert edge.refuses("R1_SETPOINT", valid_setpoint(**{field: number}).encode()) == "setpoint_not_finite"


@pytest.mark.parametrize(
    "changes",
    [
        {"distance_m": 0.049},
        {"distance_m": 20.1},
        {"distance_m": -1.0},
        {"bearing_rad": 1.23},
        {"bearing_rad": -1.23},
        {"bearing_rad": 1e300},
    ],
)
def test_a_setpoint_out_of_bounds_is_refused(edge, changes):
    assert edge.refuses("R1_SETPOINT", valid_setpoint(**changes).encode()) == "setpoint_out_of_bounds"


def test_the_bounds_of_a_setpoint_belong_to_it(edge):
    for distance_m, bearing_rad in [(0.05, MAX_BEARING_RAD), (20.0, -MAX_BEARING_RAD)]:
        message = valid_setpoint(distance_m=distance_m, bearing_rad=bearing_rad)
        assert edge.accepts("R1_SETPOINT", message.encode()).setpoint.distance_m == distance_m


def test_a_setpoint_out_of_bounds_is_not_even_sent(link):
    with pytest.raises(ValueError, match=r"setpoint.distance_m: 21 is outside \[0.05, 20\]"):
        link.bus.publish_setpoint("r1", bus.SetpointReport(utime=1, setpoint=core.Setpoint.unchecked(distance_m=21.0)))


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"linear_mps": math.nan}, "command_not_finite"),
        ({"angular_radps": -math.inf}, "command_not_finite"),
        ({"linear_mps": 10.1}, "command_out_of_bounds"),
        ({"angular_radps": -50.1}, "command_out_of_bounds"),
        ({"status": 6}, "command_out_of_bounds"),
        ({"status": -1}, "command_out_of_bounds"),
        ({"reason": 127}, "command_out_of_bounds"),
        ({"reason": -128}, "command_out_of_bounds"),
    ],
)
def test_a_command_that_no_robot_could_mean_is_refused(edge, changes, kind):
    assert edge.refuses("R1_COMMAND", valid_command(**changes).encode()) == kind


@pytest.mark.parametrize(
    ("channel", "message", "kind"),
    [
        ("R1_STATUS", valid_status(status=6), "status_out_of_bounds"),
        ("R1_STATUS", valid_status(reason=-1), "status_out_of_bounds"),
        ("R1_STATUS", valid_status(setpoint_distance_m=math.nan), "status_not_finite"),
        ("R1_STATUS", valid_status(strengths=[math.inf] * 56), "status_not_finite"),
        ("R1_BASE", valid_base(state=4), "base_out_of_bounds"),
        ("R1_BASE", valid_base(state=-1), "base_out_of_bounds"),
        ("R1_BASE", valid_base(linear_mps=10.1), "base_out_of_bounds"),
        ("R1_BASE", valid_base(measured_angular_radps=50.1), "base_out_of_bounds"),
        ("R1_BASE", valid_base(angular_radps=math.nan), "base_not_finite"),
        ("R1_BASE", valid_base(measured_linear_mps=math.inf), "base_not_finite"),
        ("R1_BASE", valid_base(text="x" * 81), "base_corrupt"),
    ],
)
def test_a_state_that_no_process_of_ours_can_be_in_is_refused(edge, channel, message, kind):
    assert edge.refuses(channel, message.encode()) == kind


@pytest.mark.parametrize(
    ("channel", "valid", "at_most"), [("R1_STATUS", valid_status, 24), ("R1_BASE", valid_base, 16)]
)
def test_a_list_of_counters_that_nobody_sends_is_refused(edge, channel, valid, at_most):
    edge.accepts(channel, valid(rejected=[counter("x")] * at_most).encode())
    edge.accepts(channel, valid(rejected=[counter("x" * 24)]).encode())
    assert edge.refuses(channel, valid(rejected=[counter("x")] * (at_most + 1)).encode()).endswith("_corrupt")
    assert edge.refuses(channel, valid(rejected=[counter("x" * 25)]).encode()).endswith("_corrupt")


@pytest.mark.parametrize(("channel", "valid"), [("R1_STATUS", valid_status), ("R1_BASE", valid_base)])
@pytest.mark.parametrize("count", [-1, -(2**31)])
def test_less_than_no_counters_are_refused(edge, channel, valid, count):
    """The count is an int32, and of 0 and 1 the last byte differs: there the two messages begin to be different."""
    none, one = valid(rejected=[]).encode(), valid(rejected=[counter("x")]).encode()
    last_byte = next(k for k, (a, b) in enumerate(zip(none, one, strict=False)) if a != b)
    edge.accepts(channel, none)
    data = bytearray(none)
    struct.pack_into(">i", data, last_byte - 3, count)
    assert edge.refuses(channel, bytes(data)).endswith("_corrupt")


def test_a_list_of_stages_that_nobody_sends_is_refused(edge):
    def with_stages(names):
        stages = [stage_t() for _ in names]
        for stage, name in zip(stages, names, strict=True):
            stage.name = name
        return valid_status(stages=stages, stage_count=len(stages)).encode()

    edge.accepts("R1_STATUS", with_stages(["x"] * 6))
    edge.accepts("R1_STATUS", with_stages([]))
    assert edge.refuses("R1_STATUS", with_stages(["x"] * 7)) == "status_corrupt"
    assert edge.refuses("R1_STATUS", with_stages(["x" * 100])) == "status_corrupt"


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_a_velocity_that_is_not_a_number_goes_out_as_a_stop(link, number):
    report = bus.CommandReport(
        utime=1, command=core.Twist(linear_mps=0.3, angular_radps=number), status=core.Status.tracking
    )
    command = command_t.decode(link.catch("R1_COMMAND", lambda: link.bus.publish_command("r1", report)))
    assert (command.linear_mps, command.angular_radps) == (0.0, 0.0)
    assert command.reason == int(core.Reason.law_not_finite)
    assert link.bus.rejected == {"command_not_finite": 1}


def test_reports_that_are_not_numbers_go_out_without_them(link):
    nan = math.nan
    observation = core.Observation(utime=1, distance_m=nan)
    data = link.catch(
        "R1_OBSERVATION",
        lambda: link.bus.publish_observation("r1", bus.ObservationReport(utime=1, observation=observation)),
    )
    assert not observation_t.decode(data).detected
    status = bus.StatusReport(utime=1, error_m=nan, output=0.5, strengths=[nan] * 56)
    message = status_t.decode(link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", status)))
    assert (message.error_m, message.output, any(message.strengths)) == (0.0, 0.5, False)
    pose = bus.PoseReport(utime=1, x_m=nan, y_m=1.0, heading_rad=nan)
    link.catch("R1_POSE", lambda: link.bus.publish_pose("r1", pose))
    assert link.bus.rejected == {"observation_not_finite": 1, "status_not_finite": 1, "pose_not_finite": 1}


def test_a_frame_without_pixels_is_not_sent_but_counted(link):
    link.bus.publish_image("IMAGE", core.Frame.unchecked(b"", width=640, height=480, stride_bytes=640, utime=1))
    assert link.bus.rejected == {"image_not_publishable": 1}


def test_python_refuses_what_is_not_a_picture_in_its_own_words():
    data = valid_image().encode()
    wire.decode_image(data)
    for bad in [b"", data[:20], data[:100], b"x" * 100, valid_image(row_stride=INT32_MAX).encode()]:
        with pytest.raises(wire.WireError):
            wire.decode_image(bad)
    with pytest.raises(wire.WireError, match="the message says"):
        wire.decode_image(jpeg_message(jpeg(64, 48), 64, 40))
    with pytest.raises(wire.WireError, match="unknown pixel format"):
        wire.decode_image(valid_image(pixelformat=7).encode())
    with pytest.raises(ValueError, match="gray image"):
        wire.encode_image(np.zeros((4, 4, 3), np.uint8), utime=1)

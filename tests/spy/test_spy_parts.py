"""The parts of lcm-spy's plug-in without a screen: pictures, rules, memory, words."""

import io
import struct

import numpy as np
import pytest
import yaml
from PIL import Image
from robot_window import LIT, OUTLINE, one_tag, plain_picture

import robot_on_bus
from pilotfish import data
from pilotfish.lcmtypes.bot_core import image_metadata_t, image_t

NOW_US = robot_on_bus.NOW_US


def message(pixels: bytes, pixelformat: int, width: int, height: int, row_stride: int = 0) -> image_t:
    image = image_t()
    image.utime, image.width, image.height = NOW_US, width, height
    image.row_stride, image.pixelformat = row_stride, pixelformat
    image.data, image.size = pixels, len(pixels)
    return image


def jpeg(image: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(image).save(file, "JPEG", quality=90)
    return file.getvalue()


def noise(*shape: int) -> np.ndarray:
    return np.random.default_rng(1).integers(0, 256, shape, dtype=np.uint8)


def pixels_of(file) -> np.ndarray:
    """(H, W, 3) uint8, of a file or its bytes."""
    with Image.open(io.BytesIO(file) if isinstance(file, bytes) else file) as image:
        return np.asarray(image.convert("RGB"))


def decoded(probe, encoded: bytes):
    """What the plug-in makes of it: pixels (H, W, 3), and what it says."""
    out = probe.folder / "decoded.png"
    said = probe.ask("decode", probe.file(encoded), out)
    if said.startswith(("refused", "threw")):
        return None, said
    return pixels_of(out), said


@pytest.mark.parametrize(
    ("pixelformat", "channels"),
    [
        (image_t.PIXEL_FORMAT_GRAY, [0, 0, 0]),
        (image_t.PIXEL_FORMAT_RGB, [0, 1, 2]),
        (image_t.PIXEL_FORMAT_BGR, [2, 1, 0]),
    ],
)
@pytest.mark.parametrize("padding", [0, 13])
def test_a_raw_picture_is_shown_to_the_bit(probe, pixelformat, channels, padding):
    depth = 1 + max(channels)
    image = noise(31, 47, depth)
    rows = np.concatenate([image.reshape(31, -1), noise(31, padding)], axis=1)
    pixels = rows.tobytes()[: rows.size - padding]  # the last row needs no padding
    shown, said = decoded(probe, message(pixels, pixelformat, 47, 31, 47 * depth + padding).encode())
    assert said == f"{NOW_US} 47 31"
    np.testing.assert_array_equal(shown, image[:, :, channels])


@pytest.mark.parametrize("shape", [(48, 64), (48, 64, 3)])
def test_a_jpeg_is_shown_as_another_decoder_shows_it(probe, shape):
    # Smooth, so that how a decoder enlarges the chroma planes does not matter.
    ramp = np.linspace(0, 255, 64)[None, :] * np.linspace(0.3, 1, 48)[:, None]
    image = ramp if len(shape) == 2 else np.stack([ramp, 255 - ramp, ramp / 2], axis=2)
    encoded = jpeg(image.astype(np.uint8))
    shown, _ = decoded(probe, message(encoded, image_t.PIXEL_FORMAT_MJPEG, 64, 48).encode())
    expected = pixels_of(encoded).astype(int)
    assert np.abs(shown - expected).max() <= (1 if len(shape) == 2 else 4)


def with_extra(image: image_t, key: str, value: bytes) -> image_t:
    extra = image_metadata_t()
    extra.key, extra.value, extra.n = key, value, len(value)
    image.metadata, image.nmetadata = [extra], 1
    return image


@pytest.mark.parametrize(
    ("value", "shrink"), [(b"4", 4), (b"1000", 1000), (b"0", 1), (b"1001", 1), (b"-2", 1), (b"x", 1)]
)
def test_a_preview_refers_to_the_cameras_picture(probe, value, shrink):
    small = message(jpeg(np.full((12, 16), 77, np.uint8)), image_t.PIXEL_FORMAT_MJPEG, 16, 12)
    shown, said = decoded(probe, with_extra(small, "pilotfish_shrink", value).encode())
    assert said == f"{NOW_US} {16 * shrink} {12 * shrink}"
    assert shown.shape == (12, 16, 3)


def test_a_picture_larger_than_any_screen_is_thinned_out(probe):
    # 3850 px are more than 2 x 1920, so every third pixel is shown: of columns 0, 3, ..., 3849 and row 0.
    image = noise(2, 3850)
    shown, said = decoded(probe, message(image.tobytes(), image_t.PIXEL_FORMAT_GRAY, 3850, 2, 3850).encode())
    assert said == f"{NOW_US} 3850 2"
    np.testing.assert_array_equal(shown[:, :, 0], image[::3, ::3])


GRAY = message(bytes(64 * 48), image_t.PIXEL_FORMAT_GRAY, 64, 48, 64).encode()
JPEG = message(jpeg(noise(48, 64)), image_t.PIXEL_FORMAT_MJPEG, 64, 48).encode()
AT = {"width": 16, "height": 20, "row_stride": 24, "pixelformat": 28, "size": 32}  # in a message


def changed(encoded: bytes, **fields: int) -> bytes:
    out = bytearray(encoded)
    for name, value in fields.items():
        struct.pack_into(">i", out, AT[name], value)
    return bytes(out)


@pytest.mark.parametrize(
    ("encoded", "why"),
    [
        (b"", "an image message of 0 bytes"),
        (GRAY[:20], "an image message of 20 bytes"),
        (b"\0" * 200, "another type or version"),
        (GRAY[:1000], "it is cut short: 964 of 3072 bytes"),
        (changed(GRAY, width=0), "a picture of 0 x 48 px"),
        (changed(GRAY, width=-5), "a picture of -5 x 48 px"),
        (changed(GRAY, width=2**31 - 1, height=2**31 - 1), "a picture of 2147483647 x 2147483647 px"),
        (changed(GRAY, width=8192, height=8192, row_stride=8192), "its size needs 67108864"),
        (changed(GRAY, row_stride=63), "row stride of 63 bytes is shorter than a row"),
        (changed(GRAY, row_stride=2**31 - 1), "its size needs 100931731473"),
        (changed(GRAY, row_stride=65), "it has 3072 bytes where its size needs 3119"),
        (changed(GRAY, size=-1), "it is cut short"),
        (changed(GRAY, size=2**31 - 1), "it is cut short"),
        (changed(GRAY, pixelformat=0x56595559), "pixel format YUYV is none of GREY, RGB3, BGR3, MJPG"),
        (changed(GRAY, pixelformat=1), "pixel format 1 is none of"),
        (changed(GRAY, pixelformat=image_t.PIXEL_FORMAT_MJPEG), "a JPEG that cannot be read"),
        (changed(JPEG, width=640, height=480), "its JPEG is 64 x 48 px, its message says 640 x 480"),
        (changed(JPEG, size=700), "JPEG"),
    ],
)
def test_a_picture_that_cannot_be_is_refused_with_the_reason(probe, encoded, why):
    shown, said = decoded(probe, encoded)
    assert shown is None
    assert said.startswith("refused: ")
    assert why in said


def test_whatever_bytes_come_a_picture_is_shown_or_refused(probe):
    random = np.random.default_rng(2)
    for _ in range(60):
        out = bytearray(JPEG if random.random() < 0.7 else GRAY)
        for at in random.integers(8, len(out), 1 + random.integers(8)):
            out[at] = random.integers(256)
        _, said = decoded(probe, bytes(out[: random.integers(len(out) // 2, len(out) + 1)]))
        assert not said.startswith("threw"), said


def test_the_words_of_the_rules_are_those_of_the_shipped_file(probe):
    rules = yaml.safe_load(data.path("fuzzy/coordination.yaml").read_text())["rules"]
    columns = rules.pop("columns")
    expected = "|".join([" ".join(columns), *(f"{row} {' '.join(cells)}" for row, cells in rules.items())])
    assert expected.count("|") == 8
    assert probe.ask("shipped") == expected


@pytest.mark.parametrize("text", ["", "rules:\n", "rules:\n  columns: [A]\n  NB: [B]\n", "other:\n  NB: [PB]\n"])
def test_a_file_without_a_table_of_rules_has_no_words(probe, text):
    assert probe.ask("rules", probe.file(text.encode())) == ""


@pytest.mark.parametrize(
    ("command", "url"),
    [
        ("lcm.spy.Spy --lcm-url=udpm://239.255.76.67:7700?ttl=0", "udpm://239.255.76.67:7700?ttl=0"),
        ("lcm.spy.Spy -t x -l udpm://239.255.76.67:7700", "udpm://239.255.76.67:7700"),
        ("lcm.spy.Spy --lcm-url tcpq://localhost", "tcpq://localhost"),
        ("lcm.spy.Spy", "null"),
        ("lcm.spy.Spy -l", "null"),
    ],
)
def test_the_plug_in_listens_where_lcm_spy_listens(probe, command, url):
    assert probe.ask("url", command) == url


@pytest.mark.parametrize(
    ("channel", "kind", "title"),
    [
        ("ROBOT1_STATUS", "status", "robot1"),
        ("MY_ROBOT_PREVIEW", "image", "my_robot"),
        ("ROBOT1_IMAGE", "image", "robot1"),
        ("CAMERA", "image", "CAMERA"),
        ("robot1_STATUS", "status", "robot1_STATUS"),  # a robot's channels are in capitals
        ("X" * 33 + "_IMAGE", "image", "X" * 33 + "_IMAGE"),  # no name of a robot is so long
    ],
)
def test_a_channel_belongs_to_the_robot_that_it_names_or_to_nobody(probe, channel, kind, title):
    said_title, channels = probe.ask("subject", channel, kind).split(" ")
    assert said_title == title
    if title == channel:
        assert channels == channel
    else:
        robot = channel.rpartition("_")[0]
        kinds = ("COMMAND", "IMAGE", "OBSERVATION", "PREVIEW", "STATUS")
        assert channels.split("|") == [f"{robot}_{kind}" for kind in kinds]


class Fed:
    """A model that gets messages at times [ms]."""

    def __init__(self, probe, channel="ROBOT1_STATUS"):
        self.probe = probe
        probe.ask("new", channel, "status")

    def take(self, kind, message, now_ms):
        encoded = message if isinstance(message, bytes) else message.encode()
        return self.probe.ask("take", kind, self.probe.file(encoded), now_ms)

    def sample(self, now_ms):
        taken, *values = self.probe.ask("sample", now_ms).split(" ")
        return taken == "true", dict(zip(STRIPS, map(float, values), strict=True))


STRIPS = ["DISTANCE_ERROR", "BEARING_ERROR", "SPEED", "TURN_RATE", "LATENCY"]


def test_curves_show_errors_command_and_latency_in_their_units(probe):
    fed = Fed(probe)
    fed.take("STATUS", robot_on_bus.status(latency_s=0.0385), 0)
    fed.take("OBSERVATION", robot_on_bus.observation(1), 0)
    fed.take("COMMAND", robot_on_bus.command(), 0)
    taken, values = fed.sample(0)
    # 1.1 m wanted, 1.35 m measured; -10 degrees wanted, -12.5 measured
    expected = {"DISTANCE_ERROR": -250, "BEARING_ERROR": -2.5, "SPEED": 0.321, "TURN_RATE": -0.25, "LATENCY": 38.5}
    assert taken and values == pytest.approx(expected)


def test_the_bearing_error_is_the_short_way_round(probe):
    fed = Fed(probe)
    fed.take("STATUS", robot_on_bus.status(setpoint_bearing_rad=np.radians(179.0)), 0)
    fed.take("OBSERVATION", robot_on_bus.observation(1, bearing_rad=np.radians(-179.0)), 0)
    assert fed.sample(0)[1]["BEARING_ERROR"] == pytest.approx(2.0)


def test_curves_have_gaps_where_nothing_is_known(probe):
    fed = Fed(probe)
    fed.take("STATUS", robot_on_bus.status(), 0)
    fed.take("OBSERVATION", robot_on_bus.observation(0, detected=False), 0)
    fed.take("COMMAND", robot_on_bus.command(linear_mps=float("inf"), angular_radps=float("nan")), 0)
    assert [name for name, value in fed.sample(0)[1].items() if np.isfinite(value)] == ["LATENCY"]


def test_values_of_half_a_second_ago_are_none_of_now(probe):
    fed = Fed(probe)
    fed.take("STATUS", robot_on_bus.status(), 0)
    fed.take("OBSERVATION", robot_on_bus.observation(1), 0)
    fed.take("COMMAND", robot_on_bus.command(), 0)
    assert all(map(np.isfinite, fed.sample(499)[1].values()))
    assert not any(map(np.isfinite, fed.sample(500 + 99)[1].values()))


def test_a_sample_is_taken_every_100_ms_and_a_pause_is_a_gap(probe):
    fed = Fed(probe)
    for now_ms in (0, 50, 99, 100, 430):  # samples are due at 0, 100, 200, ...; by 430 those of 200, 300 and 400
        fed.take("COMMAND", robot_on_bus.command(linear_mps=now_ms + 1.0), now_ms)
        assert fed.sample(now_ms)[0] == (now_ms in (0, 100, 430))
    newest = probe.ask("strip", "SPEED").strip("[]").split(", ")[-6:]
    assert newest == ["NaN", "1.0", "101.0", "NaN", "NaN", "431.0"]


def test_a_picture_waits_for_what_was_measured_in_it_but_not_for_long(probe):
    fed = Fed(probe)
    fed.take("OBSERVATION", robot_on_bus.observation(1, utime=NOW_US), 1000)
    for k in range(3):
        fed.take("IMAGE", plain_picture(NOW_US + k), 1000 + k)
    assert probe.ask("picture", 1010) == str(NOW_US)  # not the newest: it is measured
    assert probe.ask("picture", 1020) == "none"  # the newer ones wait
    fed.take("OBSERVATION", robot_on_bus.observation(1, utime=NOW_US + 1), 1021)
    assert probe.ask("picture", 1025) == str(NOW_US + 1)
    assert probe.ask("picture", 1175) == "none"
    assert probe.ask("picture", 1176) == str(NOW_US + 2)  # 150 ms after the last one was shown
    fed.take("IMAGE", plain_picture(NOW_US + 9), 1521)
    assert probe.ask("picture", 1522) == str(NOW_US + 9)  # nobody has measured for 0.5 s


def test_a_preview_is_shown_where_the_camera_is_silent(probe):
    fed = Fed(probe)
    fed.take("IMAGE", plain_picture(1), 0)
    fed.take("PREVIEW", plain_picture(2), 999)
    assert probe.ask("picture", 1000) == "1"
    fed.take("PREVIEW", plain_picture(3), 1000)
    assert probe.ask("picture", 1001) == "3"


def test_memory_is_bounded_however_many_messages_come(probe):
    fed = Fed(probe)
    for k in range(300):
        fed.take("OBSERVATION", robot_on_bus.observation(1, utime=k), 33 * k)
        fed.take("IMAGE", message(b"", image_t.PIXEL_FORMAT_GRAY, 1, 1), 33 * k)
        fed.sample(33 * k)
    assert probe.ask("sizes") == "[4, 64, 600]"  # pictures that wait, observations, samples


def test_a_frame_that_stays_out_does_not_unsee_the_tags_of_the_one_before(probe):
    fed = Fed(probe)
    without = fed.probe.folder / "without.png"
    outlined = fed.probe.folder / "outlined.png"
    fed.take("IMAGE", plain_picture(NOW_US), 0)
    fed.take("OBSERVATION", one_tag(), 0)
    assert probe.ask("picture", 1) == str(NOW_US)
    for file, seen in ((outlined, None), (without, robot_on_bus.observation(0, detected=False, text="no frame"))):
        if seen:
            fed.take("OBSERVATION", seen, 2)
        probe.ask("words", 3)
        probe.ask("paint", 900, 700, file)
    shown = [(pixels_of(file) == OUTLINE).all(axis=2).sum() for file in (outlined, without)]
    assert shown[0] == shown[1] > 50


def test_the_header_says_status_reason_numbers_and_what_is_wrong(probe):
    fed = Fed(probe)
    assert probe.ask("words", 0) == "no message yet; nothing has come on ROBOT1_STATUS; ; "
    fed.take("STATUS", robot_on_bus.status(text="coasting: no tag in the picture", status=2), 0)
    fed.take("OBSERVATION", robot_on_bus.observation(1, bearing_rad=np.radians(12.5)), 0)
    assert fed.take("COMMAND", b"\x01\x02", 0) == "{COMMAND=1}"
    wrong = "unreadable (damaged, or of another version): 1 COMMAND"
    keep = "to keep: 1.100 m, 10.0° to the right"
    measured = f"1.350 m, 12.5° to the left; {keep}"
    assert probe.ask("words", 1) == f"coasting; no tag in the picture; {measured}; {wrong}"
    fed.take("STATUS", robot_on_bus.status(text="coasting: no tag in the picture", status=2), 900)
    assert probe.ask("words", 901) == f"coasting; no tag in the picture; {keep}; {wrong}"  # measured 0.9 s ago
    silent = "no message for 3 s; the last: coasting: no tag in the picture"
    assert probe.ask("words", 4000) == f"{silent}; {keep}; {wrong}"


@pytest.mark.parametrize(
    ("strip", "values", "expected"),
    [
        ("SPEED", [], "-0.1 0.1"),  # the least that it shows
        ("SPEED", ["0.05", "NaN", "-0.02"], "-0.1 0.1"),
        ("LATENCY", ["33"], "0.0 50.0"),  # from zero, to the next round number
        ("DISTANCE_ERROR", ["-1340", "0"], "-1500.0 75.0"),  # one side, and a little of the other
        ("DISTANCE_ERROR", ["-1340", "200"], "-1500.0 1500.0"),
        ("LATENCY", ["99"], "0.0 150.0"),  # 2 % above the highest: 100.98 is more than 100
    ],
)
def test_an_axis_ends_at_round_numbers(probe, strip, values, expected):
    assert list(map(float, probe.ask("axis", strip, *values).split())) == pytest.approx(
        list(map(float, expected.split()))
    )


@pytest.mark.parametrize("size", [(40, 40), (480, 480), (700, 1000), (1900, 500)])
def test_a_window_of_any_size_can_be_painted(probe, size):
    Fed(probe).take("STATUS", robot_on_bus.with_lists(robot_on_bus.status(text="tracking"), strengths={31: 1.0}), 0)
    file = probe.folder / "painted.png"
    probe.ask("words", 0)
    assert probe.ask("paint", *size, file) == "ok"
    assert pixels_of(file).shape == (size[1], size[0], 3)
    if min(size) >= 480:
        assert (pixels_of(file) == LIT).all(axis=2).sum() > 50  # the rule that fires is there

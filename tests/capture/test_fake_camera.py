"""What the camera source makes of a Video4Linux camera that works, lies, falls silent or is pulled out."""

import errno
import io
import json
import subprocess
import sys
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fake_camera import NUMBER, FakeCamera

WIDTH, HEIGHT, RATE_HZ = 64, 48, 50
PERIOD_US = 1_000_000 // RATE_HZ
DEVICE = f"/dev/video{NUMBER}"


def scenes(count=5, seed=1):
    """Smooth pictures, each of another brightness, so that JPEG changes little."""
    rng = np.random.default_rng(seed)
    ramp = np.add.outer(np.arange(HEIGHT), np.arange(WIDTH))
    return [np.uint8(ramp + 20 * k + rng.integers(0, 3, ramp.shape)) for k in range(count)]


def jpeg_of(image, **options):
    file = io.BytesIO()
    Image.fromarray(image).save(file, "JPEG", quality=95, **options)
    return file.getvalue()


class Reader:
    """The program camera_reader.py with the camera loaded into it."""

    def __init__(self, camera, width=WIDTH, height=HEIGHT, rate_hz=RATE_HZ):
        program = Path(__file__).with_name("camera_reader.py")
        command = [*camera.prefix(), sys.executable, str(program), str(NUMBER), str(width), str(height), str(rate_hz)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.stdout.close()
        assert self.process.wait(10) == 0

    def request(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()

    def answer(self):
        return json.loads(self.process.stdout.readline())

    def open(self):
        self.request("open")
        return self.answer()

    def next(self):
        self.request("next")
        return self.answer()

    def frame(self):
        """The next one; there must be one within 20 calls."""
        for _ in range(20):
            answer = self.next()
            if "utime" in answer:
                return answer
            assert answer["why_ended"] == ""
        raise AssertionError("no frame")


def wait_until(condition, timeout_s=10.0):
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def opened(camera, **options):
    reader = Reader(camera, **options)
    described = reader.open()
    assert "described" in described, described
    return reader


@pytest.mark.parametrize("format", ["GREY", "YUYV", "UYVY", "NV12", "YU12"])
def test_every_format_gives_the_luma_bit_by_bit(tmp_path, format):
    images = scenes()
    camera = FakeCamera(tmp_path, {"scenes": images}, format=format, rate_hz=RATE_HZ)
    expected = {zlib.crc32(image.tobytes()) for image in images}
    assert len(expected) == len(images)
    with opened(camera) as reader:
        seen = {reader.frame()["checksum"] for _ in range(40)}
    assert seen == expected


def test_a_jpeg_gives_its_luma_whether_or_not_it_brings_the_usual_huffman_tables(tmp_path):
    """Cameras leave the tables (marker FFC4) out: Motion JPEG has them by convention."""
    image = scenes()[0]
    whole = jpeg_of(image)
    bare, place = b"", 2
    while whole[place + 1] != 0xDA:  # segment by segment to the start of the scan
        end = place + 2 + int.from_bytes(whole[place + 2 : place + 4], "big")
        bare += b"" if whole[place + 1] == 0xC4 else whole[place:end]
        place = end
    bare = whole[:2] + bare + whole[place:]
    assert len(bare) < len(whole) - 100
    camera = FakeCamera(tmp_path, {"whole": [image], "bare": [bare]}, format="MJPG", rate_hz=RATE_HZ)
    expected = zlib.crc32(np.asarray(Image.open(io.BytesIO(whole))).tobytes())
    with opened(camera) as reader:
        assert reader.frame()["checksum"] == expected
        camera.show("bare")
        for _ in range(3):  # the first may have been filled before
            answer = reader.frame()
        assert answer["checksum"] == expected


@pytest.mark.fault("camera_damaged_jpeg")
def test_a_jpeg_that_is_cut_off_is_a_frame_without_pixels(tmp_path):
    image = scenes()[0]
    cut = [jpeg_of(image)[:size] for size in (20, 400, len(jpeg_of(image)) // 2, len(jpeg_of(image)) - 30)]
    other_size = jpeg_of(image[:, : WIDTH // 2])
    camera = FakeCamera(tmp_path, {"bad": [image, *cut, other_size]}, format="MJPG", rate_hz=RATE_HZ)
    with opened(camera) as reader:
        frames = [reader.frame() for _ in range(60)]
    widths = [frame["width"] for frame in frames]
    assert set(widths) == {0, WIDTH}
    # Five of six; a reader that is held up may miss some.
    assert 3 * widths.count(WIDTH) < widths.count(0)


def test_the_age_is_counted_from_the_drivers_stamp_and_the_wall_clock_time_is_that_of_the_exposure(tmp_path):
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    camera.late_us = 150_000
    with opened(camera) as reader:
        frames = [reader.frame() for _ in range(20)]
    for frame in frames:
        assert frame["known_age_us"] >= 150_000
        assert 0 <= frame["wall_utime"] - (frame["utime"] + frame["known_age_us"]) < 1_000_000
    # And from nothing earlier: the best of twenty is taken within a period of being available.
    assert min(frame["known_age_us"] for frame in frames) < 150_000 + PERIOD_US
    gaps = np.diff([frame["utime"] for frame in frames])
    # Exposures are whole periods apart; the wall clock is read a few microseconds after the monotonic one.
    assert np.median(np.abs(gaps - PERIOD_US * np.rint(gaps / PERIOD_US))) < 1_000


STAMPED = ["the exposure", "nothing", "nothing", "the end of a picture"]


@pytest.mark.parametrize("stamp_kind", range(4))
def test_a_camera_says_what_its_stamps_mean(tmp_path, stamp_kind):
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    camera.stamp_kind = stamp_kind
    with Reader(camera) as reader:
        assert f", stamps {STAMPED[stamp_kind]}" in reader.open()["described"]


@pytest.mark.parametrize("stamp_kind", [0, 1, 2, 3])
@pytest.mark.fault("camera_old_buffers")
def test_buffers_that_waited_for_a_late_reader_are_as_old_as_they_are(tmp_path, stamp_kind):
    """Four buffers are filled, then the driver drops pictures. Whoever comes after d dropped pictures gets one that is
    older than (d - 1) periods. Without a stamp, what is known is that the queue was empty before."""
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    camera.stamp_kind = stamp_kind
    with opened(camera) as reader:
        reader.frame()
        resume_at = time.monotonic() + 30 * PERIOD_US / 1e6
        wait_until(lambda: time.monotonic() >= resume_at)
        late = reader.frame()
        assert camera.dropped >= 20
        assert camera.taken >= 5, "the old buffers must be drained"
        assert late["known_age_us"] >= (camera.dropped - 1) * PERIOD_US
        dropped = camera.dropped
        fresh = [reader.frame() for _ in range(9)]
    # The queue was drained: what comes next was taken after the dropped pictures, not a period later.
    assert fresh[0]["utime"] - late["utime"] >= (dropped - 2) * PERIOD_US
    # A reader in time gets them young (the best of nine: a loaded machine makes late readers).
    assert min(frame["known_age_us"] for frame in fresh) < 2 * PERIOD_US
    assert all(frame["known_age_us"] >= 0 for frame in fresh)


@pytest.mark.parametrize("shift_us", [-3_600_000_000, -1_000_000, 1_000_000, 3_600_000_000])
def test_stamps_that_are_wrong_are_passed_on_as_wrong_ages(tmp_path, shift_us):
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    camera.stamp_shift_us = shift_us
    with opened(camera) as reader:
        frame = reader.frame()
    assert -shift_us <= frame["known_age_us"] < -shift_us + 900_000
    assert abs(frame["utime"] + frame["known_age_us"] - frame["wall_utime"]) < 1_000_000


def test_what_was_taken_before_the_computer_slept_is_older_by_the_sleep(tmp_path):
    minute_us = 60_000_000
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    with opened(camera) as reader:
        assert reader.frame()["known_age_us"] < minute_us
        camera.slept_us = minute_us
        assert reader.frame()["known_age_us"] >= minute_us
        for _ in range(5):
            last = reader.frame()
        assert last["known_age_us"] < minute_us, "taken after it"


DAMAGE = {
    "marked as damaged": ("error_flag", 1),
    "too short": ("bytes_short", 1),
    "too long": ("bytes_short", -(10**7)),
}


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("format", ["GREY", "YUYV", "NV12"])
def test_a_buffer_that_is_not_whole_is_a_frame_without_pixels(tmp_path, format, damage):
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, format=format, rate_hz=RATE_HZ)
    with opened(camera) as reader:
        assert reader.frame()["width"] == WIDTH
        setattr(camera, *DAMAGE[damage])
        for _ in range(3):
            damaged = reader.frame()
        assert damaged["width"] == 0
        assert damaged["known_age_us"] >= 0
        camera.heal()
        for _ in range(3):
            whole = reader.frame()
        assert whole["width"] == WIDTH


def test_a_silent_camera_lets_the_reader_go_every_quarter_second_and_ends_after_two_seconds(tmp_path):
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    with opened(camera) as reader:
        reader.frame()
        camera.blocked = 1
        answers = []
        while not answers or not answers[-1]["why_ended"]:
            answers.append(reader.next())
            assert len(answers) < 60
        assert answers[-1]["why_ended"] == f"the camera {DEVICE} has given no picture for 2 s"
        silent = [answer for answer in answers if "utime" not in answer]
        assert len(silent) >= 4  # of 8 on an idle machine
        assert min(answer["waited_s"] for answer in silent[:-1]) >= 0.2
        assert "utime" not in reader.next(), "what has ended stays so"
        camera.blocked = 0
        assert "described" in reader.open()
        assert reader.frame()["width"] == WIDTH


@pytest.mark.fault("camera_unplugged")
def test_a_camera_that_is_pulled_out_ends_and_can_be_opened_when_it_is_back(tmp_path):
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    with opened(camera) as reader:
        reader.frame()
        camera.pulled_out = 1
        assert reader.next()["why_ended"] == f"the camera {DEVICE} has been pulled out"
        assert reader.open()["error"].startswith(f"there is no camera {DEVICE}; cameras here:")
        assert camera.closes == camera.opens == 1
        camera.pulled_out = 0
        assert "described" in reader.open()
        assert reader.frame()["width"] == WIDTH


def test_a_camera_that_is_pulled_out_while_it_is_waited_for_ends_at_once(tmp_path):
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    camera.blocked = 1
    with opened(camera) as reader:
        reader.request("next")
        camera.pulled_out = 1
        assert "has been pulled out" in reader.answer()["why_ended"]


def test_a_source_that_is_let_go_leaves_nothing_open(tmp_path):
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, rate_hz=RATE_HZ)
    with opened(camera) as reader:
        for count in range(2, 6):
            assert "described" in reader.open()
            assert (camera.opens, camera.closes) == (count, count - 1)
    assert camera.streaming == 0


@pytest.mark.parametrize(
    ("formats", "chosen"),
    [
        ([("MJPG", 30), ("YUYV", 30)], "YUYV"),  # uncompressed is better
        ([("YUYV", 30), ("GREY", 30)], "GREY"),  # and half the bytes
        ([("YUYV", 10), ("MJPG", 30)], "MJPG"),  # but not at a third of the rate
        ([("YUYV", 29), ("MJPG", 60)], "YUYV"),  # 29 Hz will do for 30
        ([("YUYV", 5), ("MJPG", 15)], "MJPG"),  # none is fast enough: the fastest
        ([("RGB3", 60), ("NV12", 30)], "NV12"),  # what cannot be read does not count
    ],
)
def test_the_best_format_that_reaches_the_rate_is_chosen(tmp_path, formats, chosen):
    table = [(name, WIDTH, HEIGHT, rate_hz) for name, rate_hz in formats]
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, formats=table)
    with Reader(camera, rate_hz=30) as reader:
        described = reader.open()["described"]
    assert described == f"camera {DEVICE} ({WIDTH}x{HEIGHT} {chosen}, 30 Hz, stamps the exposure)"


def test_a_camera_without_the_calibrations_size_is_refused_with_what_it_has(tmp_path):
    table = [("YUYV", 1280, 720, 30), ("MJPG", 1920, 1080, 30)]
    camera = FakeCamera(tmp_path, {"scenes": scenes()}, formats=table)
    with Reader(camera) as reader:
        error = reader.open()["error"]
    assert "gives YUYV 1280x720, MJPG 1920x1080, the calibration is for 64x48" in error
    assert f"v4l2-ctl --device {DEVICE} --list-formats-ext" in error
    assert camera.closes == camera.opens == 1


REFUSALS = {
    "not mine": ({"open_errno": errno.EACCES}, "add yourself to the group 'video'"),
    "taken": ({"open_errno": errno.EBUSY}, "in use by another program"),
    "streams for another": ({"stream_errno": errno.EBUSY}, "another program may be using it"),
    "bus full": ({"stream_errno": errno.ENOSPC}, "bandwidth"),
    "breaks its word": ({"granted_width": 32}, "gives 32x48 after it had promised 64x48"),
}


@pytest.mark.parametrize("refusal", REFUSALS)
def test_a_camera_that_cannot_be_used_says_what_to_do(tmp_path, refusal):
    faults, text = REFUSALS[refusal]
    camera = FakeCamera(tmp_path, {"scenes": scenes()})
    for name, value in faults.items():
        setattr(camera, name, value)
    with Reader(camera) as reader:
        assert text in reader.open()["error"]
        assert camera.closes == camera.opens
        camera.heal()
        assert "described" in reader.open()

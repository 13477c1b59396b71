import struct

import lcm
import numpy as np
import pytest

from bench.common import wire
from pilotfish import bus, core
from pilotfish.lcmtypes.pilotfish import command_t

SYNC = b"\xed\xa1\xda\x01"
HOSTILE_LENGTHS = [2**31 - 1, 2**31, 2**32 - 1, 10**6]


def picture(number):
    return np.full((16, 24), number, np.uint8)


def event(channel, data, *, number=0, claimed_length=None):
    length = len(data) if claimed_length is None else claimed_length
    return SYNC + struct.pack(">qqII", number, number, len(channel), length) + channel + data


def image_event(number):
    return event(b"IMAGE", wire.encode_image(picture(number), utime=1000 * number))


def gray_levels(reader):
    """Which pictures came; None for one without pixels."""
    return [int(frame.image[0, 0]) if frame.width else None for frame in reader]


def test_a_log_of_pypis_lcm_is_read_with_its_pictures_and_times(tmp_path):
    path = tmp_path / "run.lcm"
    log = lcm.EventLog(str(path), "w", overwrite=True)
    for k in range(5):
        log.write_event(10**15 + k, "IMAGE", wire.encode_image(picture(k), utime=1000 * k, jpeg=k % 2 == 1))
        log.write_event(10**15 + k, "R1_COMMAND", command_t().encode())
    log.close()
    reader = bus.LogReader(str(path), channel="IMAGE")
    assert (len(reader), reader.damaged) == (5, 0)
    frames = list(reader)
    assert [frame.utime for frame in frames] == [0, 1000, 2000, 3000, 4000]
    for k, frame in enumerate(frames):
        np.testing.assert_array_equal(frame.image, picture(k))  # flat pictures survive JPEG exactly
    assert reader.next() is None


def test_a_corrupt_picture_comes_without_pixels_just_after_the_one_before(tmp_path):
    path = tmp_path / "run.lcm"
    log = lcm.EventLog(str(path), "w", overwrite=True)
    good = wire.encode_image(picture(7), utime=1000)
    for data in [good, good[:-1], b"", b"junk" * 20, wire.encode_image(picture(8), utime=2000)]:
        log.write_event(10**15, "IMAGE", data)
    log.close()
    frames = list(bus.LogReader(str(path), channel="IMAGE"))
    assert [frame.width for frame in frames] == [24, 0, 0, 0, 24]
    assert [frame.utime for frame in frames] == [1000, 1001, 1002, 1003, 2000]
    assert frames[1].defect == core.Reason.frame_too_small


@pytest.mark.parametrize("length", HOSTILE_LENGTHS)
def test_an_event_that_claims_more_than_the_file_holds_is_skipped(tmp_path, length):
    path = tmp_path / "run.lcm"
    hostile = event(b"IMAGE", b"x" * 50, claimed_length=length)
    path.write_bytes(image_event(1) + hostile + image_event(2))
    reader = bus.LogReader(str(path), channel="IMAGE")
    assert (gray_levels(reader), reader.damaged) == ([1, 2], 1)


def test_damage_of_any_length_is_skipped(tmp_path):
    """Lengths around the size of the blocks in which the sync word is looked for."""
    path = tmp_path / "run.lcm"
    for length in [1, 3, 27, 28, 29, *range(248, 264), *range(755, 775), *range(65530, 65545), 131069, 131072]:
        # 0xED is the sync word's first byte: a false start at every place.
        path.write_bytes(image_event(1) + b"\xed" * length + image_event(2))
        reader = bus.LogReader(str(path), channel="IMAGE")
        assert (gray_levels(reader), reader.damaged) == ([1, 2], 1), length


def test_a_log_cut_off_anywhere_gives_all_whole_events_before_the_cut(tmp_path):
    path = tmp_path / "run.lcm"
    one = image_event(1)
    whole = one + image_event(2)
    for length in range(len(one), len(whole)):
        path.write_bytes(whole[:length])
        reader = bus.LogReader(str(path), channel="IMAGE")
        assert gray_levels(reader) == [1]
        assert reader.damaged == (length > len(one))


def test_random_damage_never_breaks_the_reader(tmp_path):
    rng = np.random.default_rng(3)
    path = tmp_path / "run.lcm"
    log = b"".join(image_event(k) for k in range(1, 6))
    for _ in range(300):
        damaged = bytearray(log)
        for _ in range(rng.integers(1, 6)):
            damaged[rng.integers(len(log))] = rng.integers(256)
        path.write_bytes(damaged)
        try:
            levels = gray_levels(bus.LogReader(str(path), channel="IMAGE"))
        except bus.BusError:
            continue  # no event left on the channel
        assert len(levels) <= 5


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "cannot read the LCM log"),
        (b"", "cannot read the LCM log"),
        (b"words\n" * 99, "is not an LCM log"),
    ],
)
def test_a_file_that_is_no_log_is_refused(tmp_path, content, says):
    path = tmp_path / "run.lcm"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(bus.BusError, match=says):
        bus.LogReader(str(path), channel="IMAGE")


def test_a_channel_that_is_not_in_the_log_is_refused_with_those_that_are(tmp_path):
    path = tmp_path / "run.lcm"
    path.write_bytes(image_event(1) + event(b"R1_POSE", b"") + image_event(2))
    with pytest.raises(bus.BusError, match=r"no messages on channel R9_IMAGE; it has: IMAGE \(2\), R1_POSE \(1\)"):
        bus.LogReader(str(path), channel="R9_IMAGE")


def test_a_file_as_large_as_a_disk_that_is_no_log_is_refused_at_once(tmp_path):
    """A sparse file: 1 TB of zeros. At 1 GB/s it would take a quarter of an hour to read."""
    path = tmp_path / "disk.img"
    with path.open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(bus.BusError, match="is not an LCM log"):
        bus.LogReader(str(path), channel="IMAGE")


def test_a_log_with_80_mb_of_damage_behind_its_first_message_goes_on(tmp_path):
    path = tmp_path / "run.lcm"
    with path.open("wb") as file:
        file.write(image_event(1))
        file.seek(80 << 20)
        file.write(image_event(2))
    reader = bus.LogReader(str(path), channel="IMAGE")
    assert (gray_levels(reader), reader.damaged) == ([1, 2], 1)

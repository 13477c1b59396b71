"""A picture that is cut off is no picture: what a decoder makes up for the missing part could hold a tag of nowhere."""

import io
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pilotfish import capture

ENCODINGS = {
    "jpg": {"format": "JPEG", "quality": 95},
    "progressive jpg": {"format": "JPEG", "progressive": True},
    "png": {"format": "PNG"},
    "pgm": {"format": "PPM"},
    "bmp": {"format": "BMP"},
    "tif": {"format": "TIFF"},
    "lzw tif": {"format": "TIFF", "compression": "tiff_lzw"},
    "deflate tif": {"format": "TIFF", "compression": "tiff_adobe_deflate"},
    "jpeg tif": {"format": "TIFF", "compression": "jpeg"},
    "webp": {"format": "WEBP", "quality": 80},
    "lossless webp": {"format": "WEBP", "lossless": True},
}


def picture(mode, seed=3):
    colours = np.random.default_rng(seed).integers(0, 256, (48, 64, 3), dtype=np.uint8)
    return Image.fromarray(colours).convert(mode)


def encoded(mode, **options):
    stream = io.BytesIO()
    picture(mode).save(stream, **options)
    return stream.getvalue()


def read(folder, *files):
    """The pictures of a folder with these contents, None for one without pixels."""
    for k, data in enumerate(files):
        (folder / f"{k}.png").write_bytes(data)  # named alike: the content decides
    return [frame.image.copy() if frame.width else None for frame in capture.open_images(str(folder))]


@pytest.mark.parametrize("mode", ["L", "RGB"])
@pytest.mark.parametrize("options", ENCODINGS.values(), ids=ENCODINGS)
def test_a_cut_off_picture_comes_without_pixels_or_whole(tmp_path, options, mode):
    """Whole, because a few formats end with bytes that say nothing about the pixels (a padding, a name)."""
    data = encoded(mode, **options)
    ends = sorted({len(data) * k // 40 for k in range(1, 40)} | {len(data) - k for k in (1, 2, 3, 8)})
    whole, *cut = read(tmp_path, data, *(data[:end] for end in ends))
    assert whole is not None
    for end, image in zip(ends, cut, strict=True):
        assert image is None or np.array_equal(image, whole), f"{end} of {len(data)} bytes gave another picture"
    assert sum(image is None for image in cut) >= len(cut) - 3


@pytest.mark.parametrize("options", [ENCODINGS["jpg"], ENCODINGS["progressive jpg"]], ids=["baseline", "progressive"])
@pytest.mark.fault("picture_cut_off")
def test_every_truncation_of_a_jpeg_comes_without_pixels(tmp_path, options):
    data = encoded("L", **options)
    assert read(tmp_path, *(data[:end] for end in range(0, len(data), 7))) == [None] * len(range(0, len(data), 7))


@pytest.mark.fault("picture_cut_off")
def test_a_jpeg_that_ends_in_its_middle_comes_without_pixels(tmp_path):
    """An end marker where data should be. (Damage that is a valid code is another picture: no decoder can tell.)"""
    data = encoded("L", format="JPEG", quality=95)
    ended = [data[:at] + b"\xff\xd9" + data[at + 2 :] for at in range(len(data) // 2, len(data) - 200, 61)]
    assert read(tmp_path, *ended) == [None] * len(ended)


def test_a_jpeg_whose_header_promises_more_than_it_holds_costs_nothing(tmp_path):
    data = encoded("L", format="JPEG")
    at = data.index(b"\xff\xc0") + 5
    bomb = data[:at] + b"\x40\x00\x40\x00" + data[at + 4 :]  # 16384 x 16384
    assert read(tmp_path, bomb) == [None]


@pytest.mark.parametrize(
    "options",
    [
        {"quality": 95},
        {"quality": 40},
        {"progressive": True},
        {"quality": 95, "subsampling": 0},
        {"quality": 95, "subsampling": 2},
        {"quality": 95, "restart_marker_rows": 1},
        {"quality": 95, "optimize": True},
    ],
    ids=str,
)
@pytest.mark.parametrize("mode", ["L", "RGB"])
def test_a_whole_jpeg_comes_as_the_luma_that_was_coded_bit_for_bit(tmp_path, options, mode):
    """As OpenCV gave it, and as libjpeg gives it in gray through Pillow's draft mode: the very Y samples, so that
    no rounding of BT.601 comes in between."""
    data = encoded(mode, format="JPEG", **options)
    luma = Image.open(io.BytesIO(data))
    luma.draft("L", luma.size)
    (image,) = read(tmp_path, data)
    np.testing.assert_array_equal(image, np.asarray(luma.convert("L")))


def test_what_is_no_regular_file_is_left_out_of_a_folder_without_waiting_for_it(tmp_path):
    os.mkfifo(tmp_path / "1.png")
    (tmp_path / "2.png").symlink_to("2.png")
    (tmp_path / "3.png").symlink_to("/dev/zero")
    (frame,) = read(tmp_path, encoded("L", format="PNG"))
    assert frame is not None


@pytest.mark.parametrize(
    "make",
    [os.mkfifo, Path.mkdir, lambda path: path.symlink_to("/dev/zero"), lambda path: path.symlink_to("frames.csv")],
    ids=["pipe", "folder", "device", "circle"],
)
def test_a_list_that_is_no_file_is_refused(tmp_path, make):
    (tmp_path / "1.png").write_bytes(encoded("L", format="PNG"))
    make(tmp_path / "frames.csv")
    with pytest.raises(capture.CaptureError, match=r"frames\.csv"):
        capture.open_images(str(tmp_path))


@pytest.mark.parametrize("number", ["5abc", "5.0", "0x10", "1e3", " ", "--5", "+-5", "99999999999999999999", "nan"])
def test_a_time_that_is_not_all_number_is_refused_with_its_line(tmp_path, number):
    (tmp_path / "1.png").write_bytes(encoded("L", format="PNG"))
    (tmp_path / "frames.csv").write_text(f"file,utime_us\n1.png,{number}\n")
    with pytest.raises(capture.CaptureError, match=r"line 2: '.*' is not a whole number of microseconds"):
        capture.open_images(str(tmp_path))

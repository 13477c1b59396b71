import numpy as np
import pytest
from PIL import Image

from pilotfish import capture, core


def flat(level, height=20, width=32):
    return np.full((height, width), level, np.uint8)


def save(path, image, **options):
    Image.fromarray(image).save(path, **options)


def gray_levels(source):
    """Which pictures came; None for one without pixels."""
    return [int(frame.image[0, 0]) if frame.width else None for frame in source]


def open_images(folder, **options):
    return capture.open_images(folder, **options)


def test_pictures_come_in_the_natural_order_of_their_names(tmp_path):
    stems = ["2", "10", "a1b9", "a1b10", "a01b11", "a2", "img7", "img07b", "img8"]
    for level, stem in enumerate(stems):
        save(tmp_path / f"{stem}.png", flat(level))
    assert gray_levels(open_images(tmp_path)) == list(range(len(stems)))


def test_pictures_are_one_period_apart_and_rounding_does_not_add_up(tmp_path):
    for k in range(61):
        save(tmp_path / f"{k}.png", flat(k))
    utimes = [frame.utime for frame in open_images(tmp_path, frame_rate_hz=30)]
    # k/30 s in whole microseconds: 33333, 66667, 100000, ... and exactly two seconds for the sixtieth.
    assert utimes == [round(k * 1e6 / 30) for k in range(61)]
    assert utimes[60] == 2_000_000


def test_frames_csv_gives_order_and_times(tmp_path):
    for level in range(4):
        save(tmp_path / f"{level}.png", flat(level))
    (tmp_path / "frames.csv").write_text(
        "utime_us, distance_m, file\n1000000,2.4,3.png\n1033000,2.3, 0.png\r\n\n1099000,2.2,1.png\n"
    )
    source = open_images(tmp_path)
    assert source.describe() == f"images in {tmp_path} (3 pictures, times from frames.csv)"
    frames = list(source)
    assert [frame.utime for frame in frames] == [1_000_000, 1_033_000, 1_099_000]
    assert [int(frame.image[0, 0]) for frame in frames] == [3, 0, 1]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "line 1: is empty"),
        ("file,time\n1.png,5\n", "line 1: there is no column 'utime_us'"),
        ("name,utime_us\n1.png,5\n", "line 1: there is no column 'file'"),
        ("file,utime_us\n1.png,5\n1.png,5.5\n", "line 3: '5.5' is not a whole number of microseconds"),
        ("file,utime_us\n1.png,\n", "line 2: '' is not a whole number"),
        (
            "file,utime_us\n1.png,99999999999999999999\n",
            "line 2: '99999999999999999999' is not a whole number",
        ),
        ("file,utime_us\n1.png\n", "line 2: there are 1 fields, the header has 2"),
        ("file,utime_us\n9.png,5\n", "line 2: there is no file"),
        ("file,utime_us\n", "there are no pictures in"),
    ],
)
def test_a_wrong_frames_csv_is_refused_with_its_line(tmp_path, text, says):
    save(tmp_path / "1.png", flat(1))
    (tmp_path / "frames.csv").write_text(text)
    with pytest.raises(capture.CaptureError, match=says):
        open_images(tmp_path)


def test_a_picture_that_cannot_be_decoded_comes_without_pixels_in_its_place(tmp_path):
    save(tmp_path / "1.png", flat(1))
    (tmp_path / "2.png").write_bytes(b"no picture")
    (tmp_path / "3.png").write_bytes((tmp_path / "1.png").read_bytes()[:60])
    (tmp_path / "4.png").write_bytes(b"")
    save(tmp_path / "5.png", flat(5))
    frames = list(open_images(tmp_path, frame_rate_hz=10))
    assert [frame.width for frame in frames] == [32, 0, 0, 0, 32]
    assert [frame.utime for frame in frames] == [0, 100_000, 200_000, 300_000, 400_000]
    assert frames[1].defect == core.Reason.frame_too_small


def test_what_is_no_picture_is_left_out(tmp_path):
    save(tmp_path / "1.PNG", flat(1))
    save(tmp_path / ".hidden.png", flat(2))
    (tmp_path / "notes.txt").write_text("words")
    (tmp_path / "cMo_1.txt").write_text("1 0 0 0")
    (tmp_path / "folder.png").mkdir()
    assert gray_levels(open_images(tmp_path)) == [1]


@pytest.mark.parametrize("suffix", ["png", "pgm", "bmp", "tif"])
def test_gray_pictures_come_bit_for_bit(tmp_path, suffix):
    image = np.random.default_rng(1).integers(0, 256, (33, 47), dtype=np.uint8)
    save(tmp_path / f"1.{suffix}", image)
    (frame,) = open_images(tmp_path)
    np.testing.assert_array_equal(frame.image, image)


@pytest.mark.parametrize("mode", ["RGB", "RGBA"])
def test_colours_become_luma(tmp_path, mode):
    colours = Image.fromarray(np.random.default_rng(1).integers(0, 256, (33, 47, 3), dtype=np.uint8))
    colours.convert(mode).save(tmp_path / "1.png")
    (frame,) = open_images(tmp_path)
    # Both are BT.601; OpenCV rounds its weights to 14 or 15 bits, Pillow to 16: they may differ by one level.
    np.testing.assert_allclose(frame.image.astype(int), np.asarray(colours.convert("L")).astype(int), atol=1)


def test_sixteen_bits_become_the_upper_eight(tmp_path):
    image = np.arange(20 * 3200, dtype=np.uint16).reshape(20, 3200)
    save(tmp_path / "1.png", image)
    (frame,) = open_images(tmp_path)
    np.testing.assert_allclose(frame.image, image / 257.0, atol=1.0)


def test_a_picture_comes_as_the_sensor_gave_it_however_the_camera_was_held(tmp_path):
    exif = Image.Exif()
    exif[0x0112] = 6  # Orientation: viewers turn it by 90 degrees
    save(tmp_path / "1.jpg", flat(100, height=20, width=32), exif=exif)
    (frame,) = open_images(tmp_path)
    assert (frame.width, frame.height) == (32, 20)


def test_a_folder_is_not_live_and_describes_itself(tmp_path):
    save(tmp_path / "1.png", flat(1))
    source = open_images(tmp_path, frame_rate_hz=15)
    assert not source.live
    assert source.describe() == f"images in {tmp_path} (1 pictures, 15 Hz)"
    assert source.next().width == 32
    assert source.next() is None
    assert source.next() is None


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan"), float("inf")])
def test_an_impossible_frame_rate_is_refused(tmp_path, rate):
    save(tmp_path / "1.png", flat(1))
    with pytest.raises(capture.CaptureError, match="frame rate of pictures must be positive"):
        open_images(tmp_path, frame_rate_hz=rate)


def test_a_folder_that_is_missing_or_empty_is_refused(tmp_path):
    with pytest.raises(capture.CaptureError, match=r"there is no folder .*nowhere"):
        open_images(tmp_path / "nowhere")
    with pytest.raises(capture.CaptureError, match="there are no pictures in"):
        open_images(tmp_path)
    (tmp_path / "file").write_text("words")
    with pytest.raises(capture.CaptureError, match=r"there is no folder .*file"):
        open_images(tmp_path / "file")

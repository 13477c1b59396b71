from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pilotfish import capture


def pictures(count):
    rng = np.random.default_rng(5)
    return [rng.integers(0, 256, (48, 64), dtype=np.uint8) for _ in range(count)]


def save_gif(path, images, period_ms):
    """A video that Pillow can write and that loses nothing: 256 gray levels are a GIF's palette."""
    first, *others = [Image.fromarray(image) for image in images]
    first.save(path, save_all=True, append_images=others, duration=period_ms, optimize=False)


def test_a_video_comes_with_its_pictures_and_its_own_times(tmp_path):
    path, images = tmp_path / "run.gif", pictures(6)
    save_gif(path, images, period_ms=40)
    source = capture.open_video(str(path))
    assert not source.live
    assert source.describe().startswith(f"video {path} (64x48, 25")
    frames = list(source)
    assert [frame.utime for frame in frames] == [40_000 * k for k in range(6)]
    for frame, image in zip(frames, images, strict=True):
        np.testing.assert_array_equal(frame.image, image)
    assert source.next() is None


def test_frames_of_a_video_stay_as_they_are_when_later_ones_are_read(tmp_path):
    path, images = tmp_path / "run.gif", pictures(4)
    save_gif(path, images, period_ms=40)
    source = capture.open_video(str(path))
    first = source.next()
    while source.next():
        pass
    np.testing.assert_array_equal(first.image, images[0])


def test_a_file_that_is_no_video_is_refused(tmp_path):
    with pytest.raises(capture.CaptureError, match="there is no video file"):
        capture.open_video(str(tmp_path / "nothing.avi"))
    words = tmp_path / "words.avi"
    words.write_text("no video " * 100)
    with pytest.raises(capture.CaptureError, match=r"cannot decode the video .*words\.avi"):
        capture.open_video(str(words))


def test_a_camera_that_is_missing_is_refused_with_those_that_are_there():
    index = next(i for i in range(90, 200) if not Path(f"/dev/video{i}").exists())
    present = " ".join(map(str, Path("/dev").glob("video*"))) or "none"
    with pytest.raises(capture.CaptureError) as refusal:
        capture.open_camera(index, width=640, height=480)
    text = str(refusal.value)
    assert text.startswith(f"there is no camera /dev/video{index}; cameras here: ")
    assert set(text.rpartition(": ")[2].split()) == set(present.split())

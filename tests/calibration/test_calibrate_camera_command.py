"""``pilotfish calibrate camera`` from pictures, a film and a camera to the file that a coordinator reads."""

import re
import shutil
import signal
import subprocess
import sys

import cv2
import numpy as np
import pytest
from board_views import CHARUCO, SIZE
from rendered_boards import TrueCamera, poses, render
from typer.testing import CliRunner

from fake_camera import NUMBER, FakeCamera, built
from pilotfish import coordinator
from pilotfish.calibration.board import write_board
from pilotfish.calibration.camera import (
    BoardDetector,
    Lens,
    check_film,
    worthwhile_pictures,
    write_calibration,
)
from pilotfish.calibration.camera.calibration_file import calibration_text
from pilotfish.calibration.camera.choosing import CHOSEN, KNOWN, MOVED, NOTHING, Chosen, Corners, consider
from pilotfish.calibration.camera.pictures import VIDEO, Picture, Pictures
from pilotfish.cli import app
from pilotfish.errors import CalibrationError, ConfigError

BOARD = "charuco:8x6:30mm:22mm"
CAMERA = TrueCamera()
PINHOLE = Lens("pinhole", *SIZE, 602.0, 598.5, 324.3, 236.1, (-0.3, 0.1, 0.001, -0.002, 0.03))
FISHEYE = Lens("fisheye", *SIZE, 250.0, 249.0, 324.3, 236.1, (-0.02, 0.004, -0.001, 0.0))


@pytest.fixture(scope="module")
def images():
    return [render(CHARUCO, CAMERA, pose, seed=k) for k, pose in enumerate(poses(CHARUCO, CAMERA, 18, seed=11))]


@pytest.fixture(scope="module")
def folder(images, tmp_path_factory):
    pictures = tmp_path_factory.mktemp("pictures")
    for k, image in enumerate(images):
        cv2.imwrite(str(pictures / f"{k}.png"), image)
    return pictures


@pytest.fixture(scope="module")
def few(folder, tmp_path_factory):
    """Five of them, for what is not about the calibration itself."""
    pictures = tmp_path_factory.mktemp("few")
    for k in range(5):
        shutil.copy(folder / f"{k}.png", pictures)
    return pictures


def run(*arguments):
    result = CliRunner().invoke(app, ["calibrate", "camera", *map(str, arguments)])
    return result, re.sub(r"[\s│]+", " ", re.sub(r"\x1b\[[0-9;]*m", "", result.output))


def test_pictures_become_a_calibration_that_the_coordinator_reads(folder, tmp_path):
    write_board(CHARUCO, tmp_path / "board.yaml")
    out, report = tmp_path / "new" / "camera.yaml", tmp_path / "report"
    command = [sys.executable, "-m", "pilotfish", "calibrate", "camera", folder, "--board", tmp_path / "board.yaml"]
    done = subprocess.run([*command, "--out", out, "--report", report], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "verdict:" in done.stdout and f"wrote {out}" in done.stdout
    model = coordinator.load_calibration(str(out))
    assert (model.width, model.height) == SIZE
    assert [model.fx, model.fy] == pytest.approx([CAMERA.fx, CAMERA.fy], rel=5e-4)
    assert [model.cx, model.cy] == pytest.approx([CAMERA.cx, CAMERA.cy], abs=0.5)
    assert sorted(file.name for file in report.iterdir()) == ["coverage.png", "distortion.png", "residuals.png"]
    # OpenCV reads it, too.
    storage = cv2.FileStorage(str(out), cv2.FILE_STORAGE_READ)
    assert storage.getNode("camera_matrix").mat()[0, 0] == model.fx
    assert int(storage.getNode("image_width").real()) == 640


def test_what_is_left_out_is_said_and_why(folder, images, tmp_path):
    pictures = tmp_path / "some"
    shutil.copytree(folder, pictures)
    (pictures / "98.png").write_bytes(b"no picture")
    cv2.imwrite(str(pictures / "99.png"), images[0][:, ::-1])
    cv2.imwrite(str(pictures / "97.png"), cv2.GaussianBlur(images[1], (0, 0), 1.8))
    result, said = run(pictures, "--board", BOARD)
    assert result.exit_code == 0, said
    assert "left out 98.png: unreadable" in said
    assert "left out 99.png: mirrored" in said
    assert "left out 97.png: blurred" in said


def test_a_picture_of_another_size_is_named(few, images, tmp_path):
    pictures = tmp_path / "some"
    shutil.copytree(few, pictures)
    cv2.imwrite(str(pictures / "50.png"), images[0][:240, :320])
    result, said = run(pictures, "--board", BOARD)
    assert result.exit_code == 65
    assert "50.png has 320x240 px, 0.png has 640x480" in said


def test_a_bad_calibration_is_not_written_unless_wanted(few, tmp_path):
    out = tmp_path / "camera.yaml"
    result, said = run(few, "--board", BOARD, "--out", out)
    assert (result.exit_code, out.exists()) == (65, False), said
    assert "verdict: do again" in said and "5 views were used" in said
    result, said = run(few, "--board", BOARD, "--out", out, "--anyway")
    assert (result.exit_code, out.exists()) == (65, True), said


@pytest.mark.parametrize(
    ("arguments", "exit_code", "wrong"),
    [
        (["nowhere", "--board", BOARD], 66, "no such file or folder; a camera is spelled camera:0"),
        (["PICTURES", "--board", "charuco:8x6:30:22"], 64, "lengths end in mm, cm or m"),
        (["PICTURES", "--board", "charuco:1x6:30mm:22mm"], 64, "board.columns: 1; allowed"),
        (["PICTURES", "--board", "no_board.yaml"], 66, "no_board.yaml"),
        (["PICTURES", "--board", "charuco:7x5:30mm:22mm"], 65, "another board"),
        (["PICTURES", "--board", BOARD, "--size", "640"], 64, "WIDTHxHEIGHT"),
        (["PICTURES", "--board", BOARD, "--views", "3"], 64, "3 is not allowed; from 4 to 500 is"),
        (["PICTURES", "--board", BOARD, "--model", "mirror"], 64, "pinhole"),
        (["EMPTY", "--board", BOARD], 65, "no picture in this folder"),
        (["PICTURES/0.png", "--board", BOARD], 65, "one picture is not enough"),
        (["camera:93", "--board", BOARD], 69, "/dev/video93"),
    ],
)
def test_what_is_wrong_is_said(few, tmp_path, arguments, exit_code, wrong):
    (tmp_path / "empty").mkdir()
    arguments = [each.replace("PICTURES", str(few)).replace("EMPTY", str(tmp_path / "empty")) for each in arguments]
    result, said = run(*arguments)
    assert (result.exit_code, wrong in said) == (exit_code, True), said


def test_without_opencv_it_says_how_to_get_it(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "cv2", None)
    result, said = run(folder, "--board", BOARD)
    assert result.exit_code == 69
    assert "pip install 'pilotfish[calibrate]'" in said


def test_a_written_lens_is_read_to_the_last_bit(tmp_path):
    model = write_calibration(tmp_path / "camera.yaml", PINHOLE, ["a remark: {of} any kind"])
    read = [model.fx, model.fy, model.cx, model.cy, model.k1, model.k2, model.p1, model.p2, model.k3]
    assert read == PINHOLE.values.tolist()


def test_a_written_fisheye_is_read_as_the_lens_it_is(tmp_path):
    model = write_calibration(tmp_path / "camera.yaml", FISHEYE)
    seen = FISHEYE.project(np.array([[0.5, 0.2, 1.0]]), np.zeros(3), np.zeros(3))[0]
    assert model.project([0.5, 0.2, 1.0]) == pytest.approx(seen, abs=1e-6)


def test_a_lens_that_the_reader_reads_otherwise_is_not_written(tmp_path, monkeypatch):
    monkeypatch.setattr(
        "pilotfish.calibration.camera.calibration_file.calibration_text",
        lambda lens, remarks=(): calibration_text(PINHOLE).replace("0.001", "0.002"),
    )
    with pytest.raises(ConfigError, match="reads this pinhole lens differently"):
        write_calibration(tmp_path / "other.yaml", PINHOLE)
    assert not (tmp_path / "other.yaml").exists()


def corners(x_px, y_px=100.0):
    ids = np.arange(12)
    return Corners(ids, np.stack([x_px + 20.0 * (ids % 4), y_px + 20.0 * (ids // 4)], axis=1))


def test_of_a_film_a_view_is_taken_once_when_the_board_is_still_and_new():
    nothing = Corners(np.zeros(0, dtype=int), np.zeros((0, 2)))
    seen = [corners(100), corners(120), corners(120.5), corners(121), nothing, corners(121), corners(300), corners(300)]
    chosen, outcomes = Chosen(), []
    for each in seen:
        chosen, outcome = consider(chosen, each, 640)
        outcomes.append(outcome)
    assert outcomes == [MOVED, MOVED, CHOSEN, KNOWN, NOTHING, MOVED, MOVED, CHOSEN]
    assert len(chosen.views) == 2


def test_of_a_film_the_worthwhile_pictures_are_taken(images):
    frames = [Picture(f"frame {k}", image) for k, image in enumerate(np.repeat(images[:6], 3, axis=0))]
    frames.insert(4, Picture("damaged", None))
    found = worthwhile_pictures(Pictures(VIDEO, None, iter(frames)), BoardDetector(CHARUCO), wanted=4)
    assert len(found.usable) == 4
    assert [view.name for view in found.usable][:2] == ["frame 1", "frame 4"]
    assert found.outcomes[CHOSEN] == 4


def test_a_film_in_which_the_board_never_stands_still_says_so(images):
    frames = [Picture(f"frame {k}", image) for k, image in enumerate(images[:6])]
    found = worthwhile_pictures(Pictures(VIDEO, None, iter(frames)), BoardDetector(CHARUCO), wanted=4)
    with pytest.raises(CalibrationError, match=r"6 pictures \(6 moving\) gave 0 views .* hold the board still"):
        check_film(found)


def test_a_film_file_becomes_a_calibration(images, tmp_path):
    film = tmp_path / "board.avi"
    writer = cv2.VideoWriter(str(film), cv2.VideoWriter_fourcc(*"MJPG"), 15, SIZE)
    for image in np.repeat(images, 2, axis=0):
        writer.write(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR))
    writer.release()
    result, said = run(film, "--board", BOARD, "--out", tmp_path / "camera.yaml")
    assert result.exit_code == 0, said
    assert coordinator.load_calibration(str(tmp_path / "camera.yaml")).fx == pytest.approx(CAMERA.fx, rel=5e-4)


def test_ctrl_c_ends_a_film_with_what_there_is(images):
    def frames():
        yield from (Picture(f"frame {k}", image) for k, image in enumerate(np.repeat(images[:3], 2, axis=0)))
        raise KeyboardInterrupt

    found = worthwhile_pictures(Pictures(VIDEO, None, frames()), BoardDetector(CHARUCO), wanted=40)
    assert len(found.usable) == 3


def test_a_running_camera_is_calibrated_until_it_is_good_or_ctrl_c(images, tmp_path):
    if not built("libfake_camera.so").exists():
        pytest.skip("the simulated camera is not built")
    rng = np.random.default_rng(1)
    series = [
        np.clip(image + rng.normal(0.0, 1.0, image.shape), 0, 255).astype(np.uint8)
        for image in images
        for _ in range(8)
    ]
    camera = FakeCamera(tmp_path, {"board": series}, rate_hz=15)
    out = tmp_path / "camera.yaml"
    command = [sys.executable, "-u", "-m", "pilotfish", "calibrate", "camera", f"camera:{NUMBER}", "--board", BOARD]
    command += ["--rate-hz", "15", "--out", str(out)]
    with subprocess.Popen(
        [*camera.prefix(), *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        said = []
        for line in process.stdout:
            said.append(line)
            if line.startswith("view 12:"):
                process.send_signal(signal.SIGINT)
                break
        rest, errors = process.communicate(timeout=120)
    text = "".join(said) + rest
    assert "next:" in text, errors
    assert "verdict:" in text and "pictures:" in text, text + errors
    if "do again" not in text:
        assert coordinator.load_calibration(str(out)).fx == pytest.approx(CAMERA.fx, rel=2e-3)

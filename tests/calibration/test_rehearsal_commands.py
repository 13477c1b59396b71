"""`pilotfish render board`, `mounting`, `body`, and --truth; docs/calibrating-a-camera.md's run is in tests/docs."""

import math
import re
import sys

import cv2
import numpy as np
import pytest
from board_views import CHARUCO, CHESSBOARD
from rendered_boards import TrueCamera, TrueFisheye
from turning_bodies import FIVE, tag
from typer.testing import CliRunner

from pilotfish import coordinator, core
from pilotfish import data as shipped
from pilotfish.calibration.board import Board, write_board
from pilotfish.calibration.body import write_leader_body
from pilotfish.calibration.camera import board_of
from pilotfish.calibration.camera.board_spelling import spelled
from pilotfish.calibration.rehearsal import (
    BoardPose,
    body_differences,
    camera_differences,
    mounting_differences,
    read_true_camera,
    read_true_mounting,
    write_true_camera,
    write_true_mounting,
)
from pilotfish.calibration.rehearsal import (
    TrueCamera as Truth,
)
from pilotfish.calibration.rehearsal.board_poses import rotation
from pilotfish.cli import app
from pilotfish.errors import ConfigError

CALIBRATION = str(shipped.path("calibrations/sim_640x480.yaml"))
CONFIG = str(shipped.path("config/coordinator.yaml"))
SMALL = ["--fov-deg", "60", "--size", "160x120"]


def run(*arguments):
    result = CliRunner().invoke(app, [*map(str, arguments)])
    return result, re.sub(r"[\s│]+", " ", re.sub(r"\x1b\[[0-9;]*m", "", result.output))


def test_a_board_becomes_pictures_and_a_truth_that_is_a_calibration(tmp_path):
    result, said = run("render", "board", "--views", 2, *SMALL, "--distortion", "-0.1,0.02", "--out", tmp_path / "new")
    assert result.exit_code == 0, said
    assert sorted(file.name for file in (tmp_path / "new").glob("*.png")) == ["0000.png", "0001.png"]
    camera = coordinator.load_calibration(str(tmp_path / "new" / "truth.yaml"))
    assert (camera.width, camera.height, camera.k1, camera.k2, camera.k3) == (160, 120, -0.1, 0.02, 0.0)
    # The side of the picture, 80 px from the middle, is seen at 30 degrees: r = tan(30) is bent to
    # r (1 - 0.1 r^2 + 0.02 r^4) with r^2 = 1 / 3, and f is 80 px over that.
    assert camera.fx == pytest.approx(80.0 / (math.tan(math.pi / 6) * (1 - 0.1 / 3 + 0.02 / 9)))
    assert list(read_true_camera(tmp_path / "new" / "truth.yaml").poses) == ["0000.png", "0001.png"]


def test_a_film_holds_each_view_still_for_three_pictures(tmp_path):
    result, said = run("render", "board", "--views", 2, *SMALL, "--out", tmp_path / "board.mp4")
    assert result.exit_code == 0, said
    truth = read_true_camera(tmp_path / "board_truth.yaml")
    assert list(truth.poses) == [f"frame {k}" for k in range(6)]
    places = np.array([pose.t_m for pose in truth.poses.values()])
    np.testing.assert_array_equal(places[[0, 3]], places[[2, 5]])
    assert np.linalg.norm(places[0] - places[3]) > 0.01


def test_a_configuration_says_the_camera_and_where_it_should_sit(tmp_path):
    out = tmp_path / "run.lcmlog"
    off = ["--off-mm", "3", "-2", "0", "--off-deg", "0.5", "-0.25", "1"]
    result, said = run("render", "mounting", "--config", CONFIG, *off, "--rate-hz", "2", "--out", out)
    assert result.exit_code == 0, said
    config = coordinator.load_coordinator(CONFIG).coordinator
    mounting = read_true_mounting(tmp_path / "run_truth.yaml")
    np.testing.assert_allclose(mounting.position_m, np.add(config.mounting.position_m, [3e-3, -2e-3, 0]), atol=1e-9)
    angles = np.degrees([mounting.pan_rad, mounting.tilt_rad, mounting.roll_rad])
    np.testing.assert_allclose(angles, [0.5, -0.25, 1.0], atol=1e-6)
    assert coordinator.load_calibration(str(tmp_path / "run_camera.yaml")) == config.camera
    # Beside what was configured it is off: the calibration ends with 1, and says by what.
    result, said = run("calibrate", "mounting", out, "--camera", CALIBRATION, "--tag-size", "0.16", "--truth", CONFIG)
    assert result.exit_code == 1, said
    assert re.search(r"differs from \S+: forward by [\d.]+ mm \(2 allowed\), .*pan by 0\.[45]\d* °", said)
    assert " up " not in said.partition("beside the truth")[2]  # not observed, so not compared


def test_a_leader_of_another_family_facing_left_is_told_to_learn_body(tmp_path):
    leader = core.LeaderBody(
        [tag(4, 0.2, [0.0, 0.2, 0.3], 90.0), tag(6, 0.1, [0.1, 0.15, 0.3], 60.0)], family="tag25h9"
    )
    write_leader_body(tmp_path / "leader.yaml", leader)
    command = ["render", "body", "--leader", tmp_path / "leader.yaml", "--off-mm", 0, "--off-deg", 0, "--pictures", 12]
    result, said = run(*command, "--out", tmp_path / "turn")
    assert result.exit_code == 0, said
    words = "--tag-size 4=0.2 --tag-size 6=0.1 --height-of 4=0.300000 --reference-facing-deg 90.000 --family tag25h9"
    assert words in said
    read = coordinator.load_leader_body(str(tmp_path / "turn" / "truth.yaml"))
    assert all(row.off < 0.02 for row in body_differences(read, leader))


@pytest.mark.parametrize(
    ("command", "arguments", "exit_code", "wrong"),
    [
        ("board", ["--out", "FILE"], 64, "is a file"),
        ("board", ["--out", "x.pdf"], 64, "a film's is .mp4"),
        ("board", ["--out", "x.lcmlog"], 64, "is not a folder or a film"),
        ("board", ["--out", "MINE"], 74, "photo.png"),
        ("board", ["--out", "NEW", "--board", "circle"], 64, "neither charuco nor chessboard"),
        ("board", ["--out", "NEW", "--board", "charuco:8x6:30mm:22mm", "--rows", "5"], 64, "--rows: only with"),
        ("board", ["--out", "NEW", "--columns", "3"], 64, "board.columns: 3; allowed"),
        ("board", ["--out", "NEW", "--board", "chessboard", "--marker", "2cm"], 64, "a chessboard has no markers"),
        ("board", ["--out", "NEW", "--tilt-deg", "50", "20"], 64, "50 20 is not a range"),
        ("board", ["--out", "NEW", "--share", "nan"], 64, "nan is not a number from 0.1 to 0.9"),
        ("board", ["--out", "NEW", "--fov-deg", "200"], 64, "--lens fisheye"),
        ("board", ["--out", "NEW", "--fov-deg", "100", "--distortion", "-0.5"], 64, "folds a pinhole's view"),
        ("board", ["--out", "NEW", "--fov-deg", "120", "--lens", "fisheye", "--distortion", "-0.9"], 64, "folds"),
        ("board", ["--out", "NEW", "--fov-deg", "60", "--distortion", "0.1,x"], 64, "up to 5 numbers"),
        ("board", ["--out", "NEW", "--fov-deg", "60", "--size", "9000x9000"], 64, "too large to be rendered"),
        ("board", ["--out", "NEW", "--size", "640x480"], 64, "only with --fov-deg"),
        ("board", ["--out", "NEW", "--fov-deg", "60", "--camera", CALIBRATION], 64, "exclude each other"),
        ("board", ["--out", "NEW", "--camera", "FILE"], 78, "neither a mapping"),
        ("board", ["--out", "NEW.mp4", "--fov-deg", "60", "--size", "321x241"], 64, "a film's sides are even"),
        ("mounting", ["--out", "x.lcmlog", "--off-deg", "90", "0", "0"], 64, "from -45 to 45 degrees"),
        ("mounting", ["--out", "x.lcmlog", "--off-mm", "nan", "0", "0"], 64, "from -500 to 500 mm"),
        ("mounting", ["--out", "x.lcmlog", "--drive-m", "5"], 64, "allowed: up to 1.3"),
        ("mounting", ["--out", "x.lcmlog", "--off-deg", "0", "-30", "0"], 64, "tilt is -30 degrees"),
        ("body", ["--out", "NEW", "--leader", "FILE"], 78, "not a YAML mapping"),
        ("body", ["--out", "NEW", "--distance-m", "0.4"], 64, "larger --distance-m"),
        ("body", ["--out", "run.lcmlog"], 64, "is not a folder or a film"),
    ],
)
def test_what_is_wrong_is_said_and_nothing_is_written(command, arguments, exit_code, wrong, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "FILE").touch()
    (tmp_path / "MINE").mkdir()
    (tmp_path / "MINE" / "photo.png").touch()
    result, said = run("render", command, *arguments)
    assert (result.exit_code, wrong in said) == (exit_code, True), said
    assert sorted(file.name for file in tmp_path.iterdir()) == ["FILE", "MINE"]


def test_without_opencv_or_pyav_it_says_how_to_get_them(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    result, said = run("render", "board", *SMALL, "--out", tmp_path / "board.mp4")
    assert (result.exit_code, "pip install 'pilotfish[export]'" in said) == (69, True), said
    monkeypatch.setitem(sys.modules, "cv2", None)
    result, said = run("render", "board", *SMALL, "--out", tmp_path / "board")
    assert (result.exit_code, "pip install 'pilotfish[calibrate]'" in said) == (69, True), said


def test_a_scenario_is_rendered_with_and_without_its_word(tmp_path):
    for words in (["line"], ["scenario", "line"]):
        result, said = run("render", *words, "--frames", 1, "--out", tmp_path / words[0])
        assert result.exit_code == 0, said
        assert (tmp_path / words[0] / "000000.png").is_file()


@pytest.mark.parametrize(
    "board", [CHARUCO, CHESSBOARD, Board("charuco", 5, 7, 0.0123, 0.0085, "DICT_5X5_250")], ids=str
)
def test_a_board_is_spelled_as_it_is_understood(board, tmp_path):
    assert board_of(spelled(board)) == board
    write_board(board, tmp_path / "board.yaml")
    assert board_of(str(tmp_path / "board.yaml")) == board


@pytest.mark.parametrize("lens", [TrueCamera(), TrueFisheye()], ids=["pinhole", "fisheye"])
def test_a_true_camera_is_read_as_it_was_written_by_us_and_by_opencv(lens, tmp_path):
    file = tmp_path / "truth.yaml"
    pose = BoardPose(rotation([0.3, -0.2, 0.1]), np.array([0.01, -0.02, 0.5]))
    write_true_camera(file, lens.model, {"0000.png": pose}, ["a remark: {of} any kind"])
    truth = read_true_camera(file)
    assert truth.camera == lens.model
    np.testing.assert_allclose(truth.poses["0000.png"].R, pose.R, atol=1e-12)
    np.testing.assert_array_equal(truth.poses["0000.png"].t_m, pose.t_m)
    storage = cv2.FileStorage(str(file), cv2.FILE_STORAGE_READ)
    assert storage.getNode("camera_matrix").mat()[0, 0] == lens.fx
    assert storage.getNode("views").at(0).getNode("translation_m").at(2).real() == 0.5


def test_a_true_camera_with_a_damaged_view_is_refused(tmp_path):
    file = tmp_path / "truth.yaml"
    write_true_camera(file, TrueCamera().model, {"a": BoardPose(np.eye(3), np.zeros(3))})
    good = file.read_text()
    for wrong in ("[ nan, 0.0, 0.0 ]", "[ 0.0 ]", "far"):
        file.write_text(good.replace("translation_m: [ 0.0, 0.0, 0.0 ]", f"translation_m: {wrong}"))
        with pytest.raises(ConfigError, match=r"views: .*3 numbers"):
            read_true_camera(file)


def test_cameras_are_compared_in_percent_and_pixels():
    true = TrueCamera()
    found = TrueCamera(fx=true.fx * 1.0004, fy=true.fy * 0.9994, cx=true.cx + 0.6, cy=true.cy - 0.4)
    pose = BoardPose(rotation([0.0, 0.0, np.pi]), np.array([0.1, 0.2, 0.5]))
    # The board's middle, (0.12, 0.09) from its corner, is turned by 180 degrees: at (-0.02, 0.11).
    middles = {"a": np.array([-0.02, 0.11, 0.503]), "unknown": np.zeros(3)}
    rows = {row.name: row for row in camera_differences(found.model, Truth(true.model, {"a": pose}), middles, CHARUCO)}
    offs = [rows[name].off for name in ("fx", "fy", "cx", "cy", "board's place, RMS")]
    assert offs == pytest.approx([0.04, -0.06, 0.6, -0.4, 3.0], abs=1e-6)
    assert [rows[name].agrees for name in ("fx", "fy", "cx", "cy")] == [True, False, False, True]
    # 0.6 and 0.4 px everywhere, and beside it what the focal lengths add: 0.13 px at the side, 0.14 px above.
    assert rows["lens, RMS"].off == pytest.approx(math.hypot(0.6, 0.4), abs=0.03)


@pytest.mark.parametrize(("other", "wrong"), [(TrueCamera(width=800), "800x480"), (TrueFisheye(), "--model fisheye")])
def test_another_kind_of_camera_is_not_compared(other, wrong):
    with pytest.raises(ConfigError, match=wrong):
        camera_differences(TrueCamera().model, Truth(other.model, {}))


def test_mountings_are_compared_as_far_as_they_were_seen(tmp_path):
    true = core.CameraMounting(position_m=[0.1, 0.0, 0.3], pan_rad=np.radians(179.99), tilt_rad=0.1, roll_rad=-0.2)
    write_true_mounting(tmp_path / "truth.yaml", true)
    true = read_true_mounting(tmp_path / "truth.yaml")
    found = core.CameraMounting(
        position_m=[0.1025, 0.001, 0.9], pan_rad=np.radians(-179.99), tilt_rad=0.1, roll_rad=-0.2 + np.radians(0.2)
    )
    rows = {row.name: row for row in mounting_differences(found, [1e-3, 1e-3, np.inf, 1e-3, 1e-3, 1e-3], true)}
    assert list(rows) == ["forward", "left", "pan", "tilt", "roll"]
    assert [row.off for row in rows.values()] == pytest.approx([2.5, 1.0, 0.02, 0.0, 0.2], abs=1e-4)
    assert [row.agrees for row in rows.values()] == [False, True, True, True, False]


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("", "no mounting in it"),
        ("%YAML:1.0\n---\na: 1\n", "no mounting in it"),
        ("camera: {mounting: {position_m: [0, 0]}}", "three numbers"),
        ("camera: {mounting: {position_m: [0, 0, .nan]}}", "three numbers"),
        ("camera: {mounting: {position_m: [0, 0, 0], pan_deg: left}}", "pan_deg: left"),
        ("camera: {mounting: {position_m: [0, 0, 0], pan: 3}}", "mounting.pan: unknown key"),
    ],
)
def test_a_file_without_a_mounting_is_no_truth(text, wrong, tmp_path):
    (tmp_path / "truth.yaml").write_text(text)
    with pytest.raises(ConfigError, match=wrong):
        read_true_mounting(tmp_path / "truth.yaml")


def test_bodies_are_compared_tag_by_tag():
    tags = FIVE.tags
    moved = core.BodyTag(id=1, size_m=0.12, position_m=np.add(tags[1].position_m, [0.003, 0.0, -0.004]).tolist())
    moved.facing_rad, moved.tilt_rad = tags[1].facing_rad + np.radians(0.3), tags[1].tilt_rad
    rows = {row.name: row for row in body_differences(core.LeaderBody([tags[0], moved, *tags[2:]]), FIVE)}
    assert (rows["tag 0, place"].off, rows["tag 0, turn"].off) == pytest.approx((0.0, 0.0), abs=1e-9)
    # 3 and 4 mm aside are 5 mm; a turn about the vertical by 0.3 degrees is one by 0.3 degrees of an upright robot's
    # tag, however it tilts.
    assert rows["tag 1, place"].off == pytest.approx(5.0, abs=1e-6)
    assert rows["tag 1, turn"].off == pytest.approx(0.3, abs=1e-6)
    with pytest.raises(ConfigError, match=r"seen were \[0, 1\]"):
        body_differences(core.LeaderBody(tags[:2]), FIVE)

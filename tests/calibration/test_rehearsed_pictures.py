"""What is rendered for a rehearsal is what a camera would see: beside lenses, robots and files that share no code."""

import cv2
import numpy as np
import pytest
from board_views import CHARUCO, CHESSBOARD
from rendered_boards import TrueCamera, TrueFisheye, corners_seen, poses, render
from turning_bodies import CAMERA, FIVE

from pilotfish import core, sim
from pilotfish.calibration.camera import BoardDetector, BoardView
from pilotfish.calibration.mounting.recordings import open_film
from pilotfish.calibration.rehearsal import (
    BoardPose,
    DriveSettings,
    Shot,
    board_poses,
    drive_shots,
    outlets,
    plan_drive,
    plan_turn,
    with_wrong_faces,
)
from pilotfish.calibration.rehearsal.lens import directions, project
from pilotfish.errors import ConfigError, ExistsError

LENSES = [TrueCamera(distortion=(-0.3, 0.1, 0.001, -0.002, 0.03)), TrueFisheye()]
MOUNTING = core.CameraMounting(position_m=[0.053, -0.003, 0.25], pan_rad=0.01, tilt_rad=-0.01, roll_rad=0.01)
SHARP = sim.Imperfections(blur_sigma_px=0.0, noise_sigma=0.0, clutter=0.0)


@pytest.mark.parametrize("lens", LENSES, ids=["pinhole", "fisheye"])
def test_the_drawing_lens_is_the_products_and_its_inverse_leads_back(lens):
    """The C++ projects point by point; directions all over the picture must lead to the pixels they came from."""
    u, v = np.meshgrid(np.linspace(0, 639, 9), np.linspace(0, 479, 7))
    pixels = np.stack([u, v], axis=-1)
    rays = directions(lens.model, pixels)
    np.testing.assert_allclose(project(lens.model, rays), pixels, atol=1e-3)
    in_front = rays[..., 2] > 0.0  # the product does not look further than 90 degrees from the axis
    assert in_front.mean() > 0.8
    by_cpp = np.array([lens.model.project(ray) for ray in rays[in_front]])
    np.testing.assert_allclose(by_cpp, pixels[in_front], atol=1e-3)


@pytest.mark.parametrize("lens", LENSES, ids=["pinhole", "fisheye"])
@pytest.mark.parametrize("board", [CHARUCO, CHESSBOARD], ids=["charuco", "chessboard"])
def test_a_drawn_board_has_its_corners_where_the_lens_projects_them(lens, board):
    pose = poses(board, lens, 1, 3, spread=0.3, share=0.3)[0]  # larger, a fisheye bends edges within a corner's window
    view = BoardDetector(board).detect(render(board, lens, pose, noise_sigma=0.0))
    assert isinstance(view, BoardView)
    assert len(view) >= 0.8 * len(board.corners_m())  # OpenCV misses some small markers
    expected = corners_seen(board, lens, pose)
    if board.kind == "chessboard" and np.linalg.norm(view.corners_px[0] - expected[0]) > 5:
        expected = expected[::-1]  # counted from the other end
    # A thirtieth of a pixel; a shift of the drawing by half a sample would be a sixth.
    assert np.abs(view.corners_px - expected[view.ids]).max() < 0.033


def test_the_same_seed_gives_the_same_picture_and_another_one_other_noise():
    camera = TrueCamera(width=160, height=120, fx=150.0, fy=150.0, cx=79.5, cy=59.5)
    pose = BoardPose(np.eye(3), np.array([-0.12, -0.09, 0.4]))
    first, again, other = (render(CHARUCO, camera, pose, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    # Two draws of sigma 2 differ by sqrt(2) 2 = 2.83 gray levels, and rounding adds 1 / 6 to the variance.
    assert np.std(first.astype(float) - other) == pytest.approx(np.sqrt(8 + 1 / 6), rel=0.05)


def test_what_is_behind_the_camera_is_not_drawn():
    camera = TrueCamera(width=160, height=120, fx=150.0, fy=150.0, cx=79.5, cy=59.5)
    behind = BoardPose(np.eye(3), np.array([-0.12, -0.09, -0.4]))
    assert np.unique(render(CHARUCO, camera, behind, noise_sigma=0.0)).tolist() == [120]


@pytest.mark.parametrize("lens", LENSES, ids=["pinhole", "fisheye"])
@pytest.mark.parametrize("board", [CHARUCO, CHESSBOARD], ids=["charuco", "chessboard"])
def test_sixteen_poses_cover_the_picture_and_a_chessboard_is_whole_in_each(lens, board):
    found = board_poses(board, lens.model, 16, 7, share=0.35 if isinstance(lens, TrueFisheye) else 0.6, candidates=12)
    seen = np.concatenate([corners_seen(board, lens, pose) for pose in found])
    inside = ((seen > 0) & (seen < [639, 479])).all(axis=1)
    if board.kind == "chessboard":
        assert inside.all()
    cells = np.unique((seen[inside] / [80, 80]).astype(int), axis=0)
    assert len(cells) >= 0.7 * 48  # what the verdict calls good


def test_a_board_that_does_not_fit_is_refused_with_what_to_do():
    tower = TrueCamera(width=640, height=64, cy=32.0).model
    with pytest.raises(ConfigError, match="smaller --share"):
        board_poses(CHESSBOARD, tower, 1, 1, share=0.9)


def test_a_drive_turns_on_the_spot_to_both_sides_and_then_goes_straight():
    drive = plan_drive(CAMERA, MOUNTING, DriveSettings(drive_m=0.5))
    places, turning = np.array(drive.places), np.array(drive.turning)
    headings = np.arctan2(places[:, 1, 0], places[:, 0, 0])
    np.testing.assert_allclose(places[turning][:, :2, 3], 0.0, atol=1e-12)
    # A width of 640 px at f = 600 px is 56 degrees, distorted a little more; less 4 degrees at each side.
    assert np.degrees(headings[turning].max()) == pytest.approx(24.5, abs=1.0)
    # To both sides alike, but for where exactly the tag stands: up to 2 cm aside, which is 0.7 degrees at 1.6 m, on
    # each of them.
    assert headings[turning].min() == pytest.approx(-headings[turning].max(), abs=np.radians(0.5 + 2 * 0.7))
    assert np.abs(headings[~turning]).max() < np.radians(0.2)
    assert np.hypot(*places[-1, :2, 3]) == pytest.approx(0.5, abs=0.005)
    # The odometry's errors are those that were asked for.
    last = drive.odometry[-1]
    assert np.hypot(last.x_m, last.y_m) == pytest.approx(0.99 * 0.5, abs=0.005)
    turned = max(pose.heading_rad for pose in drive.odometry)
    assert turned == pytest.approx(1.02 * 2 * headings[turning].max(), abs=np.radians(0.3))


def test_a_turning_centre_wanders_as_far_as_it_is_told():
    drive = plan_drive(CAMERA, MOUNTING, DriveSettings(rate_hz=50.0, wander_m=0.002))
    places = np.array(drive.places)[np.array(drive.turning)][:, :2, 3]
    # Some 390 pictures, two axes: the standard deviation of 780 draws is known to 1 / sqrt(2 780) = 2.5 %.
    assert len(places) > 350
    assert places.std() == pytest.approx(0.002, rel=0.1)


def test_the_tag_is_where_the_mounting_projects_it():
    drive = plan_drive(CAMERA, MOUNTING, DriveSettings())
    shot = list(drive_shots(CAMERA, MOUNTING, drive, SHARP))[-1]
    cMw = np.linalg.inv(drive.places[-1] @ MOUNTING.bMc)
    corners = np.array([CAMERA.project(cMw[:3, :3] @ p + cMw[:3, 3]) for p in drive.wall.tags[0].corners_m])
    middle = corners.mean(axis=0)
    ring = middle + 0.93 * (corners - middle)  # within the black border: a cell is an eighth of the side
    assert all(shot.image[round(v), round(u)] < 60 for u, v in ring.tolist())
    paper = middle + 1.1 * (corners - middle)
    assert all(shot.image[round(v), round(u)] > 180 for u, v in paper.tolist())


@pytest.mark.parametrize(
    ("settings", "mounting", "wrong"),
    [
        (DriveSettings(drive_m=1.5), MOUNTING, "allowed: up to 1.3"),
        (DriveSettings(), core.CameraMounting(position_m=[0, 0, 0.3], tilt_rad=-0.6), "0 of .* pictures of the turn"),
        (DriveSettings(rate_hz=1.0), MOUNTING, "--rate-hz"),
    ],
)
def test_a_drive_in_which_the_tag_is_not_seen_is_refused(settings, mounting, wrong):
    with pytest.raises(ConfigError, match=wrong):
        plan_drive(CAMERA, mounting, settings)


def test_faces_are_off_by_what_was_asked_and_the_reference_faces_as_before():
    wrong = with_wrong_faces(FIVE, 0.004, np.radians(2.0), seed=3)
    for tag, nominal in zip(wrong.tags, FIVE.tags, strict=True):
        assert np.linalg.norm(np.subtract(tag.position_m, nominal.position_m)) == pytest.approx(0.004, rel=1e-6)
        # The trace of a turn by a is 1 + 2 cos a.
        cosine = (np.trace(nominal.oMt[:3, :3].T @ tag.oMt[:3, :3]) - 1) / 2
        assert np.degrees(np.arccos(cosine)) == pytest.approx(2.0, abs=1e-6)
    np.testing.assert_allclose(wrong.tags[0].oMt[:3, 2], FIVE.tags[0].oMt[:3, 2], atol=1e-9)
    assert with_wrong_faces(FIVE, 0.004, 0.03, seed=3) != with_wrong_faces(FIVE, 0.004, 0.03, seed=4)


@pytest.mark.parametrize(("distance_m", "wrong"), [(0.5, "tag . leaves the picture"), (9.0, "25 are needed")])
def test_a_leader_too_near_or_too_far_is_refused(distance_m, wrong):
    with pytest.raises(ConfigError, match=wrong):
        plan_turn(CAMERA, FIVE, 40, distance_m)


def shots(count, size=(64, 48)):
    return [Shot(1_000_000 + 200_000 * k, np.full(size[::-1], 10 * k + 5, np.uint8)) for k in range(count)]


def test_a_folder_and_a_film_hold_the_pictures_with_their_times(tmp_path):
    assert outlets.write_folder(tmp_path / "folder", shots(5), 5) == 5
    assert outlets.write_film(tmp_path / "film.mp4", shots(5), 5) == 5
    exact, coded = (list(open_film(tmp_path / name).frames) for name in ("folder", "film.mp4"))
    assert [frame.utime for frame in exact] == [shot.utime for shot in shots(5)]
    for shot, one, other in zip(shots(5), exact, coded, strict=True):
        np.testing.assert_array_equal(one.image, shot.image)
        assert np.abs(other.image.astype(int) - shot.image).max() <= 2


def test_a_log_holds_pictures_and_odometry_in_the_order_of_their_times(tmp_path):
    odometry = [outlets.Pose(1_000_000 + 20_000 * k, 0.01 * k, 0.0, 0.1) for k in range(60)]
    outlets.write_log(tmp_path / "run.lcmlog", "robot1", shots(4), odometry, 4)
    film = open_film(tmp_path / "run.lcmlog", "robot1")
    assert [(frame.utime, int(frame.image[0, 0])) for frame in film.frames] == [
        (shot.utime, int(shot.image[0, 0])) for shot in shots(4)
    ]
    assert film.motion_from == "odometry"
    np.testing.assert_allclose(film.motion.at(np.array([1_010_000])), [[0.005, 0.0, 0.1]], atol=1e-9)


def test_new_pictures_are_not_mixed_with_others(tmp_path):
    outlets.write_folder(tmp_path, shots(3), 3)
    with pytest.raises(ExistsError, match=r"0000.png and 2 more"):  # nobody says whose they are
        outlets.check_folder(tmp_path, 3)
    (tmp_path / "truth.yaml").touch()
    outlets.check_folder(tmp_path, 3)  # the same again
    with pytest.raises(ExistsError, match=r"0002.png\)"):  # fewer: one of before would stay
        outlets.write_folder(tmp_path, shots(2), 2)
    cv2.imwrite(str(tmp_path / "mine.jpg"), np.zeros((8, 8), np.uint8))
    with pytest.raises(ExistsError, match=r"mine\.jpg"):
        outlets.check_folder(tmp_path, 3)

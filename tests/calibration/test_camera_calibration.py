"""Lenses from views of a board: how near to the truth, how honest about it, and what keeps wrong views out."""

import dataclasses

import numpy as np
import pytest
from board_views import CHARUCO, SIZE, views_of
from rendered_boards import TrueCamera, TrueFisheye, poses, render

from pilotfish.calibration.camera import BoardDetector, BoardView, Lens, calibrate_camera, fit_best, unseen
from pilotfish.calibration.camera.calibrate import CameraCalibration
from pilotfish.calibration.camera.coverage import coverage_of
from pilotfish.calibration.camera.fit import fit_lens, fit_pose
from pilotfish.errors import CalibrationError

CAMERA = TrueCamera()


def truth(camera):
    return np.array([camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion])


@pytest.fixture(scope="module")
def from_pictures() -> CameraCalibration:
    detector = BoardDetector(CHARUCO)
    pictures = [render(CHARUCO, CAMERA, pose, seed=k) for k, pose in enumerate(poses(CHARUCO, CAMERA, 25, seed=3))]
    found = [detector.detect(image, str(k)) for k, image in enumerate(pictures)]
    return calibrate_camera(found, SIZE, CHARUCO)


def test_twenty_five_rendered_pictures_give_the_lens(from_pictures):
    lens = from_pictures.lens
    # The goal: 0.05 % of f, 0.5 px of c. Reached is 0.005 % and 0.05 px.
    assert [lens.fx, lens.fy] == pytest.approx([CAMERA.fx, CAMERA.fy], rel=5e-4)
    assert [lens.cx, lens.cy] == pytest.approx([CAMERA.cx, CAMERA.cy], abs=0.5)
    assert lens.distortion[:2] == pytest.approx(CAMERA.distortion[:2], abs=0.005)
    assert from_pictures.verdict.grade == "good", from_pictures.verdict
    assert from_pictures.unseen.rms_px < 0.03


def test_what_is_said_to_be_known_is_known(from_pictures):
    error = from_pictures.lens.values - truth(CAMERA)
    fitted = from_pictures.fit.free
    assert (np.abs(error[fitted]) < 5 * from_pictures.known.sigma[fitted]).all()
    assert not fitted[-1], "there is no k3 in this lens, and none is needed"


def test_standard_deviations_are_honest():
    # Normalised errors of 20 calibrations: f and c have mean square 1 if the deviations are right; fx and fy are nearly
    # one number, so 60 are independent, and the mean lies within 1 +- 0.55 (3 sigma). Goal: within a factor of 2.
    squares = []
    for seed in range(20):
        fit, known = fit_best(views_of(CHARUCO, CAMERA, 25, seed + 100), SIZE, "pinhole")
        squares.append(((fit.lens.values - truth(CAMERA))[:4] / known.sigma[:4]) ** 2)
    assert 0.5 < np.mean(squares) < 2.0


def test_k3_is_fitted_where_there_is_one():
    bent = dataclasses.replace(CAMERA, distortion=(-0.3, 0.1, 0.001, -0.0005, 0.05))
    fit, known = fit_best(views_of(CHARUCO, bent, 25, 7), SIZE, "pinhole")
    assert fit.free[-1]
    error = fit.lens.values - truth(bent)
    assert (np.abs(error) < 5 * known.sigma).all()


def test_a_fisheye_is_found_again():
    fisheye = TrueFisheye()
    views = views_of(CHARUCO, fisheye, 25, 3, share=0.35, tilt_deg=(15, 45))
    fit, known = fit_best(views, SIZE, "fisheye")
    assert (np.abs(fit.lens.values - truth(fisheye)) < 5 * known.sigma).all()
    assert fit.lens.fx == pytest.approx(fisheye.fx, rel=5e-3)


@pytest.mark.parametrize("camera", [CAMERA, TrueFisheye()], ids=["pinhole", "fisheye"])
def test_our_lens_projects_as_the_formula_does(camera):
    model = "fisheye" if isinstance(camera, TrueFisheye) else "pinhole"
    lens = Lens(model, *SIZE, camera.fx, camera.fy, camera.cx, camera.cy, camera.distortion)
    points = np.random.default_rng(2).uniform([-0.4, -0.3, 0.8], [0.4, 0.3, 1.2], (50, 3))
    np.testing.assert_allclose(lens.project(points, np.zeros(3), np.zeros(3)), camera.project(points), atol=1e-9)


def test_views_in_the_middle_alone_are_not_good():
    result = calibrate_camera(views_of(CHARUCO, CAMERA, 25, 3, spread=0.1, share=0.3), SIZE, CHARUCO)
    assert result.verdict.grade != "good"
    said = " ".join(result.verdict.reasons)
    assert "no corners in the" in said and "upper left" in said


def test_the_empty_parts_of_the_picture_are_named():
    rng = np.random.default_rng(1)
    left = rng.uniform([0, 0], [200, 479], (300, 2))  # the left third, of 213 px
    view = BoardView("left", np.arange(300), np.zeros((300, 3)), left)
    coverage = coverage_of([view], SIZE)
    wanted = {"upper middle", "upper right", "middle", "right", "lower middle", "lower right"}
    assert set(coverage.empty_regions) == wanted
    assert coverage.share == pytest.approx(3 / 8)  # 2.5 of 8 columns
    assert all(line[:4].strip() and not line[6:].strip() for line in coverage.text())


def test_views_without_tilt_leave_the_focal_length_open_and_say_so():
    result = calibrate_camera(views_of(CHARUCO, CAMERA, 25, 3, tilt_deg=(0.0, 3.0)), SIZE, CHARUCO)
    assert result.verdict.grade == "do again"
    assert "no tilted views" in " ".join(result.verdict.reasons)
    assert "focal length uncertain" in " ".join(result.verdict.reasons)


def test_few_views_are_not_good_and_three_are_refused():
    few = calibrate_camera(views_of(CHARUCO, CAMERA, 9, 3), SIZE, CHARUCO)
    assert few.verdict.grade != "good"
    with pytest.raises(CalibrationError, match="4 are needed"):
        calibrate_camera(views_of(CHARUCO, CAMERA, 3, 3), SIZE, CHARUCO)


def test_a_blurred_view_is_left_out():
    views = views_of(CHARUCO, CAMERA, 20, 3)
    views[4] = dataclasses.replace(views[4], blur_px=1.6)
    result = calibrate_camera(views, SIZE, CHARUCO)
    assert [(each.name, each.why) for each in result.rejected] == [("4", "blurred")]


def test_a_moved_camera_shows_in_the_measured_blur():
    detector, pose = BoardDetector(CHARUCO), poses(CHARUCO, CAMERA, 1, 1, spread=0.2)[0]
    still = detector.detect(render(CHARUCO, CAMERA, pose))
    moved = detector.detect(render(CHARUCO, CAMERA, pose, motion_px=5.0))
    # A box of 5 px has a standard deviation of 5 / sqrt(12) = 1.44 px.
    assert still.blur_px < 0.8 < 1.2 < moved.blur_px < 2.0


def test_one_wrong_view_is_left_out_and_does_no_harm():
    views = views_of(CHARUCO, CAMERA, 25, 3)
    clean = calibrate_camera(views, SIZE, CHARUCO)
    wrong = views[7]
    views[7] = dataclasses.replace(wrong, points_m=wrong.points_m * [1.0, 1.08, 1.0])  # as if the sheet were bent
    result = calibrate_camera(views, SIZE, CHARUCO)
    assert [(each.name, each.why) for each in result.rejected] == [("7", "outlier")]
    assert (np.abs(result.lens.values - clean.lens.values) < 3 * clean.known.sigma + 1e-12).all()


def test_a_single_wrong_corner_is_left_out():
    views = views_of(CHARUCO, CAMERA, 25, 3)
    corners = views[3].corners_px.copy()
    corners[5] += [0.6, 0.0]  # 12 sigma, yet too little to make the view an outlier
    views[3] = dataclasses.replace(views[3], corners_px=corners)
    result = calibrate_camera(views, SIZE, CHARUCO)
    assert result.dropped_corners == 1
    assert result.rejected == ()


def with_wrong_views(count, seed):
    """Twenty views, the first ``count`` of them of boards whose sides were measured wrongly by up to 30 %."""
    views, rng = views_of(CHARUCO, CAMERA, 20, 3), np.random.default_rng(seed)
    for k in range(count):
        views[k] = dataclasses.replace(views[k], points_m=views[k].points_m * rng.uniform(0.7, 1.3, 3))
    return views


def grade_of(views):
    try:
        return calibrate_camera(views, SIZE, CHARUCO).verdict.grade
    except CalibrationError:
        return "refused"


@pytest.mark.parametrize("seed", [1, 2])
def test_wrong_views_are_left_out_up_to_a_quarter(seed):
    result = calibrate_camera(with_wrong_views(5, seed), SIZE, CHARUCO)
    assert [each.name for each in result.rejected] == ["0", "1", "2", "3", "4"]
    assert result.lens.fx == pytest.approx(CAMERA.fx, abs=5 * result.known.sigma[0])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_many_wrong_views_are_never_taken_for_a_calibration(seed):
    assert grade_of(with_wrong_views(9, seed)) in ("do again", "refused")


def test_views_that_took_no_part_fit_as_well_as_the_noise_allows():
    # Noise of 0.05 px an axis: 0.0707 px of length, whether or not a view was used.
    result = calibrate_camera(views_of(CHARUCO, CAMERA, 25, 5), SIZE, CHARUCO)
    assert result.unseen.rms_px == pytest.approx(0.05 * np.sqrt(2), rel=0.1)
    assert result.unseen.folds == 5


def test_a_view_is_tested_by_lenses_that_have_not_seen_it(monkeypatch):
    fits, tests = [], []

    def fit(views, *arguments, **options):
        fits.append({view.name for view in views})
        return fit_lens(views, *arguments, **options)

    def pose(lens, view, *arguments):
        tests.append((len(fits) - 1, view.name))
        return fit_pose(lens, view, *arguments)

    views = views_of(CHARUCO, CAMERA, 12, 5)
    found = fit_lens(views, SIZE, "pinhole")
    monkeypatch.setattr(unseen, "fit_lens", fit)
    monkeypatch.setattr(unseen, "fit_pose", pose)
    assert unseen.unseen_views(views, found).folds == 5
    assert sorted(name for _, name in tests) == sorted(view.name for view in views)
    assert all(name not in fits[number] for number, name in tests)
    assert all(len(each) >= 9 for each in fits)  # of 12 views, 2 or 3 are left out at a time


def test_noise_that_a_whole_view_has_in_common_widens_what_is_said_to_be_known():
    # A sheet that is never flat: each view's board is bent a little, by its own amount.
    rng = np.random.default_rng(4)
    bent = []
    for view in views_of(CHARUCO, CAMERA, 25, 3, sigma_px=0.01):
        bow = 0.002 * rng.normal() * (view.points_m[:, 0] / 0.24 - 0.5) ** 2
        off = np.stack([np.zeros(len(view)), bow * 2000.0], axis=1)
        bent.append(dataclasses.replace(view, corners_px=view.corners_px + off))
    _, known = fit_best(bent, SIZE, "pinhole")
    assert known.jackknife[0, 0] > 1.5 * known.least_squares[0, 0]
    assert known.sigma[0] == pytest.approx(np.sqrt(known.jackknife[0, 0]))

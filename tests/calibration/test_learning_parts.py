"""The parts of the learning, each against something that does not share its code."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from turning_bodies import CAMERA, FIVE, one_turn, sightings_of, tag, turned

from pilotfish import core
from pilotfish.calibration.body.bundle import Bundle, Estimate
from pilotfish.calibration.body.leader_file import body_tag
from pilotfish.calibration.body.projection import project
from pilotfish.calibration.body.rigid import moved, step_between
from pilotfish.calibration.body.single_pose import both_tag_poses
from pilotfish.calibration.body.turning import fit_turning_axis, turned_rad
from pilotfish.errors import BodyLearningError

WIDE = core.CameraModel(
    width=640, height=480, fx=420, fy=430, cx=330, cy=230, k1=-0.28, k2=0.08, p1=0.006, p2=-0.004, k3=0.01
)
FISHEYE = core.CameraModel(
    width=640, height=480, fx=250, fy=251, cx=322, cy=236, k1=-0.04, k2=0.012, k3=-0.005, k4=0.0006,
    lens=core.Lens.kannala_brandt,
)  # fmt: skip


@pytest.mark.parametrize("camera", [CAMERA, WIDE, FISHEYE], ids=["mild", "wide", "fisheye"])
def test_many_points_are_projected_as_the_camera_model_projects_one(camera):
    points = np.random.default_rng(1).uniform([-0.5, -0.4, 0.6], [0.5, 0.4, 3.0], (200, 3))
    pixels, derivative = project(camera, points)
    np.testing.assert_allclose(pixels, [camera.project(p) for p in points], atol=1e-9)
    # Central differences over 1e-5 m: their error is of the order 1e-10 times the third derivative, 1e3 px/m^3.
    for axis in range(3):
        step = np.eye(3)[axis] * 1e-5
        slope = (project(camera, points + step)[0] - project(camera, points - step)[0]) / 2e-5
        np.testing.assert_allclose(derivative[..., axis], slope, atol=1e-4)


@pytest.mark.parametrize("free_sizes", [False, True])
def test_the_bundle_s_derivative_is_that_of_its_residuals(free_sizes):
    rng = np.random.default_rng(2)
    sightings = sightings_of(FIVE, one_turn(12), sigma_px=0.2, seed=2)
    cMr = np.array([cMo @ FIVE.tags[0].oMt for cMo in one_turn(12)])[: sightings.frame_count]
    rMt = np.array([np.linalg.inv(FIVE.tags[0].oMt) @ each.oMt for each in FIVE.tags])
    start = Estimate(moved(cMr, rng.normal(0, 0.02, (len(cMr), 6))), rMt, np.zeros(5))
    bundle = Bundle(CAMERA, sightings, start, 0, free_sizes=free_sizes)
    x = rng.normal(0, 0.1, bundle.unknowns)  # away from the start: there the derivative of the turn counts
    jacobian = bundle.jacobian(x).toarray()
    assert bundle.unknowns == 6 * len(cMr) + (7 if free_sizes else 6) * 4
    for k in range(bundle.unknowns):
        step = np.zeros(bundle.unknowns)
        step[k] = 1e-6
        slope = (bundle.residuals(x + step) - bundle.residuals(x - step)) / 2e-6
        np.testing.assert_allclose(jacobian[:, k], slope, atol=2e-4 * max(np.abs(slope).max(), 1.0))


def test_a_step_between_two_poses_leads_from_the_one_to_the_other():
    rng = np.random.default_rng(3)
    start = moved(np.tile(np.eye(4), (20, 1, 1)), rng.normal(0, 1, (20, 6)))
    steps = rng.normal(0, 0.5, (20, 6))
    np.testing.assert_allclose(step_between(start, moved(start, steps)), steps, atol=1e-12)


def test_both_poses_of_a_tag_explain_its_corners_and_one_of_them_is_true():
    # Far off and slightly turned, without noise: the true pose explains the corners exactly, the flipped one to a
    # fraction of a pixel, and turned to the other side.
    body = core.LeaderBody([tag(0, 0.16, [0.0, 0.0, 0.35], 180)])
    poses = [turned(phi, 4.0, 0.0) for phi in np.radians([15, 25, 35])]
    cMt, errors = both_tag_poses(CAMERA, sightings_of(body, poses, sigma_px=0.0, seed=1))
    for k, cMo in enumerate(poses):
        np.testing.assert_allclose(cMt[k, 0], cMo @ body.tags[0].oMt, atol=1e-4)
        assert errors[k, 0] < 1e-3 < errors[k, 1] < 1.0
        assert cMt[k, 0, 0, 2] * cMt[k, 1, 0, 2] < 0.0  # the normals look to opposite sides


@settings(derandomize=True, deadline=None)
@given(st.floats(-3.1, 3.1), st.floats(-1.57, 1.57), st.floats(-3.1, 3.1))
def test_a_tag_is_found_again_from_its_pose(facing, tilt, roll):
    original = core.BodyTag(id=3, position_m=[0.1, -0.2, 0.3], facing_rad=facing, tilt_rad=tilt, roll_rad=roll)
    found = body_tag(3, 0.16, original.oMt)
    # Near the zenith facing and roll are lost in each other (1e-3 rad from it, to 1e-13 / 1e-3), their sum is not.
    np.testing.assert_allclose(found.oMt, original.oMt, atol=1e-9)


@pytest.mark.parametrize("tilt", [-np.pi / 2, np.pi / 2])
def test_a_tag_on_the_lid_is_found_again_too(tilt):
    original = core.BodyTag(id=3, facing_rad=0.7, tilt_rad=tilt, roll_rad=-2.0)
    np.testing.assert_allclose(body_tag(3, 0.16, original.oMt).oMt, original.oMt, atol=1e-9)


def test_the_turning_axis_is_found_where_the_body_turned():
    # The body's own frame serves as the tag's: the axis is its z axis, through its origin.
    poses = np.array(one_turn(30, to_deg=200))
    axis = fit_turning_axis(poses)
    np.testing.assert_allclose(axis.up, [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(axis.origin_m, 0.0, atol=1e-9)
    # 30 steps over 200 degrees, the last one not taken.
    assert np.degrees(turned_rad(axis, poses)) == pytest.approx(200 * 29 / 30)
    assert max(axis.wander_m, axis.wobble_rad) < 1e-9


def test_a_wandering_turning_centre_is_averaged_and_reported():
    # The centre goes round a circle of 10 mm three times a turn: its mean is the middle, its RMS the radius.
    phis = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    poses = np.array([turned(p, 1.3 + 0.01 * np.cos(3 * p), 0.01 * np.sin(3 * p)) for p in phis])
    axis = fit_turning_axis(poses)
    np.testing.assert_allclose(axis.origin_m, 0.0, atol=1e-9)
    assert axis.wander_m == pytest.approx(0.01)


def test_a_body_that_hardly_turned_has_no_axis():
    with pytest.raises(BodyLearningError, match="hardly turned"):
        fit_turning_axis(np.array(one_turn(20, to_deg=20)))


def test_an_axis_that_lies_across_the_picture_is_refused():
    camera_on_its_side = np.eye(4)
    camera_on_its_side[:2, :2] = [[0, -1], [1, 0]]
    with pytest.raises(BodyLearningError, match="upright"):
        fit_turning_axis(camera_on_its_side @ np.array(one_turn(20)))

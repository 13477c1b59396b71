"""The tracker on cameras, light and prints that it does not model (bench/vision/camera_chain.py, in linear light,
shares no code with the simulator). What AprilTag reads there, it must see."""

import dataclasses

import numpy as np
import pytest
from rendered_leaders import BODY, frame, leader_at, observer, render

from bench.vision import printed_sheet
from bench.vision.chains import figures_in, off_by
from bench.vision.conditions import CONDITIONS, SHEET, TYPICAL
from bench.vision.ours import Ours
from bench.vision.scenes import LEADER, VGA, corners_px, tag_pose
from pilotfish import core, vision

CONDITION = {condition.name: condition for condition in CONDITIONS}


def photograph(cMt, seed=1, chain=TYPICAL, lighting=None, sheet=SHEET):
    rng = np.random.default_rng(seed)
    light = printed_sheet.backdrop(VGA, rng)[:, : VGA.width].copy()
    printed_sheet.show(light, VGA, cMt, sheet, lighting)
    return chain.photograph(light, rng)


def followed(name, distance_m, count=16):
    condition = CONDITION[name]
    tracker = Ours(condition.camera, LEADER, tracking=True)
    pictures = list(condition.pictures(distance_m, count, seed=3))
    answers = [tracker.track(picture.image, picture.utime) for picture in pictures]
    return figures_in(answers, [picture.cMt for picture in pictures])


def test_a_far_tag_is_found_at_first_sight_however_it_is_turned():
    # At 5 m a cell has 2.4 px, and turned by 50 degrees 1.5 px one way: only a search at full resolution finds it.
    for yaw_deg in (-50, -25, 0, 25, 50):
        eye = vision.LeaderObserver(camera=VGA, body=LEADER)
        image = photograph(tag_pose(5.0, azimuth_rad=0.1, yaw_rad=np.radians(yaw_deg)), seed=60 + yaw_deg)
        seen = eye.observe(core.Frame(image, utime=1)).observation
        assert seen is not None, yaw_deg
        assert seen.distance_m == pytest.approx(5.0, abs=0.1)


def test_the_coarse_and_the_fine_search_together_still_notice_an_id_that_is_there_twice():
    # One near, which the coarse search finds, and one far, which only the fine one does.
    image = render([(BODY, leader_at(1.2, -0.15)), (BODY, leader_at(4.8, 0.25))], 1)
    assert observer().observe(frame(image, 0)).reason == core.Reason.tag_duplicate


@pytest.mark.parametrize(("name", "distance_m"), [("shadow edge", 0.65), ("shadow edge", 1.1), ("soft shadow", 1.1)])
def test_a_shadow_across_the_tag_does_not_hide_it(name, distance_m):
    # White in the shade is darker than what separates white from black in the sun: one threshold cannot read it.
    figures = followed(name, distance_m)
    assert figures.seen > 0.9
    assert figures.p95_deg < 1.0


@pytest.mark.parametrize("name", ["half a ring", "cut close"])
@pytest.mark.parametrize("distance_m", [0.65, 1.1, 2.44])
def test_a_white_ring_of_half_a_cell_is_enough(name, distance_m):
    assert followed(name, distance_m).seen == 1.0


@pytest.mark.parametrize(("yaw_deg", "distance_m"), [(-30, 0.65), (0, 0.65), (30, 0.65), (-30, 1.1), (20, 1.1)])
def test_a_bent_sheet_is_measured_where_its_middle_is(yaw_deg, distance_m):
    # A radius of 0.35 m moves the sides of the tag back by 9 mm: seen at 30 degrees, by a quarter of a cell.
    cMt = tag_pose(distance_m, yaw_rad=np.radians(yaw_deg))
    image = photograph(cMt, seed=9, sheet=CONDITION["curved"].sheet)
    answer = Ours(VGA, LEADER, tracking=False).track(image, 1)
    assert answer.cMt is not None
    off = np.abs(off_by(answer.claim, cMt))
    assert off[0] < 0.01 * distance_m
    assert np.all(off < 5.0 * np.sqrt(np.diag(answer.claim.covariance)))


def test_the_bend_of_a_sheet_is_half_the_tag_over_its_radius():
    cMt = tag_pose(0.65, yaw_rad=0.3)
    tracker = vision.TagTracker(camera=VGA, body=LEADER)
    place = tracker.predict_at(SHEET.tag_id, corners_px=corners_px(VGA, cMt)).nHt
    bent = tracker.align(photograph(cMt, sheet=CONDITION["curved"].sheet), SHEET.tag_id, nHt=place)
    # Bent about the upright axis alone, away from the camera, into which z points: 0.08 m / 0.35 m.
    assert bent.bend.ravel() == pytest.approx([0.08 / 0.35, 0.0, 0.0], abs=0.02)
    assert np.array_equal(tracker.align(photograph(cMt), SHEET.tag_id, nHt=place).bend.ravel(), np.zeros(3))


def test_a_ring_of_a_third_of_a_cell_before_something_dark_does_not_hide_a_far_tag():
    # At 2.44 m a third of a cell are 1.6 px: the blur mixes what lies beyond into every pixel of the outer edges.
    sheet = dataclasses.replace(SHEET, ring_cells=0.33, board=0.04)
    for yaw_deg in (-20, 0, 20):
        cMt = tag_pose(2.44, yaw_rad=np.radians(yaw_deg))
        answer = Ours(VGA, LEADER, tracking=False).track(photograph(cMt, seed=5, sheet=sheet), 1)
        assert answer.cMt is not None
        off = np.abs(off_by(answer.claim, cMt))
        assert np.all(off < 5.0 * np.sqrt(np.diag(answer.claim.covariance)))


def test_a_far_print_on_which_white_bleeds_into_black_is_read_at_a_slant():
    # Exposed three times too long, seen at 50 degrees: cells of 3 px, compared pixel by pixel.
    chain = CONDITION["white-out"].chain
    for yaw_deg in (-50, 50):
        cMt = tag_pose(2.44, yaw_rad=np.radians(yaw_deg))
        assert Ours(VGA, LEADER, tracking=False).track(photograph(cMt, chain=chain), 1).cMt is not None


def test_a_tag_that_is_followed_is_used_while_it_is_partly_outside():
    figures = followed("partly outside", 0.38, count=40)
    assert figures.seen == 1.0
    assert figures.p95_mm < 1.0
    assert figures.wrong == 0


def test_a_tag_that_is_partly_outside_is_not_acquired():
    # 0.13 rad to the left of the edge at 0.49 rad are 78 px; half a tag at 0.5 m is 96 px.
    image = photograph(tag_pose(0.5, azimuth_rad=0.36))
    assert vision.LeaderObserver(camera=VGA, body=LEADER).observe(core.Frame(image, utime=1)).observation is None


@pytest.mark.parametrize("name", ["typical", "webcam", "JPEG 90", "JPEG 30", "lens", "sharpened"])
@pytest.mark.parametrize("distance_m", [0.65, 2.44])
def test_the_covariance_is_true_in_a_camera_that_was_not_modelled(name, distance_m):
    # Chi-squared per degree of freedom is 1 for a true covariance; twice that is the bound.
    figures = followed(name, distance_m)
    assert figures.seen == 1.0
    assert figures.chi2 < 2.0
    assert figures.wrong == 0


def test_a_leader_of_other_bits_in_the_same_shadow_is_not_taken_for_it():
    # Local levels must not explain wrong bits away: any other id, at the very place where the leader is expected.
    shadow = dataclasses.replace(CONDITION["shadow edge"].lighting, shadow_angle_rad=0.7)
    cMt = tag_pose(1.1, yaw_rad=0.2)
    for other in (3, 17, 99, 200, 321, 450):
        eye = vision.LeaderObserver(camera=VGA, body=LEADER)
        assert eye.observe(core.Frame(photograph(cMt), utime=1_000_000)).observation is not None
        rng = np.random.default_rng(other)
        light = printed_sheet.backdrop(VGA, rng)[:, : VGA.width].copy()
        printed_sheet.show(light, VGA, cMt, dataclasses.replace(SHEET, tag_id=other), shadow)
        assert eye.observe(core.Frame(TYPICAL.photograph(light, rng), utime=1_033_333)).observation is None


def test_the_error_of_a_claim_is_counted_from_the_leader_that_was_shown():
    cMt = tag_pose(1.1, azimuth_rad=-0.1, yaw_rad=0.3)
    eye = vision.LeaderObserver(camera=VGA, body=LEADER)
    seen = eye.observe(core.Frame(photograph(cMt), utime=1)).observation
    claim = Ours(VGA, LEADER, tracking=False).track(photograph(cMt), 1).claim
    assert np.abs(off_by(claim, cMt)).max() < 0.01
    assert claim.value == pytest.approx([seen.distance_m, seen.bearing_rad, seen.heading_rad])

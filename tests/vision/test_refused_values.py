"""A refusal says what was measured and what is allowed, beside its reason."""

import re

import numpy as np
import pytest
from rendered_leaders import BODY, TAG, frame, leader_at, observer, render

from pilotfish.core import BodyTag, LeaderBody
from pilotfish.vision import LeaderPoseConfig, TagDetectorConfig, TagGates

HERE = (1.1, 0.0, 0.2)
CLAIMED = LeaderBody([TAG, BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.0, 0.3])])
REAL = LeaderBody([TAG, BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.0, 0.4])])


def picture(pose=HERE, body=BODY, **imperfections):
    return render([(body, leader_at(*pose))], 1, **imperfections)


def foggy():
    clear = picture(noise_sigma=0.0).astype(float)
    return np.rint(120 + 0.6 * (clear - 120)).astype(np.uint8)


# The numbers: the same pictures in test_refusals.py.
@pytest.mark.parametrize(
    ("image", "config", "quantity", "least", "most", "allowed"),
    [
        (picture(), {"gates": TagGates(min_cell_px=12.0)}, "side of a cell", 10.0, 11.0, "px, at least 12 px"),
        (
            picture(blur_sigma_px=1.5),
            {"gates": TagGates(max_blur_cells=0.1)},
            "blur",
            1.3,
            1.7,
            r"px, at most 1\.\d+ px",
        ),
        (picture(), {"pose": LeaderPoseConfig(max_distance_m=1.0)}, "range", 1.05, 1.2, r"m, accepted 0\.\d+ to 1 m"),
    ],
    ids=["small", "blurred", "far"],
)
def test_a_refused_tag_comes_with_its_number_and_the_limit(image, config, quantity, least, most, allowed):
    detail = observer(**config).observe(frame(image, 0)).detail
    said = re.fullmatch(rf"{quantity} ([\d.]+) {allowed}", detail)
    assert said, detail
    assert least < float(said[1]) < most


def test_a_followed_tag_that_turns_pale_comes_with_its_contrast():
    # 190 gray levels, of which a fog leaves 60 %.
    eye = observer(detector=TagDetectorConfig(min_decision_margin=150.0))
    eye.observe(frame(picture(), 0))
    detail = eye.observe(frame(foggy(), 1)).detail
    said = re.fullmatch(r"contrast ([\d.]+) gray levels, at least 150 gray levels", detail)
    assert said, detail
    assert 100 < float(said[1]) < 120


def test_tags_that_do_not_hang_as_the_body_says_come_with_their_error():
    # 40 px off, of which the best pose leaves about half in each of the two tags.
    detail = observer(CLAIMED).observe(frame(picture((1.5, 0.0, 0.0), REAL), 0)).detail
    said = re.fullmatch(r"reprojection error ([\d.]+) px, at most 3 px", detail)
    assert said, detail
    assert 3 < float(said[1]) < 40


def test_a_leader_that_jumped_comes_with_its_jump():
    # 1.4 m in a frame; 0.1 m + 4 m/s x 33 ms = 0.233 m are allowed.
    eye = observer()
    eye.observe(frame(picture(), 0))
    detail = eye.observe(frame(picture((2.5, 0.0, 0.2)), 1)).detail
    said = re.fullmatch(r"jump along the line of sight ([\d.]+) m, at most 0\.233 m", detail)
    assert said, detail
    assert 1.38 < float(said[1]) < 1.42


def test_an_accepted_leader_and_a_missing_one_have_no_number():
    eye = observer()
    assert eye.observe(frame(picture(), 0)).detail == ""
    assert eye.observe(frame(np.full((480, 640), 120, np.uint8), 1)).detail == ""

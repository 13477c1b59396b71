"""The tracker's stages one by one, and how long each takes."""

import numpy as np
import pytest
from rendered_leaders import BODY, CAMERA, TAG, bits_of, frame, leader_at, observer, render, true_corners

from pilotfish.vision import TagMeasurement, TagRefusal, TagTracker

STAGES = ["predict", "detect", "search", "align", "read", "pose", "heading"]
HERE = leader_at(1.1, 0.05, 0.2)


@pytest.fixture(scope="module")
def image():
    return render([(BODY, HERE)], 1)


def test_the_stages_one_by_one_say_what_track_says(image):
    tracker = TagTracker(camera=CAMERA, body=BODY)
    prediction = tracker.predict(TAG.id, cMo=leader_at(1.1, 0.06, 0.2))  # some 6 px aside
    nHt = tracker.search(image, prediction)
    fit = tracker.align(image, TAG.id, nHt=nHt)
    by_stages, at_once = tracker.read(image, TAG.id, registration=fit), tracker.track(image, prediction)
    assert isinstance(by_stages, TagMeasurement)
    assert np.array_equal(by_stages.tag.corners_px, at_once.tag.corners_px)
    assert np.array_equal(by_stages.covariance_px2, at_once.covariance_px2)
    assert np.abs(fit.corners_px - true_corners(HERE)).max() < 0.1


def test_a_prediction_from_a_pose_is_the_one_from_its_corners():
    tracker = TagTracker(camera=CAMERA, body=BODY)
    from_pose = tracker.predict(TAG.id, cMo=HERE).nHt
    from_corners = tracker.predict_at(TAG.id, corners_px=true_corners(HERE)).nHt
    assert from_pose / from_pose[2, 2] == pytest.approx(from_corners, abs=1e-9)


def test_each_stage_says_for_itself_why_it_refuses(image):
    tracker = TagTracker(camera=CAMERA, body=BODY)
    assert tracker.predict(TAG.id, cMo=leader_at(1.1, 0.0, np.pi)) is None  # it shows its face, the tag is on its back
    assert tracker.search(np.full_like(image, 128), tracker.predict(TAG.id, cMo=HERE)) == TagRefusal.not_found
    with pytest.raises(KeyError, match="4"):
        tracker.predict(4, cMo=HERE)


def test_stages_are_timed_only_if_asked_for_and_change_nothing(image):
    timed, untimed = observer(), observer()
    timed.timed = True
    assert (timed.timed, untimed.timed) == (True, False)
    for k in range(3):
        both = [eye.observe(frame(image, k)).observation for eye in (timed, untimed)]
        assert bits_of(both[0]) == bits_of(both[1]) is not None
        times = timed.stage_times_us
        assert list(times) == STAGES
        # What is followed is not detected; fitting some 300 samples takes a clock's tick at least.
        assert (times["detect"] > 0) == (k == 0)
        assert times["align"] > 0
    assert set(untimed.stage_times_us.values()) == {0.0}
    timed.timed = False
    timed.observe(frame(image, 3))
    assert set(timed.stage_times_us.values()) == {0.0}

"""LeaderObserver over time: it follows, falls back, and says the same as one that begins anew with every frame."""

import numpy as np
import pytest
from rendered_leaders import (
    BODY,
    ROOF,
    bits_of,
    error_of,
    frame,
    leader_at,
    observer,
    render,
    squared_in_sigmas,
    true_corners,
)
from scipy import stats

from pilotfish.core import BodyTag, FoundBy, LeaderBody, Reason

FRAMES = 60


def path(k, distance=1.1):
    """(d, theta, psi) at frame k of a smooth drive: 0.25 m/s along, 0.2 m/s across, turning by 30 degrees a second."""
    t = k / 30
    return distance + 0.25 * np.sin(t), 0.2 * np.sin(t / distance), 0.15 + 0.5 * np.sin(t)


def picture(pose, seed, body=BODY, **imperfections):
    return render([(body, leader_at(*pose))], seed, **imperfections)


@pytest.fixture(scope="module")
def drives():
    """{distance: [(truth, tracked observation, acquired observation)]} of FRAMES frames, as fast as a robot moves."""
    seen = {}
    for distance in (0.75, 1.5, 2.44):
        follower, forgetful, seen[distance] = observer(), observer(), []
        for k in range(FRAMES):
            truth = path(k, distance)
            image = picture(truth, k)
            forgetful.forget()
            seen[distance].append(
                (truth, follower.observe(frame(image, k)).observation, forgetful.observe(frame(image, k)).observation)
            )
    return seen


@pytest.mark.parametrize("distance", [0.75, 1.5, 2.44])
def test_a_leader_is_found_in_the_frame_and_then_followed(drives, distance):
    followed = [tracked.found_by for _, tracked, _ in drives[distance]]
    assert followed == [FoundBy.frame] + [FoundBy.track] * (FRAMES - 1)
    assert all(acquired.found_by == FoundBy.frame for _, _, acquired in drives[distance])


@pytest.mark.parametrize("distance", [0.75, 1.5, 2.44])
def test_what_is_tracked_is_what_is_acquired(drives, distance):
    # Same frame, same fit, other start: both rest at the same minimum, but on other samples of it. They share the
    # frame's noise, so their difference has less variance than each; at most 3 degrees of freedom's 99.9 % in the
    # covariance of one alone. Where both took the same of the two planar solutions, that is.
    squared = []
    for _, tracked, acquired in drives[distance]:
        difference = error_of(tracked.measured, error_of(acquired.measured, np.zeros(3)))
        if abs(difference[2]) < np.radians(10):
            squared.append(squared_in_sigmas(difference, tracked.measured.covariance))
    assert len(squared) >= 0.9 * FRAMES
    assert max(squared) < stats.chi2.ppf(0.999, 3)


@pytest.mark.parametrize("distance", [0.75, 1.5, 2.44])
def test_each_frames_measurement_is_as_wrong_as_it_says(drives, distance):
    # e^T C^-1 e of `measured` is chi-squared with 3 degrees of freedom; the sum over n frames with 3 n, if the frames'
    # noise is independent, and it is. Two-sided, 99.9 %; less surely from below, because corner_sigma_px allows for a
    # printer and a calibration that are perfect here: 0.005 px beside some 0.011 px, (0.005 / 0.011)^2 = 20 %.
    squared = [
        squared_in_sigmas(error_of(o.measured, truth), o.measured.covariance) for truth, o, _ in drives[distance]
    ]
    low, high = stats.chi2.interval(0.999, 3 * len(squared))
    assert low / 1.2 < np.sum(squared) < high


@pytest.mark.parametrize("distance", [0.75, 1.5, 2.44])
def test_the_filter_makes_no_heading_worse(drives, distance):
    # What is fused has less variance than what the frame says alone, and less error on the whole.
    later = drives[distance][10:]
    alone = [error_of(o.measured, truth)[2] for truth, o, _ in later]
    fused = [error_of(o, truth)[2] for truth, o, _ in later]
    assert all(
        o.covariance[2, 2] <= o.measured.covariance[2, 2] * 1.001 for _, o, _ in later if o.heading_ambiguity < 1e-6
    )
    assert np.sqrt(np.mean(np.square(fused))) <= 1.05 * np.sqrt(np.mean(np.square(alone)))


def test_two_observers_say_the_same_bits():
    first, second = observer(), observer()
    for k in range(20):
        shown = frame(picture(path(k), k), k)
        assert bits_of(first.observe(shown).observation) == bits_of(second.observe(shown).observation)


def test_a_jump_is_caught_up_with_in_the_same_frame():
    # 0.18 rad at 1.1 m are 600 tan(0.18) = 109 px and 0.2 m within one frame: nothing lies where the leader should be,
    # and it is farther off than a tag is looked for (40 px); but 0.1 m of slack and 4 m/s plus 4 rad/s times the
    # distance for 33 ms (0.28 m) allow it.
    eye = observer()
    for k in range(3):
        eye.observe(frame(picture((1.1, 0.0, 0.2), k), k))
    sight = eye.observe(frame(picture((1.1, 0.18, 0.2), 3), 3))
    assert sight.observation.found_by in (FoundBy.region, FoundBy.frame)
    assert sight.observation.bearing_rad == pytest.approx(0.18, abs=0.001)
    # That it stands there now and does not go on at 6 m/s costs one more search; then it is followed again.
    later = [eye.observe(frame(picture((1.1, 0.18, 0.2), k), k)).observation.found_by for k in range(4, 7)]
    assert later[1:] == [FoundBy.track] * 2
    assert eye.rejected.jump == 0


@pytest.mark.parametrize(("missing", "found_by"), [(13, {FoundBy.track, FoundBy.region}), (16, {FoundBy.frame})])
def test_after_half_a_second_the_whole_frame_is_searched(missing, found_by):
    # 14 periods are 0.47 s, 17 are 0.57 s; memory_s is 0.5.
    eye = observer()
    for k in range(3):
        eye.observe(frame(picture((1.1, 0.0, 0.2), k), k))
    for k in range(3, 3 + missing):
        sight = eye.observe(frame(render([], k), k))
        assert (sight.observation, sight.reason) == (None, Reason.no_tag_found)
    back = eye.observe(frame(picture((1.1, 0.0, 0.2), 50), 3 + missing)).observation
    assert back.found_by in found_by
    assert back.distance_m == pytest.approx(1.1, abs=0.005)


def test_a_leader_that_cannot_have_moved_so_far_is_refused_and_accepted_again_later():
    # From 1.1 to 2.5 m: 0.1 m of slack and 4 m/s allow it after (1.4 - 0.1) / 4 = 0.325 s, which is frame 10 after the
    # last sighting; before that every frame is refused.
    eye = observer()
    for k in range(3):
        eye.observe(frame(picture((1.1, 0.0, 0.2), k), k))
    sights = [eye.observe(frame(picture((2.5, 0.0, 0.2), k), k)) for k in range(3, 14)]
    assert [sight.reason for sight in sights] == [Reason.leader_jumped] * 9 + [Reason.none] * 2
    assert eye.rejected.jump == 9
    assert sights[-1].observation.distance_m == pytest.approx(2.5, abs=0.01)


def test_frames_may_come_as_they_like():
    # A camera drops frames and a computer is late: 10 to 150 ms apart, and the motion is that of the time. Nothing is
    # lost, and nothing is worse than what a frame by itself says.
    rng, eye, k, missed, squared = np.random.default_rng(3), observer(), 0.0, 0, []
    for step in range(60):
        k += rng.uniform(0.3, 4.5)
        truth = path(k)
        found = eye.observe(frame(picture(truth, step), k)).observation
        if found is None:
            missed += 1
        else:
            assert found.utime == 1_000_000 + round(k * 33_333)
            squared.append(squared_in_sigmas(error_of(found.measured, truth), found.measured.covariance))
    assert missed == 0
    assert np.sum(squared) < stats.chi2.ppf(0.9995, 3 * len(squared))


def test_a_body_with_two_planes_is_followed_with_all_its_tags():
    eye, errors = observer(ROOF), []
    for k in range(40):
        truth = path(k, 1.6)
        found = eye.observe(frame(picture(truth, k, ROOF), k)).observation
        assert found.found_by == (FoundBy.track if k else FoundBy.frame)
        assert [tag.id for tag in found.tags] == [1, 2]
        assert found.other_cMo is None
        errors.append(squared_in_sigmas(error_of(found.measured, truth), found.measured.covariance))
    assert np.sum(errors) < stats.chi2.ppf(0.9995, 3 * len(errors))


# Mixed sizes on three faces, as a robot might wear them.
CHEST = LeaderBody(
    [
        BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.0, 0.0]),
        BodyTag(id=5, size_m=0.08, position_m=[0.1, 0.12, 0.0], facing_rad=np.pi / 2),
        BodyTag(id=6, size_m=0.12, position_m=[0.1, -0.12, 0.05], facing_rad=-np.pi / 2),
        BodyTag(id=7, size_m=0.05, position_m=[0.0, 0.0, 0.13]),
    ]
)


def test_tags_come_into_view_and_go():
    # The leader turns by 75 degrees each way in front of the camera at 0.9 m. Its side tags are seen when it is turned
    # by more than some 12 degrees (they are looked at from a cosine of 0.2 on), the rear ones up to 78 degrees.
    eye, ids, squared = observer(CHEST), [], []
    for k in range(75):
        truth = (0.9, 0.0, np.radians(75) * np.sin(2 * np.pi * k / 75))
        found = eye.observe(frame(picture(truth, k, CHEST), k)).observation
        ids.append({tag.id for tag in found.tags})
        squared.append(squared_in_sigmas(error_of(found.measured, truth), found.measured.covariance))
    turned = [75 * np.sin(2 * np.pi * k / 75) for k in range(75)]
    assert all(6 not in seen for seen, angle in zip(ids, turned, strict=True) if angle > 5)
    assert all(5 not in seen for seen, angle in zip(ids, turned, strict=True) if angle < -5)
    assert any({4, 5} <= seen for seen in ids) and any({4, 6} <= seen for seen in ids)
    assert any(7 in seen for seen in ids)
    assert np.sum(squared) < stats.chi2.ppf(0.9995, 3 * len(squared))


def test_a_tag_that_is_hidden_is_left_out_and_the_other_still_followed():
    # The left tag is covered with gray up to its right rim, the other one is whole.
    eye = observer(ROOF)
    for k in range(30):
        truth, hidden = path(k, 1.6), 10 <= k < 20
        image = picture(truth, k, ROOF)
        left_px, right_px = (true_corners(leader_at(*truth), tag) for tag in ROOF.tags)
        if hidden:
            image[:, int(left_px[:, 0].min()) - 10 : int(left_px[:, 0].max())] = 128
        assert left_px[:, 0].max() < right_px[:, 0].min()
        found = eye.observe(frame(image, k)).observation
        assert [tag.id for tag in found.tags] == ([2] if hidden else [1, 2])
        assert found.found_by == (FoundBy.track if k else FoundBy.frame)
        assert np.abs(error_of(found, truth)[:2]).max() < 0.02


@pytest.mark.parametrize("gain", [0.5, 1.5])
def test_a_change_of_light_from_one_frame_to_the_next_loses_nothing(gain):
    # Of white 220 and black 30, gain 1.5 leaves 255 and 45: clipped paper, which moves the edge of a ramp that is cut
    # off at (255 - 45) / (330 - 45) = 74 % of its height the same way for all white cells; hence no chi-squared there.
    eye = observer()
    for k in range(30):
        truth = path(k)
        image = picture(truth, k, exposure_gain=gain if k % 10 >= 5 else 1.0)
        found = eye.observe(frame(image, k)).observation
        assert found.found_by == (FoundBy.track if k else FoundBy.frame)
        assert np.abs(error_of(found, truth)[:2]).max() < 0.003


def test_forgetting_is_starting_anew():
    eye, fresh = observer(), observer()
    for k in range(5):
        eye.observe(frame(picture(path(k), k), k))
    eye.forget()
    shown = frame(picture(path(40), 40), 40)
    assert bits_of(eye.observe(shown).observation) == bits_of(fresh.observe(shown).observation)

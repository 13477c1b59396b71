"""LeaderObserver on drawn pictures: accuracy against the truth, refusals with their reasons, counters."""

from dataclasses import replace

import numpy as np
import pytest
from pinhole_drawing import Photography, draw, leader_pose, pose, rotation

from pilotfish.core import BodyTag, CameraModel, CameraMounting, Frame, LeaderBody, Reason
from pilotfish.vision import LeaderObserver, LeaderObserverConfig, LeaderPoseConfig, TagDetector, TagDetectorConfig

CAMERA = CameraModel(width=640, height=480, fx=600, fy=600, cx=319.5, cy=239.5)
TAG = BodyTag(id=3, size_m=0.16)
BODY = LeaderBody([TAG])
REAL = Photography(blur_sigma_px=0.7, noise_sigma=3.0)
# What fitting the whole template leaves of noise of 3 gray levels: an edge one pixel long is placed to
# 3 / 185 sqrt(2 sqrt(pi) 0.76) = 0.027 px (the ramp's slope is 185 grays over its blur of 0.76 px); a corner hangs on
# two sides of some 20 px of edge each, at least: 0.027 / sqrt(20) = 0.006 px, and the shape of the blur adds as much.
CORNER_SIGMA_PX = 0.02


def observer(body=BODY, camera=CAMERA, mounting=None, detector=None, pose_config=None, acquisition_range_m=3.5):
    config = LeaderObserverConfig(
        acquisition_range_m=acquisition_range_m,
        detector=detector or TagDetectorConfig(),
        pose=pose_config or LeaderPoseConfig(),
    )
    return LeaderObserver(camera=camera, mounting=mounting or CameraMounting(), body=body, config=config)


def leader_at(distance_m, bearing_rad, heading_rad, height_m=0.0):
    x, y = distance_m * np.cos(bearing_rad), distance_m * np.sin(bearing_rad)
    return leader_pose(x, y, heading_rad, height_m)


def picture(tags, photography=REAL, camera=CAMERA):
    return draw(camera, tags, photography)


def observe(image, **options):
    return observer(**options).observe(Frame(image, utime=1))


@pytest.fixture(scope="module")
def renders():
    """Of 16 leaders per distance: {distance: [(observation, error of (d, theta, psi))]}."""
    rng, eye, found = np.random.default_rng(1), observer(acquisition_range_m=6.0), {}
    for distance in (0.65, 1.1, 2.44, 5.0):
        found[distance] = []
        for i in range(16):
            bearing, heading = rng.uniform(-0.2, 0.2), np.radians(rng.uniform(-60, 60))
            cMo = leader_at(distance, bearing, heading, rng.uniform(-0.1, 0.1) * distance)
            eye.forget()
            sight = eye.observe(Frame(picture([(TAG, cMo)], replace(REAL, seed=i)), utime=i))
            if sight.observation is not None:
                o = sight.observation
                error = [o.distance_m - distance, o.bearing_rad - bearing, o.heading_rad - heading]
                found[distance].append((o, np.array(error)))
    return found


@pytest.mark.parametrize(("distance", "median_in_sigmas"), [(0.65, 1.0), (1.1, 1.0), (2.44, 1.5), (5.0, 2.0)])
def test_the_distance_error_grows_as_the_square_of_the_distance(renders, distance, median_in_sigmas):
    # The range is that of the tag's side in the picture, p = f s / d, so dd = d^2 dp / (f s). The mean of
    # four sides, each the difference of two corners with noise sigma, has sqrt(2) sigma / sqrt(4) = 0.71
    # sigma. For a normal error the median is 0.67 of that and 95 % lie within twice; with cells of 2.4 px
    # (5 m) it is worse.
    sigma_d = distance**2 * 0.71 * CORNER_SIGMA_PX / (CAMERA.fx * TAG.size_m)
    errors = np.abs([error[0] for _, error in renders[distance]])
    assert len(errors) >= 12  # at 5 m and 50 degrees a cell is 1.5 px wide: beyond, no detector finds it
    assert np.median(errors) < median_in_sigmas * sigma_d
    assert np.percentile(errors, 95) < 2.5 * median_in_sigmas * sigma_d


def test_the_bearing_has_no_half_pixel_bias(renders):
    # Half a pixel is 0.5 / 600 rad = 0.048 degrees. Leaving it in, or taking it out twice, must show.
    errors = np.degrees([error[1] for distance in renders for _, error in renders[distance]])
    assert abs(np.mean(errors)) < 0.048 / 4
    assert np.abs(errors).max() < 0.048


@pytest.mark.parametrize(("distance", "bound_deg"), [(0.65, 0.5), (1.1, 1.0)])
def test_the_heading_is_seen_where_the_tag_is_large(renders, distance, bound_deg):
    # A turn by a of a tag of p pixels, seen at an angle b, narrows it by p sin(b) a and moves its near side
    # by perspective: p s a / (2 d). With p = 148 px at 0.65 m and b = 0 that is 18 px/rad: 0.12 px are 0.4
    # degrees at worst, and less from the side. At 1.1 m p = 87 px: 6.3 px/rad, 1.1 degrees at worst.
    errors = np.degrees(np.abs([error[2] for _, error in renders[distance]]))
    assert np.percentile(errors, 95) < bound_deg


def test_the_covariance_is_that_of_the_pose_carried_to_distance_bearing_and_heading():
    # How the corners' noise reaches the pose is tested with the pose. Here: the same leader left and right of
    # the axis has the same covariance, with the signs of bearing and heading turned. Its size comes from the
    # noise measured on some 280 samples, so to sqrt(2 / 280) = 8.5 % on each side: 12 % between the two, and 2.5
    # standard deviations of that are 0.3.
    left = observe(picture([(TAG, leader_at(1.1, 0.3, -0.5))])).observation.covariance
    right = observe(picture([(TAG, leader_at(1.1, -0.3, 0.5))])).observation.covariance
    mirrored = np.diag([1, -1, -1]) @ right @ np.diag([1, -1, -1])
    assert np.allclose(left, left.T)
    assert np.linalg.eigvalsh(left).min() > 0
    assert np.abs(left - mirrored).max() < 0.3 * np.abs(left).max()


def test_a_coarse_search_finds_the_near_leader_and_not_the_far_one_and_follows_both():
    # A tag of 0.16 m and 8 cells at 600 px: 12 / d px a cell. The range of 3.5 m gives 3.4 px and decimation 2 (1.55 px
    # a cell are needed); coarse is 4: at 1.5 m 2.0 px a cell, enough; at 3.3 m 0.9 px, too few.
    for distance_m, found_coarsely in ((1.5, True), (3.3, False)):
        image = picture([(TAG, leader_at(distance_m, 0.05, 0.1))])
        coarse, whole = Frame(image, utime=1), Frame(image, utime=1)
        coarse.coarse_search = True
        assert (observer().observe(coarse).observation is not None) == found_coarsely
        eye = observer()
        assert eye.observe(whole).observation is not None
        followed = Frame(image, utime=33_334)  # not searched, so not coarsely
        followed.coarse_search = True
        assert eye.observe(followed).observation is not None


def test_a_leader_too_far_for_the_decimated_search_is_found_in_the_parts_with_detail():
    # From 6 m on, turned by 0.6 rad, a cell is 12 / 6 cos(0.6) = 1.65 px wide, and half of that where every other pixel
    # is left out. How the tag lies on those is luck; where that search misses it, the one of the parts does not.
    decimated, missed = TagDetector(config=TagDetectorConfig(decimation=2.0)), 0
    for distance_m in (6.0, 6.5, 7.0):
        for bearing_rad, height_m in ((-0.35, 1.5), (0.0, 0.0), (0.3, -1.7), (0.1, 0.3)):
            image = picture([(TAG, leader_at(distance_m, bearing_rad, bearing_rad + 0.6, height_m))])
            missed += not decimated.detect(image).tags
            seen = observer().observe(Frame(image, utime=1)).observation
            assert seen is not None
            assert seen.bearing_rad == pytest.approx(bearing_rad, abs=1 / 600)  # a pixel
    assert missed >= 6, "the test would test nothing"


def test_the_mounting_turns_and_moves_what_is_seen():
    cMo = leader_at(1.5, 0.1, 0.4)
    image = picture([(TAG, cMo)])
    plain = observe(image).observation
    panned = observe(image, mounting=CameraMounting(pan_rad=0.3)).observation
    assert panned.distance_m == pytest.approx(plain.distance_m, abs=1e-9)
    assert panned.bearing_rad == pytest.approx(plain.bearing_rad + 0.3, abs=1e-9)
    assert panned.heading_rad == pytest.approx(plain.heading_rad + 0.3, abs=1e-9)
    ahead = observe(image, mounting=CameraMounting(position_m=[0.2, 0.0, 0.3])).observation
    x, y = plain.distance_m * np.cos(plain.bearing_rad), plain.distance_m * np.sin(plain.bearing_rad)
    assert ahead.distance_m == pytest.approx(np.hypot(x + 0.2, y), abs=1e-9)
    assert ahead.heading_rad == pytest.approx(plain.heading_rad, abs=1e-9)


def test_two_planes_give_a_better_heading_and_no_ambiguity():
    # Frontal at 3 m: one tag of 32 px hardly tells its heading, two tags turned by 45 degrees do.
    roof = LeaderBody(
        [
            BodyTag(id=1, size_m=0.16, position_m=[0.0, 0.12, 0.0], facing_rad=np.radians(135)),
            BodyTag(id=2, size_m=0.16, position_m=[0.0, -0.12, 0.0], facing_rad=np.radians(-135)),
        ]
    )
    errors, ratios = {"flat": [], "roof": []}, {"flat": [], "roof": []}
    vision = {"flat": observer(), "roof": observer(body=roof)}
    rng = np.random.default_rng(4)
    for i in range(12):
        heading = rng.uniform(-0.1, 0.1)
        cMo = leader_at(3.0, rng.uniform(-0.1, 0.1), heading)
        for name, tags in (("flat", [TAG]), ("roof", roof.tags)):
            image = picture([(tag, cMo) for tag in tags], replace(REAL, seed=i))
            vision[name].forget()
            found = vision[name].observe(Frame(image, utime=i)).observation
            errors[name].append(abs(found.heading_rad - heading))
            ratios[name].append(found.ambiguity_ratio)
    # A flat tag sometimes has one wide minimum instead of two; then only the covariance tells. But it cannot
    # be relied on.
    assert min(ratios["roof"]) > 10 > 3 > min(ratios["flat"])
    assert np.median(errors["roof"]) < np.median(errors["flat"]) / 2
    assert np.degrees(np.max(errors["roof"])) < 2.0


def test_strong_distortion_is_taken_out():
    bent = CameraModel(width=640, height=480, fx=450, fy=450, cx=325, cy=235, k1=-0.28, k2=0.08, p1=0.006, p2=-0.004)
    straight = CameraModel(width=640, height=480, fx=450, fy=450, cx=325, cy=235)
    eye, naive = observer(camera=bent), observer(camera=straight)
    rng, errors, naive_errors = np.random.default_rng(3), [], []
    for i in range(10):
        bearing = rng.choice([-1, 1]) * rng.uniform(0.3, 0.42)  # near the left and right edges
        truth = np.array([1.1, bearing])
        cMo = leader_at(1.1, bearing, bearing + np.radians(30), rng.uniform(-0.2, 0.2))
        frame = Frame(picture([(TAG, cMo)], replace(REAL, seed=i), bent), utime=i)
        for tracker_of, into in ((eye, errors), (naive, naive_errors)):
            tracker_of.forget()
            found = tracker_of.observe(frame).observation
            into.append(np.abs([found.distance_m, found.bearing_rad] - truth))
    # As in the distance test, 95 % within 2.5 x 0.71 x 0.12 px x d^2 / (f s); the bearing within half a
    # pixel.
    assert np.percentile(np.array(errors)[:, 0], 95) < 2.5 * 0.71 * CORNER_SIGMA_PX * 1.1**2 / (450 * 0.16)
    assert np.array(errors)[:, 1].max() < 0.5 / 450
    assert np.median(naive_errors, axis=0)[1] > 10 * np.median(errors, axis=0)[1]


def test_a_frame_of_another_size_than_the_calibration_is_refused_not_scaled():
    eye = observer()
    for size in ((240, 320), (480, 639), (640, 480)):
        sight = eye.observe(Frame(np.zeros(size, np.uint8), utime=1))
        assert (sight.observation, sight.reason) == (None, Reason.frame_size_not_calibrated)
    assert eye.rejected.frames_invalid == 3


@pytest.mark.parametrize(
    ("size_bytes", "width", "height", "stride_bytes", "reason"),
    [
        (0, 0, 0, 0, Reason.frame_too_small),
        (1, 1, 1, 1, Reason.frame_too_small),
        (40000 * 16, 40000, 16, 40000, Reason.frame_too_large),
        (640 * 480, 640, 480, 600, Reason.frame_stride_invalid),
        (640 * 479, 640, 480, 640, Reason.frame_truncated),
    ],
)
def test_a_frame_that_cannot_be_read_is_refused_with_its_reason(size_bytes, width, height, stride_bytes, reason):
    eye = observer()
    frame = Frame.unchecked(bytes(size_bytes), width=width, height=height, stride_bytes=stride_bytes, utime=1)
    sight = eye.observe(frame)
    assert (sight.observation, sight.reason) == (None, reason)
    assert eye.rejected.frames_invalid == 1


def test_an_empty_picture_has_no_tag():
    assert observe(picture([])).reason == Reason.no_tag_found


def test_a_foreign_tag_is_counted_and_not_followed():
    eye = observer()
    foreign = (BodyTag(id=9, size_m=0.16), leader_at(1.5, 0.2, 0.0))
    sight = eye.observe(Frame(picture([foreign]), utime=1))
    assert (sight.observation, sight.reason) == (None, Reason.no_tag_of_the_leader)
    assert eye.rejected.foreign_id == 1
    both = eye.observe(Frame(picture([foreign, (TAG, leader_at(1.5, -0.2, 0.0))]), utime=2))
    assert [tag.id for tag in both.observation.tags] == [3]
    assert both.observation.bearing_rad == pytest.approx(-0.2, abs=0.01)
    assert eye.rejected.foreign_id == 2


def test_an_id_seen_twice_is_accepted_neither_time():
    twins = [(TAG, leader_at(1.5, 0.2, 0.0)), (TAG, leader_at(1.5, -0.2, 0.0))]
    eye = observer()
    sight = eye.observe(Frame(picture(twins), utime=1))
    assert (sight.observation, sight.reason) == (None, Reason.tag_duplicate)
    assert eye.rejected.duplicate_id == 2
    # Another tag of the leader is still good.
    other = BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.0, 0.3])
    eye = observer(body=LeaderBody([TAG, other]))
    sight = eye.observe(Frame(picture([*twins, (other, leader_at(1.5, 0.2, 0.0))]), utime=1))
    assert [tag.id for tag in sight.observation.tags] == [4]
    assert eye.rejected.duplicate_id == 2


def test_a_gate_on_the_leaders_tag_is_counted_and_named():
    image = picture([(TAG, leader_at(1.5, 0.0, 0.0))])
    eye = observer(detector=TagDetectorConfig(min_decision_margin=255.0))
    assert eye.observe(Frame(image, utime=1)).reason == Reason.tag_refused
    assert (eye.rejected.margin, eye.rejected.hamming) == (1, 0)
    # A refused tag that the leader does not wear is not the leader's trouble.
    eye = observer(body=LeaderBody([BodyTag(id=4)]), detector=TagDetectorConfig(min_decision_margin=255.0))
    assert eye.observe(Frame(image, utime=1)).reason == Reason.no_tag_found


def test_a_leader_beyond_the_range_is_refused():
    image = picture([(TAG, leader_at(1.5, 0.0, 0.3))])
    assert observe(image, pose_config=LeaderPoseConfig(max_distance_m=1.6)).reason == Reason.none
    eye = observer(pose_config=LeaderPoseConfig(max_distance_m=1.4))
    assert eye.observe(Frame(image, utime=1)).reason == Reason.tag_size_implausible
    assert eye.rejected.size == 1


def test_tags_that_do_not_hang_as_the_body_says_are_refused():
    # The body claims 0.3 m between two tags that hang 0.4 m apart: at 1.5 m and f = 600 px that is 40 px.
    claimed = LeaderBody([TAG, BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.0, 0.3])])
    cMo = leader_at(1.5, 0.0, 0.0, -0.2)
    image = picture([(TAG, cMo), (BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.0, 0.4]), cMo)])
    assert observe(image, body=claimed).reason == Reason.pose_refused


def test_the_back_of_a_leader_without_tags_there_is_not_seen():
    assert observe(picture([(TAG, leader_at(1.5, 0.0, np.pi))])).reason == Reason.no_tag_found


def test_a_tag_that_leaves_the_picture_is_never_seen_wrongly():
    # Slid out to the right in steps of about 7 px: as long as it is seen the bearing is right, then it is not
    # seen.
    eye, seen = observer(), []
    for bearing in np.arange(-0.36, -0.56, -0.01):
        sight = eye.observe(Frame(picture([(TAG, leader_at(1.0, bearing, 0.0))], REAL), utime=1))
        seen.append(sight.observation is not None)
        if seen[-1]:
            assert sight.observation.bearing_rad == pytest.approx(bearing, abs=0.005)
            assert sight.observation.distance_m == pytest.approx(1.0, abs=0.01)
    assert seen[0]
    assert not seen[-1]
    assert sorted(seen, reverse=True) == seen


def test_an_observation_is_the_same_bits_every_time_and_carries_the_frames_time():
    frame = Frame(picture([(TAG, leader_at(1.1, 0.1, 0.2))]), utime=123456789)
    first, second = observer().observe(frame).observation, observer().observe(frame).observation
    assert first.utime == 123456789
    assert (first.distance_m, first.bearing_rad, first.heading_rad) == (
        second.distance_m,
        second.bearing_rad,
        second.heading_rad,
    )
    assert np.array_equal(first.cMo, second.cMo)
    assert np.array_equal(first.covariance, second.covariance)


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"body": LeaderBody([TAG, BodyTag(id=587, position_m=[0, 0.3, 0])])}, r"leader\.tags\[1\]\.id"),
        ({"body": LeaderBody([TAG], family="tag1h1")}, r"leader\.family"),
    ],
)
def test_a_body_that_can_never_be_seen_is_refused_at_load(options, key):
    with pytest.raises(ValueError, match=f"^{key}: "):
        observer(**options)


def test_a_rolled_camera_sees_the_same_leader():
    # The horizon is where the mounting says: a camera turned clockwise by r turns the picture
    # counter-clockwise.
    roll = 0.4
    cMo = pose(rotation("z", -roll)) @ leader_at(1.2, 0.15, 0.3)
    found = observe(picture([(TAG, cMo)]), mounting=CameraMounting(roll_rad=roll)).observation
    assert found.bearing_rad == pytest.approx(0.15, abs=0.002)
    assert found.heading_rad == pytest.approx(0.3, abs=0.02)

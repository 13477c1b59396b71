"""Every refusal has a picture that brings it about, a name and a counter; and nothing else is counted with it.

The picture is of a tag that would be accepted but for one thing. `check_pose` is asked where no picture can do it.
"""

import numpy as np
import pytest
from rendered_leaders import BODY, CAMERA, TAG, frame, leader_at, look, observer, render, true_corners

from pilotfish.core import BodyTag, CameraMounting, LeaderBody, Reason, TagDetection
from pilotfish.vision import (
    LeaderObserver,
    LeaderPoseConfig,
    TagDetectorConfig,
    TagFamily,
    TagGates,
    TagRefusal,
    check_pose,
    estimate_leader_pose,
)

COUNTERS = [
    "frames_invalid",
    "hamming",
    "margin",
    "residual",
    "foreign_id",
    "duplicate_id",
    "outside_frame",
    "too_small",
    "too_blurred",
    "size",
    "behind",
    "jump",
    "upside_down",
    "pose",
]
HERE = (1.1, 0.0, 0.2)


def counted(eye):
    """{counter: count} of those that are not zero."""
    return {name: getattr(eye.rejected, name) for name in COUNTERS if getattr(eye.rejected, name)}


def refused(image, *, body=BODY, **config):
    """(reason, counters) of one picture before a new observer."""
    eye = observer(body, **config)
    sight = eye.observe(frame(image, 0))
    assert sight.observation is None
    return sight.reason, counted(eye)


def picture(pose=HERE, body=BODY, seed=1, **imperfections):
    return render([(body, leader_at(*pose))], seed, **imperfections)


def cell_px(cMo, row, column):
    """(4, 2): the corners of a cell of TAG's bitmap, row 0 and column 0 in the white ring."""
    corners = true_corners(cMo)
    across, down = corners[2] - corners[3], corners[0] - corners[3]  # frontal: a parallelogram
    return np.array(
        [corners[3] + (c - 1) / 8 * across + (r - 1) / 8 * down for r, c in ((row, column), (row + 1, column + 1))]
    )


def with_cell_flipped(cMo, cells, seed=1):
    """The picture of a tag that is seen head-on, with these cells in the other colour."""
    image = render([(BODY, cMo)], seed, noise_sigma=0.0).astype(float)
    bitmap = TagFamily("tag36h11").bitmap(id=TAG.id)
    for row, column in cells:
        first, last = np.rint(cell_px(cMo, row, column)).astype(int)
        image[first[1] : last[1], first[0] : last[0]] = 30 if bitmap[row, column] else 220
    image += np.random.default_rng(seed).normal(0, 3, image.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def test_the_picture_that_all_others_are_made_of_is_accepted():
    eye = observer()
    assert eye.observe(frame(picture(), 0)).reason == Reason.none
    assert counted(eye) == {}


def test_an_id_that_the_leader_does_not_wear():
    other = LeaderBody([BodyTag(id=9, size_m=0.16)])
    assert refused(picture(body=other)) == (Reason.no_tag_of_the_leader, {"foreign_id": 1})


@pytest.mark.fault("duplicate_tag")
def test_an_id_that_is_seen_twice():
    image = render([(BODY, leader_at(1.5, bearing)) for bearing in (-0.2, 0.2)], 1)
    assert refused(image) == (Reason.tag_duplicate, {"duplicate_id": 2})


@pytest.mark.fault("lookalike_while_tracking")
def test_a_look_alike_that_comes_in_does_not_take_the_place_of_the_leader_that_is_tracked():
    """The leader stands 1.2 m ahead at +0.2 rad; the other body, as far away, comes from the other side up to 0.12 rad
    from it, 0.14 m. The tracker follows the tag from picture to picture and does not search."""
    eye = observer()
    for k in range(30):
        bodies = [(BODY, leader_at(1.2, 0.2))] + ([(BODY, leader_at(1.2, -0.4 + 0.0171 * (k - 1)))] if k else [])
        sight = eye.observe(frame(render(bodies, k), k))
        assert sight.reason == Reason.none
        assert sight.observation.measured.bearing_rad == pytest.approx(0.2, abs=0.005)
    assert counted(eye) == {}


@pytest.mark.parametrize("config", [LeaderPoseConfig(max_distance_m=1.0), LeaderPoseConfig(min_distance_m=1.2)])
def test_a_size_that_it_cannot_have_at_its_range(config):
    # At 1.1 m; 0.16 m look as large as they do at 1.1 m, which the config rules out.
    assert refused(picture(), pose=config) == (Reason.tag_size_implausible, {"size": 1})


def test_a_leader_that_jumped():
    # 1.4 m farther within 33 ms; 0.1 m + 4 m/s allow 0.23 m.
    eye = observer()
    eye.observe(frame(picture(), 0))
    assert eye.observe(frame(picture((2.5, 0.0, 0.2)), 1)).reason == Reason.leader_jumped
    assert counted(eye) == {"jump": 1}


def test_a_tag_that_leaves_the_picture():
    # Followed out to the right, 7 px a frame. It is used as long as three fifths of its bits are in the picture, then
    # refused by name - while it is still predicted, that is; the detector alone does not see it at all.
    eye, reasons = observer(), []
    for k in range(40):
        reasons.append(eye.observe(frame(picture((1.0, -0.36 - 0.01 * k, 0.0), seed=k), k)).reason)
    first = next(k for k, reason in enumerate(reasons) if reason != Reason.none)
    assert first > 3
    assert reasons[first] == Reason.tag_outside_frame
    # The bits are six columns of 12 px around the tag's middle, which is tan(0.36 + 0.01 k) 600 px from the picture's.
    # With three of them outside too few are left: the first of those is read 6 px beyond the middle, and the picture
    # ends at 319.5 px. A frame is a step of 7 px.
    middle_px = 600 * np.tan(0.36 + 0.01 * first)
    assert 319.5 - 6 - 2 < middle_px < 319.5 - 6 + 9
    assert Reason.none not in reasons[first:]
    assert eye.rejected.outside_frame >= 1
    assert set(counted(eye)) == {"outside_frame"}


def test_a_tag_that_is_too_blurred():
    # Cells of 9 px and a gate of a tenth of a cell, 1.1 px, before a blur of 1.5 px.
    image = picture(blur_sigma_px=1.5)
    assert refused(image, gates=TagGates(max_blur_cells=0.1)) == (Reason.tag_too_blurred, {"too_blurred": 1})


def test_a_tag_that_is_too_small():
    # Cells of 11 px (0.02 m times 600 px over 1.1 m) less what 11 degrees take off.
    gates = TagGates(min_cell_px=12.0)
    assert refused(picture(), gates=gates) == (Reason.tag_too_small, {"too_small": 1})
    assert observer(gates=TagGates(min_cell_px=10.0)).observe(frame(picture(), 0)).reason == Reason.none


@pytest.mark.parametrize(("cells", "allowed"), [([(4, 4)], 1), ([(2, 3), (5, 6)], 2)], ids=["one bit", "two bits"])
def test_a_tag_with_wrong_bits(cells, allowed):
    image = with_cell_flipped(leader_at(1.1), cells)
    assert refused(image) == (Reason.tag_refused, {"hamming": 1})
    # The same picture with so many corrected bits allowed: nothing else is wrong with it.
    eye = observer(detector=TagDetectorConfig(max_hamming=allowed), gates=TagGates(max_normalised_residual=1.0))
    assert eye.observe(frame(image, 0)).reason == Reason.none
    # Followed, it is refused for the same reason as found.
    eye = observer()
    eye.observe(frame(render([(BODY, leader_at(1.1))], 2), 0))
    assert eye.observe(frame(image, 1)).reason == Reason.tag_refused
    assert counted(eye) == {"hamming": 1}


@pytest.mark.parametrize("followed", [False, True], ids=["found", "followed"])
def test_a_tag_with_too_little_contrast(followed):
    # 190 gray levels of contrast, of which a fog leaves 60 %: 114 levels, below a margin of 150.
    clear = picture(noise_sigma=0.0).astype(float)
    fog = np.rint(120 + 0.6 * (clear - 120)).astype(np.uint8)
    config = {"detector": TagDetectorConfig(min_decision_margin=150.0)}
    eye = observer(**config)
    if followed:
        assert eye.observe(frame(picture(), 0)).reason == Reason.none
    sight = eye.observe(frame(fog, 1))
    assert (sight.observation, sight.reason) == (None, Reason.tag_refused)
    assert counted(eye) == {"margin": 1}
    assert observer(detector=TagDetectorConfig(min_decision_margin=80.0)).observe(frame(fog, 0)).reason == Reason.none


def test_a_tag_of_which_something_else_explains_too_much():
    # Coarse stripes of 20 % of the contrast on the template, as a shadow of leaves: all bits can be read, and the
    # RMS of what the template does not explain is some 0.14 of the contrast where 0.12 are allowed.
    clean = picture(noise_sigma=0.0).astype(float)
    columns, rows = np.meshgrid(np.arange(clean.shape[1]), np.arange(clean.shape[0]))
    stripes = 0.2 * 190 * np.sign(np.sin(0.55 * columns + 0.4 * rows))
    image = np.clip(np.rint(0.7 * (clean - 120) + 120 + 0.7 * stripes), 0, 255).astype(np.uint8)
    assert refused(image) == (Reason.tag_refused, {"residual": 1})
    assert observer(gates=TagGates(max_normalised_residual=0.3)).observe(frame(image, 0)).reason == Reason.none


def test_tags_that_do_not_hang_as_the_body_says():
    # 0.1 m off at 1.5 m are 40 px, of which the best pose leaves half in each of two tags: over 3 px.
    claimed = LeaderBody([TAG, BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.0, 0.3])])
    real = LeaderBody([TAG, BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.0, 0.4])])
    image = picture((1.5, 0.0, 0.0), body=real)
    assert refused(image, body=claimed) == (Reason.pose_refused, {"pose": 1})


def test_a_tag_behind_the_camera_or_seen_through_its_back():
    # No picture shows such corners with the right bits, but a pose can be asked about: a second tag that the body wears
    # on its front (facing 0) would look away from a camera behind the leader, and one that hangs 2 m nearer than the
    # leader's origin would be behind a camera 1.5 m away.
    def sighting(tag_id, corners):
        return TagDetection(id=tag_id, corners_px=corners)

    cMo = leader_at(1.5)
    seen = sighting(TAG.id, true_corners(cMo))
    for other in (
        BodyTag(id=4, size_m=0.16, facing_rad=0.0),
        BodyTag(id=4, size_m=0.16, position_m=[-2.0, 0.0, 0.0]),
    ):
        body = LeaderBody([TAG, other])
        pose = estimate_leader_pose(camera=CAMERA, body=body, tags=[seen])
        assert check_pose(pose=pose, body=body, tags=[seen]) == Reason.none
        both = [seen, sighting(4, true_corners(cMo))]
        assert check_pose(pose=pose, body=body, tags=both) == Reason.leader_behind_camera


def test_a_leader_whose_body_file_is_mirrored_shows_its_back():
    # The body says that tag 4 looks ahead; in truth it looks back, beside tag 3. That is a whole picture for it: the
    # best pose for both shows the back of one of them, or explains neither.
    claimed = LeaderBody([TAG, BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.25, 0.0], facing_rad=0.0)])
    real = LeaderBody([TAG, BodyTag(id=4, size_m=0.16, position_m=[0.0, 0.25, 0.0])])
    reason, counts = refused(picture((1.2, 0.0, 0.1), body=real), body=claimed)
    assert (reason, counts) == (Reason.leader_behind_camera, {"behind": 1})


def test_what_is_refused_when_followed_but_accepted_when_found_is_not_counted():
    # A jump of 100 px: nothing lies where the leader should be, and the search finds it elsewhere in the same frame.
    eye = observer()
    eye.observe(frame(picture(), 0))
    eye.observe(frame(picture((1.1, 0.18, 0.2)), 1))
    assert counted(eye) == {}


def test_a_tag_half_hidden_is_refused_and_not_moved():
    # A plain patch over half of the template: bits are wrong, or nothing like it is there; never a measurement.
    cMo = leader_at(*HERE)
    corners = true_corners(cMo)
    for share in (0.3, 0.5, 0.8):
        image = picture()
        last = corners[:, 0].min() - 12 + share * (np.ptp(corners[:, 0]) + 24)
        image[:, : int(last)] = 128
        answer = look(image, corners)
        assert answer in (TagRefusal.not_found, TagRefusal.hamming, TagRefusal.residual, TagRefusal.margin)


def test_a_leader_that_stands_on_its_head_is_not_followed():
    # The picture of a camera that hangs upside down: left and right are exchanged, and a robot would turn away from its
    # leader. With the roll in its mounting the leader stands again, at the mirrored bearing.
    image = np.ascontiguousarray(render([(BODY, leader_at(1.1, 0.1))], 1)[::-1, ::-1])
    eye = observer()
    sight = eye.observe(frame(image, 0))
    assert sight.observation is None
    assert sight.reason == Reason.leader_upside_down
    assert counted(eye) == {"upside_down": 1}
    hanging = LeaderObserver(camera=CAMERA, body=BODY, mounting=CameraMounting(roll_rad=np.pi))
    seen = hanging.observe(frame(image, 0)).observation
    assert seen.distance_m == pytest.approx(1.1, abs=0.01)
    assert seen.bearing_rad == pytest.approx(0.1, abs=0.01)


def test_the_counters_of_a_drive_are_the_sum_of_its_refusals():
    eye, expected = observer(), 0
    rng = np.random.default_rng(4)
    for k in range(20):
        hidden = bool(rng.integers(2))
        image = with_cell_flipped(leader_at(1.1), [(4, 4)], seed=k) if hidden else render([(BODY, leader_at(1.1))], k)
        sight = eye.observe(frame(image, k))
        assert (sight.reason == Reason.tag_refused) == hidden
        expected += hidden
    assert counted(eye) == {"hamming": expected}

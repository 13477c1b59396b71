"""What cannot be learned is refused, with what to do instead."""

import dataclasses
import re

import numpy as np
import pytest
from turning_bodies import CAMERA, FIVE, film, filmed, one_turn, sightings_of, sizes_of, tag

from pilotfish import core
from pilotfish.calibration.body import KnownTag, TagSizes, TurningCentre, collect_sightings, learn_body
from pilotfish.errors import BodyLearningError


def with_sizes(sightings, **factors):
    sizes_m = sightings.sizes_m.copy()
    for name, factor in factors.items():
        sizes_m[sightings.ids == int(name.removeprefix("tag"))] *= factor
    return dataclasses.replace(sightings, sizes_m=sizes_m)


def test_tags_never_seen_together_are_named_by_group():
    # One tag at the front, two at the rear.
    body = core.LeaderBody([tag(3, 0.16, [0.2, 0, 0.25], 0), *FIVE.tags[:2]])
    seen = sightings_of(body, one_turn(60), sigma_px=0.1, seed=1)
    with pytest.raises(BodyLearningError, match=r"never seen together.*: \{0, 1\}; \{3\}.*one picture"):
        learn_body(dataclasses.replace(seen, **_sorted(seen)), CAMERA)


def test_two_tags_back_to_back_are_never_seen_together():
    body = core.LeaderBody([FIVE.tags[0], tag(3, 0.16, [0.2, 0, 0.25], 0)])
    seen = sightings_of(body, one_turn(60), sigma_px=0.1, seed=1)
    with pytest.raises(BodyLearningError, match=r"never seen together.*: \{0\}; \{3\}"):
        learn_body(seen, CAMERA)


def _sorted(seen):
    order = np.argsort(seen.ids)
    return {"tag": np.argsort(order)[seen.tag], "ids": seen.ids[order], "sizes_m": seen.sizes_m[order]}


@pytest.mark.parametrize(
    ("wrong", "factor", "within"),
    [("tag5", 1.6, 0.05), ("tag0", 0.625, 0.05), ("tag5", 1.1, 0.01), ("tag0", 0.9, 0.01)],
)
def test_a_wrong_size_is_named_with_the_right_one(wrong, factor, within):
    # Four of five fit together, so it is the fifth. Far off, it is found on a grid of 4 %, else by least squares.
    seen = sightings_of(FIVE, one_turn(44, from_deg=-110, to_deg=110), sigma_px=0.1, seed=2)
    with pytest.raises(BodyLearningError) as refusal:
        learn_body(with_sizes(seen, **{wrong: factor}), CAMERA)
    ((tag_id, measured),) = re.findall(r"tag (\d): \S+ m configured, (\S+) m measured", str(refusal.value))
    true = next(each.size_m for each in FIVE.tags if each.id == int(wrong[-1]))
    assert (tag_id, float(measured)) == (wrong[-1], pytest.approx(true, rel=within))


def test_a_size_that_is_off_by_a_percent_is_warned_of():
    seen = sightings_of(FIVE, one_turn(44, from_deg=-110, to_deg=110), sigma_px=0.1, seed=3)
    learned = learn_body(with_sizes(seen, tag7=1.012), CAMERA)
    (warning,) = [text for text in learned.warnings if "m measured" in text]
    assert warning.startswith("tag 7: 0.1214 m configured")


def test_all_sizes_wrong_by_the_same_factor_give_the_body_larger_by_it():
    # That is the scale that no picture can tell.
    seen = sightings_of(FIVE, one_turn(44, from_deg=-110, to_deg=110), sigma_px=0.1, seed=3)
    base = TurningCentre(height_of=(0, 0.25))
    said, larger = (
        learn_body(seen, CAMERA, base=base),
        learn_body(dataclasses.replace(seen, sizes_m=seen.sizes_m * 1.1), CAMERA, base=base),
    )
    for a, b in zip(said.body.tags, larger.body.tags, strict=True):
        np.testing.assert_allclose(b.position_m[:2], np.array(a.position_m[:2]) * 1.1, atol=1e-4)


def test_a_tag_on_the_wall_is_not_part_of_the_body():
    body = core.LeaderBody([*FIVE.tags[:2], FIVE.tags[4]])
    seen = sightings_of(body, one_turn(40, from_deg=-40, to_deg=60), sigma_px=0.1, seed=4)
    frames = np.unique(seen.frame)
    on_wall = np.array([[500.0, 100.0], [560.0, 101.0], [559.0, 40.0], [501.0, 41.0]])
    both = dataclasses.replace(
        seen,
        frame=np.concatenate([seen.frame, frames]),
        tag=np.concatenate([seen.tag, np.full(len(frames), 3)]),
        corners_px=np.concatenate([seen.corners_px, np.tile(on_wall, (len(frames), 1, 1))]),
        ids=np.append(seen.ids, 9),
        sizes_m=np.append(seen.sizes_m, 0.16),
    )
    with pytest.raises(BodyLearningError, match=r"\{0, 1, 7\}; \{9\}.*--ignore ID"):
        learn_body(both, CAMERA)


def test_too_few_frames_are_refused_with_their_number():
    seen = sightings_of(FIVE, one_turn(6, from_deg=-20, to_deg=20), sigma_px=0.1, seed=5)
    with pytest.raises(BodyLearningError, match="only 6 frames show two tags"):
        learn_body(seen, CAMERA)


def test_a_lonely_tag_with_a_known_place_leaves_nothing_to_learn():
    body = core.LeaderBody(FIVE.tags[:1])
    seen = sightings_of(body, one_turn(20, from_deg=-40, to_deg=40), sigma_px=0.1, seed=5)
    with pytest.raises(BodyLearningError, match="nothing to learn"):
        learn_body(seen, CAMERA, base=KnownTag(FIVE.tags[0]))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"reference_id": 6}, r"reference tag 6 was not seen; seen were \[0, 1, 2, 5, 7\]"),
        ({"base": TurningCentre(height_of=(6, 0.3))}, r"--height-of 6: that tag was not seen"),
    ],
)
def test_a_tag_that_was_not_seen_cannot_fix_the_base(options, said):
    with pytest.raises(BodyLearningError, match=said):
        learn_body(filmed().sightings, CAMERA, **options)


def test_a_tag_on_the_lid_does_not_tell_where_forward_is():
    lid = tag(8, 0.16, [-0.05, 0.0, 0.3], 180, tilt_deg=85)
    body = core.LeaderBody([*FIVE.tags[:3], lid])
    seen = sightings_of(body, one_turn(60), sigma_px=0.1, seed=7, steepest_deg=88)
    with pytest.raises(BodyLearningError, match="looks up or down"):
        learn_body(seen, CAMERA, reference_id=8)


def test_plain_pictures_show_no_tag():
    gray = [core.Frame(np.full((480, 640), 128, np.uint8), utime=k) for k in range(3)]
    with pytest.raises(BodyLearningError, match="no tag36h11 tag in any of 3 frames"):
        collect_sightings(gray, CAMERA, TagSizes(0.16))


def test_frames_of_another_size_than_the_calibration_s_are_refused():
    with pytest.raises(BodyLearningError, match="320x240 px, the camera was calibrated with 640x480"):
        collect_sightings([core.Frame(np.zeros((240, 320), np.uint8), utime=0)], CAMERA, TagSizes(0.16))


def test_an_id_without_a_size_is_named_unless_it_is_ignored():
    # Frames 16 to 27 look at the rear, where tags 0 and 7 are.
    frames = film()[16:28]
    with pytest.raises(BodyLearningError, match=r"--tag-size 7=METRES"):
        collect_sightings(frames, CAMERA, TagSizes(by_id=dict.fromkeys((0, 1, 2, 5), 0.1)))
    sizes = TagSizes(by_id=dict.fromkeys((0, 1, 2, 5), 0.1))
    seen = collect_sightings(frames, CAMERA, sizes, ignored_ids=frozenset({7})).sightings
    assert 0 in seen.ids and 7 not in seen.ids


def test_what_was_read_is_counted():
    damaged = core.Frame.unchecked(b"", width=640, height=480, stride_bytes=640, utime=0)
    frames = [*film()[18:26], damaged, damaged]
    collected = collect_sightings(frames, CAMERA, sizes_of(FIVE), every=2)
    assert (collected.frames_read, collected.frames_undecodable) == (5, 1)
    assert collected.sightings.frame_count == 4

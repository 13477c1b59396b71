"""What is learned is what was there, to within what is said about it."""

import functools

import numpy as np
import pytest
from turning_bodies import (
    CAMERA,
    FIVE,
    TWELVE,
    errors_of,
    filmed,
    one_turn,
    sightings_of,
    tag,
)

from pilotfish import core
from pilotfish.calibration.body import KnownTag, TurningCentre, learn_body


def mean_normalised_square(learned, truth):
    """Over the tags but the reference, of e^T C^-1 e, which is chi-squared with 6 degrees of freedom."""
    return np.mean(
        [
            error @ np.linalg.solve(known.covariance, error)
            for error, known in zip(errors_of(learned, truth), learned.tags, strict=True)
            if known.id != learned.reference_id
        ]
    )


def test_errors_are_as_large_as_the_covariance_says():
    # White noise, as the theory assumes. Six films of four tags each: the mean of the chi-squared values is 6. Those
    # of one film share the reference's error, so count six only: standard deviation sqrt(12 / 6) = 1.4 at most.
    squares = []
    for seed in range(6):
        seen = sightings_of(FIVE, one_turn(44, from_deg=-110, to_deg=110), sigma_px=0.1, seed=seed)
        learned = learn_body(seen, CAMERA, base=KnownTag(FIVE.tags[0]))
        assert learned.rms_px == pytest.approx(0.1, rel=0.25)  # less the share that the unknowns took
        squares.append(mean_normalised_square(learned, FIVE))
    assert abs(np.mean(squares) - 6.0) < 3 * 1.4


def test_the_turning_centre_is_found_to_within_what_is_said():
    # The turn's noise counts twice (see uncertainty.py), so errors may be smaller than said, but not larger: the mean
    # of the squares stays below 6 + 3 sqrt(12 / 4) = 11.2 (see above).
    squares = []
    for seed in range(4):
        seen = sightings_of(FIVE, one_turn(44, from_deg=-110, to_deg=110), sigma_px=0.1, seed=20 + seed)
        learned = learn_body(seen, CAMERA, base=TurningCentre(np.pi, height_of=(0, 0.25)))
        errors = errors_of(learned, FIVE)
        assert np.abs(errors[:, :3]).max() < 2e-3
        squares.append(
            np.mean(
                [
                    e[:3] @ np.linalg.pinv(k.covariance[:3, :3]) @ e[:3]
                    for e, k in zip(errors, learned.tags, strict=True)
                ]
            )
        )
    assert np.mean(squares) < 11.2


def test_tags_that_were_seen_rarely_are_warned_of_and_nothing_else_is():
    seen = sightings_of(FIVE, one_turn(44, from_deg=-110, to_deg=110), sigma_px=0.1, seed=20)
    learned = learn_body(seen, CAMERA, base=TurningCentre(np.pi, height_of=(0, 0.25)))
    rare = [f"tag {known.id} was used in {known.used} frames only" for known in learned.tags if known.used < 15]
    assert rare and [warning.partition(":")[0] for warning in learned.warnings] == rare


def test_a_rendered_film_gives_the_body_back():
    # Real corners are not white noise: the fit errs a little in the same way in every frame, so errors may be some
    # times what the spread says; twice that for three standard deviations.
    learned = learn_body(filmed().sightings, CAMERA, base=TurningCentre(np.pi, height_of=(0, 0.25)))
    errors = errors_of(learned, FIVE)
    for error, known in zip(errors, learned.tags, strict=True):
        assert np.linalg.norm(error[:3]) < 2 * 3 * known.position_sigma_m
        assert np.linalg.norm(error[3:]) < 2 * 3 * known.rotation_sigma_rad
    # The prints are fitted to some 0.015 px, at 1.3 m and f = 600 px 0.03 mm across the line of sight; times five.
    assert learned.rms_px < 0.03
    assert np.linalg.norm(errors[:, :3], axis=1).max() < 0.15e-3
    assert np.degrees(np.linalg.norm(errors[:, 3:], axis=1).max()) < 0.3
    # It turned about its origin, exactly.
    assert learned.turning.wander_m < 2e-3
    assert learned.rms_px < 0.2


def test_with_a_tag_whose_place_is_known_the_body_hangs_on_it():
    learned = learn_body(filmed().sightings, CAMERA, base=KnownTag(FIVE.tags[2]))
    assert learned.reference_id == 2
    assert learned.turning is None
    errors = errors_of(learned, FIVE)
    np.testing.assert_allclose(errors[2], 0.0, atol=1e-9)
    assert np.linalg.norm(errors[:, :3], axis=1).max() < 1.5e-3


def test_twelve_tags_all_round_are_learned():
    # 36 frames of about 7 tags each.
    seen = sightings_of(TWELVE, one_turn(36), sigma_px=0.1, seed=4)
    learned = learn_body(seen, CAMERA, base=TurningCentre(np.pi, height_of=(10, 0.15)))
    assert len(learned.body.tags) == 12
    errors = errors_of(learned, TWELVE)
    assert np.linalg.norm(errors[:, :3], axis=1).max() < 2e-3
    # A gap of 10 degrees is left; the frames' noise of some 0.1 degrees makes it a little wider.
    assert np.degrees(learned.turned_rad) == pytest.approx(350.0, abs=1.0)


@pytest.mark.parametrize("seed", [1, 2])
def test_frontal_views_from_afar_do_not_turn_tags_round(seed):
    # At 2.5 m with 0.3 px of noise a tag of 24 to 38 px that is within 25 degrees of frontal flips in many frames. Two
    # of the three are in one plane, so that a flipped frame fits them, too.
    body = core.LeaderBody(
        [
            tag(0, 0.16, [-0.2, 0.13, 0.25], 180),
            tag(1, 0.10, [-0.2, -0.13, 0.25], 180),
            tag(2, 0.12, [-0.2, 0.0, 0.45], 180, tilt_deg=15),
        ]
    )
    poses = one_turn(60, distance_m=2.5, from_deg=-35, to_deg=35)
    seen = sightings_of(body, poses, sigma_px=0.3, seed=seed)
    learned = learn_body(seen, CAMERA, base=KnownTag(body.tags[0]))
    errors = errors_of(learned, body)
    for error, known in zip(errors[1:], learned.tags[1:], strict=True):
        # A flip would be some 20 degrees or more; three standard deviations of noise are two degrees.
        assert np.linalg.norm(error[3:]) < 3.5 * known.rotation_sigma_rad < np.radians(4)
        assert np.linalg.norm(error[:3]) < 3.5 * known.position_sigma_m < 0.03
    assert sum(known.dropped for known in learned.tags) < 0.05 * len(seen)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_single_tag_s_place_beside_the_turning_centre_is_learned(seed):
    body = core.LeaderBody([tag(4, 0.16, [-0.2, 0.03, 0.25], 170)])
    seen = sightings_of(body, one_turn(60, from_deg=-60, to_deg=60), sigma_px=0.1, seed=seed)
    learned = learn_body(seen, CAMERA, base=TurningCentre(np.radians(170), height_of=(4, 0.25)))
    (error,) = errors_of(learned, body)
    assert np.linalg.norm(error[:3]) < 3 * learned.tags[0].position_sigma_m < 5e-3
    assert np.linalg.norm(error[3:]) < np.radians(1)


def test_corners_in_the_wrong_place_are_left_out():
    # Every tenth sighting is shifted by 3 px at one corner, as by something in front of it.
    seen = sightings_of(FIVE, one_turn(44, from_deg=-110, to_deg=110), sigma_px=0.1, seed=6)
    shifted = np.arange(len(seen)) % 10 == 3
    seen.corners_px[shifted, 1] += 3.0
    learned = learn_body(seen, CAMERA, base=KnownTag(FIVE.tags[0]))
    # Those alone in their frame are not used anyway.
    assert sum(known.dropped for known in learned.tags) >= (shifted & seen.seen_together()).sum()
    assert np.linalg.norm(errors_of(learned, FIVE)[:, :3], axis=1).max() < 2e-3
    assert learned.rms_px < 0.12


@functools.lru_cache(maxsize=1)
def learned_without_a_height():
    return learn_body(filmed().sightings, CAMERA)


def test_without_a_height_heights_count_from_the_reference_tag_and_that_is_said():
    learned = learned_without_a_height()
    assert learned.body.tags[0].position_m[2] == pytest.approx(0.0, abs=1e-12)
    assert any("--height-of" in warning for warning in learned.warnings)


def test_the_same_film_gives_the_same_bits():
    first, second = learned_without_a_height(), learn_body(filmed().sightings, CAMERA)
    for a, b in zip(first.tags, second.tags, strict=True):
        assert np.array_equal(a.covariance, b.covariance)
    assert repr(first.body.tags) == repr(second.body.tags)

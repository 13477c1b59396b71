"""The overlay on a picture, before any encoder has touched it."""

from __future__ import annotations

import numpy as np
import pytest

from pilotfish.logs.export.overlay import BAR_PX, Seen, with_overlay

GRAY = np.full((100, 120, 3), 128, np.uint8)
CORNERS = np.array([[30.3, 80.6], [80.3, 80.6], [80.3, 30.6], [30.3, 30.6]])


def covered(picture):
    """How much of each pixel is outline, 0 to 1: vermillion has no blue, the ground 128."""
    return 1.0 - picture[:100, :, 2] / 128.0


def test_the_outline_is_centred_on_the_edge_to_a_tenth_of_a_pixel():
    outline = covered(with_overlay(GRAY, Seen(0.0, tags=((7, CORNERS),))).astype(float))
    # Across the middle of the left and the right edge, and of the lower one (the id stands on the upper one).
    for profile, near, edge in (
        (outline[55], slice(20, 40), 30.3),
        (outline[55], slice(70, 90), 80.3),
        (outline[:, 55], slice(70, 90), 80.6),
    ):
        places = np.arange(len(profile))[near]
        weights = profile[near]
        assert weights.sum() == pytest.approx(2.0, abs=0.3)  # two pixels wide
        assert (places * weights).sum() / weights.sum() == pytest.approx(edge, abs=0.1)  # drawn in eighths of a pixel


def test_away_from_outline_and_label_the_picture_is_untouched():
    picture = with_overlay(GRAY, Seen(0.0, tags=((7, CORNERS),)))
    assert (picture[36:76, 36:75] == 128).all()
    assert (picture[90:100] == 128).all()
    assert (picture[:10] == 128).all()


def test_pixels_stay_where_they_are_and_the_bar_is_below():
    noise = np.random.default_rng(2).integers(0, 255, (47, 63, 3)).astype(np.uint8)
    picture = with_overlay(noise, Seen(1.0, "tracking", "none", 1.0, 0.1))
    assert picture.shape == (48 + BAR_PX, 64, 3)
    assert np.array_equal(picture[:47, :63], noise)


def test_the_bar_says_other_things_for_other_frames():
    bars = [
        with_overlay(np.zeros((100, 640, 3), np.uint8), seen)[100:].tobytes()
        for seen in (
            Seen(1.0),
            Seen(1.0, "lost", "no_tag_found"),
            Seen(1.0, "tracking", "none", 1.0, 0.1),
            Seen(1.0, "tracking", "none", 1.0, 0.2),
            Seen(2.0, "tracking", "none", 1.0, 0.2),
        )
    ]
    assert len(set(bars)) == len(bars)


@pytest.mark.parametrize("corners", [CORNERS - 1000, CORNERS * np.nan, CORNERS * 1e9, CORNERS - 50])
def test_a_tag_that_lies_outside_does_no_harm(corners):
    assert with_overlay(GRAY, Seen(0.0, tags=((7, corners),))).shape == (128, 120, 3)

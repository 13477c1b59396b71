"""Blur, noise, exposure, clutter: each alone, against what it should be; and all of them repeatable."""

import numpy as np
import pytest
from scipy import ndimage, stats
from tag_scenes import SHARP, body_pose, render_tag, tag_body, tag_pose

from pilotfish import core, sim

CAMERA = core.CameraModel(width=640, height=480, fx=600, fy=600, cx=319.5, cy=239.5)
SCENE = [(tag_body(), body_pose(tag_pose(1.0, 25, 5)))]


def imperfections(**changes):
    return sim.Imperfections(**{"blur_sigma_px": 0.0, "noise_sigma": 0.0, "clutter": 0.0, **changes})


def render(scene=SCENE, clutter_seed=1, heading_rad=0.0, seed=1, **changes):
    renderer = sim.Renderer(CAMERA, imperfections(**changes), clutter_seed=clutter_seed)
    return renderer.render(scene, seed=seed, camera_heading_rad=heading_rad)


def test_the_same_seeds_give_the_same_bytes():
    given = {"noise_sigma": 3.0, "clutter": 1.0, "blur_sigma_px": 0.7}
    assert np.array_equal(render(**given), render(**given))


def test_another_seed_gives_other_noise_and_another_room():
    # Two independent noises of sigma 3, rounded: few pixels agree.
    noises = [render(noise_sigma=3.0, seed=seed) for seed in (1, 2)]
    assert (noises[0] == noises[1]).mean() < 0.15
    rooms = [render([], clutter=1.0, clutter_seed=seed) for seed in (1, 2)]
    assert (rooms[0] == rooms[1]).mean() < 0.5


def test_the_noise_is_white_and_normal_with_the_sigma_asked_for():
    # A plain wall of 128 exactly. Rounding to whole grays adds 1/12 to the variance: sqrt(9 + 1/12) = 3.0139.
    # With N = 307200 the standard errors are 0.0054 of the mean, 0.0038 of sigma and 0.0018 of a correlation.
    noise = render([], noise_sigma=3.0).astype(float) - 128.0
    assert abs(noise.mean()) < 0.025
    assert noise.std() == pytest.approx(3.0139, abs=0.02)
    assert abs((noise[:, :-1] * noise[:, 1:]).mean() / noise.var()) < 0.009
    assert abs((noise[:-1] * noise[1:]).mean() / noise.var()) < 0.009
    # P(|rounded noise| >= 6) = P(|z| > 5.5 / 3) = 6.68 %, and P(>= 9) = P(|z| > 8.5 / 3) = 0.461 %. Allowed are
    # four standard errors and one step of a table of 4096 quantiles.
    for at_least in (6, 9):
        p = 2 * stats.norm.sf((at_least - 0.5) / 3.0)
        tolerance = 4 * np.sqrt(p * (1 - p) / noise.size) + 1 / 4096
        assert (np.abs(noise) >= at_least).mean() == pytest.approx(p, abs=tolerance)


def test_the_noise_of_two_frames_is_independent():
    a, b = (render([], noise_sigma=3.0, seed=seed).astype(float) - 128.0 for seed in (10, 11))
    assert abs((a * b).mean() / 9.0) < 0.009


def test_the_blur_is_a_gaussian_of_the_sigma_asked_for():
    sharp, blurred = render(), render(blur_sigma_px=0.7)
    expected = ndimage.gaussian_filter(sharp.astype(float), 0.7, mode="nearest")
    # The sharp picture was rounded to whole grays before it came here, the blurred one after: one gray at most.
    assert np.abs(blurred - expected).max() < 1.1


def test_the_exposure_gain_multiplies_the_grays_and_clips_them():
    once, half, thrice = render(), render(exposure_gain=0.5), render(exposure_gain=3.0)
    assert np.abs(half - once / 2.0).max() <= 0.75
    assert np.abs(thrice - np.minimum(255.0, once * 3.0)).max() <= 2.0
    assert thrice.max() == 255


def test_without_clutter_the_background_is_plain_and_with_it_full_of_edges():
    assert np.unique(render([])).size == 1
    cluttered = render([], clutter=1.0).astype(float)
    strong_edges = np.abs(np.diff(cluttered, axis=1)) > 20
    assert strong_edges.sum() > 1000
    mild = render([], clutter=0.25).astype(float)
    assert mild.std() == pytest.approx(0.25 * cluttered.std(), rel=0.05)


def test_the_background_turns_with_the_camera():
    # Turning left by 0.05 rad moves what is far away to the right: by 600 * tan(0.05) = 30 px at the middle.
    ahead, turned = render([], clutter=1.0), render([], clutter=1.0, heading_rad=0.05)
    row = np.s_[100:240]
    moved = [np.abs(turned[row, 300:340].astype(float) - ahead[row, 300 - d : 340 - d]).mean() for d in range(60)]
    assert np.argmin(moved) == pytest.approx(30, abs=1)


def test_after_a_full_turn_the_background_is_the_same():
    assert np.array_equal(
        render([], clutter=1.0, heading_rad=0.3), render([], clutter=1.0, heading_rad=0.3 + 2 * np.pi)
    )


def test_numbers_out_of_range_are_refused_by_name():
    with pytest.raises(ValueError, match="noise_sigma"):
        sim.Renderer(CAMERA, imperfections(noise_sigma=-1.0))
    with pytest.raises(ValueError, match="tag36h11 has the ids 0 to 586"):
        render_tag(CAMERA, tag_pose(1.0), SHARP, tag_id=587)

"""A computer that is too slow for the camera searches less, and not later."""

import subprocess

from build_tree import built


def searches(*took_ms, frame_rate_hz=30.0, max_age_s=0.1):
    durations = "\n".join(map(str, took_ms))
    command = [built("search_budget_probe"), str(frame_rate_hz), str(max_age_s)]
    return subprocess.run(command, input=durations, capture_output=True, text=True, check=True).stdout.splitlines()


def test_whoever_is_quick_enough_searches_whole_pictures():
    assert searches(*[30] * 20) == ["whole"] * 20  # 33.3 ms are there


def test_a_search_that_takes_longer_than_a_frame_makes_three_coarse_ones_and_is_tried_again():
    assert searches(*[40] * 9) == ["whole warned"] + ["coarse"] * 3 + ["whole"] + ["coarse"] * 3 + ["whole"]


def test_whole_pictures_are_searched_again_as_soon_as_one_was_quick_enough():
    assert searches(40, 20, 20, 20, 10, 10, 10) == ["whole warned"] + ["coarse"] * 3 + ["whole"] * 3


def test_a_slow_camera_leaves_half_the_life_of_a_measurement_to_search():
    # 15 Hz leave 66.7 ms, but a measurement lives 100 ms, and the answer to it must still be worth something.
    assert searches(49, 51, frame_rate_hz=15.0) == ["whole", "whole warned"]

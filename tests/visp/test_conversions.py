"""ViSP's types and Pilotfish's say the same: nothing is scaled, shifted or silently left out."""

import pytest
from probe import conversions


@pytest.fixture(scope="module")
def facts():
    return conversions()


def test_a_frame_shows_the_pixels_of_the_picture_and_copies_none(facts):
    assert facts["same_pixels_in_memory"]
    assert facts["frame"] == [123456, 30, 20, 30, 600]  # utime, width, height, stride, 30 x 20 bytes


def test_a_picture_comes_back_from_a_frame_as_a_copy(facts):
    assert facts["image_back_is_equal"]
    assert facts["image_back_is_a_copy"]


def test_a_frame_without_pixels_is_an_empty_picture(facts):
    assert facts["image_of_nothing_is_empty"]


def test_a_pinhole_keeps_its_focal_lengths_and_its_centre(facts):
    assert facts["pinhole"] == [640, 480, 600, 610, 320, 240, 0, 0, 0, 0, 0]
    assert facts["pinhole_back"] == [600, 610, 320, 240, 0, 0, False]


def test_of_a_lens_kud_is_k1_and_the_way_back_is_its_inverse_to_first_order(facts):
    # x (1 + k r^2) (1 - k r^2) = x (1 - k^2 r^4), so k_du = -k_ud; the k_du of 0.25 that ViSP had is not used.
    assert facts["lens"] == [640, 480, 600, 610, 320, 240, -0.2, 0, 0, 0, 0]
    assert facts["lens_back"] == [600, 610, 320, 240, -0.2, 0.2, True]


def test_lenses_that_the_other_side_has_no_room_for_are_refused(facts):
    assert facts["fisheye_refused"] == "camera.distortion"  # ViSP's Kannala-Brandt model
    assert facts["two_coefficients_refused"] == "camera.distortion"


def test_a_rigid_motion_comes_back_to_the_last_bit_and_moves_points_alike(facts):
    assert facts["motion_back"]
    assert facts["same_motion_of_a_point"] < 1e-15

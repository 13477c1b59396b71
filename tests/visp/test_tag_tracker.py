"""TagTracker says what vpDetectorAprilTag says, nearer to the truth, and searches when it promises to."""

import numpy as np
import pytest
from probe import CAMERA, HALF_TURN, SIZE_M, angle_deg, ids_of, pose, pose_of, refusals, shift_m, show

OBLIQUE = pose(0.1, -0.05, 1.0, yaw_deg=30.0, pitch_deg=-15.0, roll_deg=20.0)


def nearly(tag, truth, mm, deg):
    return 1e3 * shift_m(pose_of(tag), truth) < mm and angle_deg(pose_of(tag), truth) < deg


@pytest.mark.parametrize("z_aligned", [False, True])
def test_the_tag_frame_is_that_of_vp_detector_april_tag(z_aligned):
    # By default the tag's y points up and its z to the reader, by half a turn about x from ours: R diag(1, -1, -1).
    (both,) = show([[OBLIQUE]], z_aligned=z_aligned)
    truth = OBLIQUE if z_aligned else OBLIQUE @ HALF_TURN
    assert nearly(both["ours"][0], truth, mm=0.2, deg=0.1)
    # ViSP's half pixel is 0.5 / 600 = 0.83 mm to the right and as much down at 1 m: 1.2 mm. The other 2 are its noise.
    assert nearly(both["visp"][0], truth, mm=3.2, deg=2.0)
    assert angle_deg(pose_of(both["ours"][0]), pose_of(both["visp"][0])) < 2.0


def test_corners_come_in_the_order_of_vp_detector_april_tag_half_a_pixel_up_and_left():
    # Its corners count from the corner of the first pixel, where the centre of that pixel is (0.5, 0.5).
    (both,) = show([[OBLIQUE]])
    ours, visp = (np.array(both[who][0]["corners"]) for who in ("ours", "visp"))
    assert ours + 0.5 == pytest.approx(visp, abs=0.25)
    h = SIZE_M / 2.0
    tag = np.array([[-h, h, 0, 1], [h, h, 0, 1], [h, -h, 0, 1], [-h, -h, 0, 1]])  # bottom left first, y down
    x, y, z, _ = OBLIQUE @ tag.T
    assert ours == pytest.approx(np.stack([600 * x / z + 319.5, 600 * y / z + 239.5], axis=1), abs=0.05)


def test_a_pose_has_no_half_pixel_in_it_where_vp_detector_april_tag_has():
    # A tag in 13 places and orientations, fractions of a pixel apart, so that no error of sampling stays. Half a
    # pixel at 1 m and f = 600 px is 0.5 / 600 m = 0.833 mm.
    pictures = [[pose(0.0231 * k - 0.14, 0.0137 * k - 0.08, 1.0, yaw_deg=4.0 * k - 24.0)] for k in range(13)]
    answers = show(pictures, noise=1.0)
    truths = [truth for (truth,) in pictures]

    def bias_mm(who):
        return 1e3 * np.mean(
            [pose_of(both[who][0])[:2, 3] - t[:2, 3] for both, t in zip(answers, truths, strict=True)], 0
        )

    assert np.abs(bias_mm("ours")).max() < 0.03
    assert bias_mm("visp") == pytest.approx([0.833, 0.833], abs=0.1)


def test_messages_boxes_and_centres_are_those_of_vp_detector_april_tag():
    (both,) = show([[pose(0.1, 0.0, 0.8)]], ids=(3,))
    (ours,), (visp,) = both["ours"], both["visp"]
    assert ours["message"] == visp["message"] == "36h11 id: 3"
    # 0.16 m at 0.8 m is 600 * 0.16 / 0.8 = 120 px wide; its middle is 600 * 0.1 / 0.8 = 75 px right of the centre.
    assert ours["box"] == pytest.approx([319.5 + 75 - 60, 239.5 - 60, 319.5 + 75 + 60, 239.5 + 60], abs=0.1)
    assert ours["cog"] == pytest.approx([394.5, 239.5], abs=0.05)
    assert np.array(ours["box"]) + 0.5 == pytest.approx(visp["box"], abs=0.3)
    assert np.array(ours["cog"]) + 0.5 == pytest.approx(visp["cog"], abs=0.3)


def test_a_lens_with_k1_does_not_move_the_pose():
    camera = [*CAMERA[:5], -0.2]
    truth = pose(0.35, 0.2, 1.2, yaw_deg=20.0)  # a third of the way to the corner
    *_, last = show([[truth]] * 3, camera=camera)
    assert nearly(last["ours"][0], truth @ HALF_TURN, mm=0.3, deg=0.15)


def sideways(k, y_m=0.0):
    """0.3 m/s to the right at 30 pictures a second, turning at 30 degrees a second."""
    return pose(-0.25 + 0.01 * k, y_m, 1.2, yaw_deg=k - 15.0)


def test_two_tags_are_followed_at_once_each_with_its_own_motion():
    pictures = [[sideways(k, -0.15), pose(0.25 - 0.01 * k, 0.15, 1.4, yaw_deg=20.0)] for k in range(9)]
    for both, (first, second) in zip(show(pictures, ids=(7, 4), noise=2.0), pictures, strict=True):
        assert ids_of(both["ours"]) == [4, 7]  # sorted by id
        assert both["searches"] == 1
        assert nearly(both["ours"][0], second @ HALF_TURN, mm=3.0, deg=1.0)
        assert nearly(both["ours"][1], first @ HALF_TURN, mm=3.0, deg=1.0)


def test_a_followed_tag_costs_one_search_in_as_many_pictures_as_the_period_says():
    # Pictures 0, 5 and 10 of 12.
    searches = [both["searches"] for both in show([[sideways(k)] for k in range(12)], search_period=5)]
    assert searches == [1] * 5 + [2] * 5 + [3] * 2


def test_with_period_zero_a_followed_tag_costs_one_search_for_ever():
    assert show([[sideways(k)] for k in range(25)], search_period=0)[-1]["searches"] == 1


def test_a_tag_that_appears_beside_a_followed_one_is_seen_at_the_next_search():
    # The second is there from picture 2 on; searches happen at 0, 4 and 8.
    pictures = [[sideways(k, -0.15), pose(0.2, 0.15, 1.4) if k >= 2 else None] for k in range(10)]
    answers = show(pictures, ids=(0, 1), search_period=4)
    assert [ids_of(both["ours"]) for both in answers] == [[0]] * 4 + [[0, 1]] * 6
    assert [ids_of(both["visp"]) for both in answers] == [[0]] * 2 + [[0, 1]] * 8


def test_a_tag_that_leaves_is_searched_for_in_every_picture_and_seen_in_the_first_one_it_is_back_in():
    # In pictures 3 to 6 there is none. It comes back elsewhere, where no track would look for it.
    away = pose(0.25, 0.1, 0.9, yaw_deg=-20.0)
    pictures = [[sideways(0)]] * 3 + [[None]] * 4 + [[away]] * 3
    answers = show(pictures)
    assert [len(both["ours"]) for both in answers] == [1] * 3 + [0] * 4 + [1] * 3
    assert [both["searches"] for both in answers] == [1, 1, 1, 2, 3, 4, 5, 6, 6, 6]
    assert nearly(answers[-1]["ours"][0], away @ HALF_TURN, mm=0.5, deg=0.2)


def test_one_lost_tag_is_searched_for_once_and_then_with_the_period():
    # The second is gone from picture 3 on, which is searched; the next searches are 10 pictures apart.
    pictures = [[sideways(k, -0.15), pose(0.2, 0.15, 1.4) if k < 3 else None] for k in range(15)]
    answers = show(pictures, ids=(0, 1))
    assert [ids_of(both["ours"]) for both in answers] == [[0, 1]] * 3 + [[0]] * 12
    assert [both["searches"] for both in answers] == [1] * 3 + [2] * 10 + [3] * 2


def test_a_tag_that_jumps_within_the_picture_is_still_seen():
    near, far = pose(-0.2, 0.0, 0.7), pose(0.6, 0.2, 2.0, yaw_deg=30.0)
    answers = show([[near], [far], [near]])
    for both, truth in zip(answers, (near, far, near), strict=True):
        assert nearly(both["ours"][0], truth @ HALF_TURN, mm=2.0, deg=1.0)


def test_detect_without_a_camera_follows_with_the_one_that_get_pose_was_given():
    answers = show([[OBLIQUE]] * 4, without_pose=True)
    assert [both["searches"] for both in answers] == [1, 2, 2, 2]  # the second still has nothing to follow
    assert nearly(answers[0]["ours"][0], OBLIQUE @ HALF_TURN, mm=3.0, deg=2.0)  # from libapriltag's corners
    for both in answers[1:]:
        assert nearly(both["ours"][0], OBLIQUE @ HALF_TURN, mm=0.2, deg=0.1)


@pytest.mark.parametrize("without_pose", [False, True])
@pytest.mark.parametrize("factor", [0.01, 100.0])
def test_a_tag_of_another_size_is_as_much_nearer_or_farther_and_turned_alike(factor, without_pose):
    # A picture says nothing about size: 1.6 mm at 1 cm looks as 0.16 m at 1 m and 16 m at 100 m do.
    *_, last = show([[OBLIQUE]] * 3, configured_size_m=factor * SIZE_M, without_pose=without_pose)
    scaled = OBLIQUE @ HALF_TURN
    scaled[:3, 3] *= factor
    assert nearly(last["ours"][0], scaled, mm=0.2 * factor, deg=0.1)


def test_a_coarser_search_finds_the_same_tag_and_measures_it_as_well():
    (both,) = show([[OBLIQUE]], decimation=2.0)
    assert nearly(both["ours"][0], OBLIQUE @ HALF_TURN, mm=0.2, deg=0.1)


def test_what_cannot_be_used_is_refused_by_name_and_pictures_that_cannot_have_no_tags():
    said = refusals()
    keys = {key: said[key] for key in ("unknown_family", "size_zero", "fisheye", "no_focal_length", "decimation")}
    assert keys == {
        "unknown_family": "leader.family",
        "size_zero": "tag_size_m",
        "fisheye": "camera.distortion",
        "no_focal_length": "camera.fx",
        "decimation": "vision.decimation",
    }
    assert (said["search_period"], said["frame_rate"]) == ("search_period", "frame_rate_hz")
    # gray, 8x8 pixels, no pixels, the same without a camera; and the pose of a tag that is not there
    assert said["seen"] == [False] * 5
    assert said["poses"] == 0
    assert said["no_such_tag"]


def test_an_id_that_is_twice_in_a_picture_is_not_accepted():
    (both,) = show([[pose(-0.2), pose(0.2)]], ids=(5, 5))
    assert ids_of(both["ours"]) == []
    assert ids_of(both["visp"]) == [5, 5]

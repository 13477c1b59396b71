"""What bench/visp makes of the lines of its program."""

import numpy as np
import pytest

from bench.visp.figures import all_figures, rotation_error_deg


def turned(angle_deg, axis=1):
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    matrix = np.eye(4)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[a, a], matrix[a, b], matrix[b, a], matrix[b, b] = c, -s, s, c
    return matrix


def at(x_m, y_m, z_m, rotation=None):
    matrix = np.eye(4) if rotation is None else rotation.copy()
    matrix[:3, 3] = x_m, y_m, z_m
    return matrix


def line(tracker, ms, *tags):
    listed = [
        {"id": i, "truth": truth.ravel().tolist(), "pose": None if pose is None else pose.ravel().tolist()}
        for i, (truth, pose) in enumerate(tags)
    ]
    return {"tracker": tracker, "row": "ba".index(tracker), "picture": 0, "elapsed_ns": ms * 1e6, "tags": listed}


@pytest.mark.parametrize("angle_deg", [0.0, 0.001, 30.0, 120.0, 180.0])
def test_the_angle_between_two_rotations_is_the_angle_that_lies_between(angle_deg):
    assert rotation_error_deg(turned(17.0, 0) @ turned(angle_deg), turned(17.0, 0)) == pytest.approx(
        angle_deg, abs=1e-6
    )


def test_times_and_errors_are_told_by_eye_in_the_order_of_their_rows():
    truth = at(0, 0, 1)
    rows = all_figures(
        [
            line("a", 5, (truth, None)),
            line("b", 1, (truth, at(0.003, 0, 1))),
            line("b", 2, (truth, at(0, 0.004, 1))),
            line("b", 9, (truth, truth)),
        ]
    )
    assert [row.tracker for row in rows] == ["b", "a"]
    assert (rows[0].median_ms, rows[0].mean_ms, rows[0].p95_ms) == pytest.approx((2, 4, 9))
    assert rows[0].translation_rms_mm == pytest.approx(np.sqrt((9 + 16 + 0) / 3))
    assert rows[0].bias_mm == pytest.approx((1.0, 4 / 3, 0))
    assert (rows[0].seen, rows[1].seen) == (1.0, 0.0)
    assert np.isnan(rows[1].translation_rms_mm)


def test_a_pose_a_tenth_off_was_not_of_the_tag_and_one_ten_degrees_off_is_the_other_solution():
    truth = at(0, 0, 1)
    (row,) = all_figures(
        [line("a", 1, (truth, at(0, 0, 1.2)), (truth, at(0, 0, 1, turned(20))), (truth, at(0, 0, 1, turned(2))))]
    )
    assert row.seen == pytest.approx(2 / 3)
    assert row.flipped == 1
    assert row.unflipped_rms_deg == pytest.approx(2.0)
    assert row.rotation_rms_deg == pytest.approx(np.sqrt((400 + 4) / 2))

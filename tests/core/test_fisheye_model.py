"""Kannala and Brandt's lens against OpenCV's, which shares no code with it."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import core
from pilotfish.core import Lens

SIZE = {"width": 1280, "height": 960, "fx": 400, "fy": 402, "cx": 645, "cy": 475}
COEFFICIENTS = {"k1": 0.02, "k2": -0.01, "k3": 0.004, "k4": -0.0007}


def fisheye(**changes):
    return core.CameraModel(**{**SIZE, **COEFFICIENTS, "lens": Lens.kannala_brandt, **changes})


def opencvs(point_m):
    matrix = np.array([[400, 0, 645], [0, 402, 475], [0, 0, 1.0]])
    points = np.array(point_m, float).reshape(1, 1, 3)
    pixels, _ = cv2.fisheye.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array([*COEFFICIENTS.values()]))
    return pixels.reshape(2)


@settings(derandomize=True, max_examples=300, deadline=None)
@given(st.floats(0, 88), st.floats(-180, 180), st.floats(0.1, 20))
def test_points_are_where_opencv_projects_them(off_axis_deg, around_deg, z_m):
    r, around = np.tan(np.radians(off_axis_deg)), np.radians(around_deg)
    point = [r * np.cos(around) * z_m, r * np.sin(around) * z_m, z_m]
    assert fisheye().project(point) == pytest.approx(opencvs(point), abs=1e-6)


@settings(derandomize=True, max_examples=300, deadline=None)
@given(st.floats(0, 1279), st.floats(0, 959))
def test_normalising_a_pixel_and_projecting_it_gives_the_pixel_back(u, v):
    """But where the picture shows what is at 90 degrees or more off the axis, or behind: there, the nearest direction
    in front, 89.9 degrees, is on the same side."""
    x, y = fisheye().normalize([u, v])
    back = fisheye().project([x, y, 1.0])
    if np.degrees(np.arctan(np.hypot(x, y))) < 89.89:
        assert back == pytest.approx([u, v], abs=1e-6)
    else:
        middle = np.array([645, 475])
        along, far = back - middle, np.array([u, v]) - middle
        assert np.hypot(*far) >= np.hypot(*along) - 1e-6
        assert along @ far == pytest.approx(np.hypot(*along) * np.hypot(*far), rel=1e-3)


def test_on_the_axis_the_middle_is_the_middle():
    assert fisheye().project([0, 0, 1]) == pytest.approx([645, 475])
    assert fisheye().normalize([645, 475]) == pytest.approx([0, 0])
    assert fisheye().project([1e-9, 0, 1]) == pytest.approx([645 + 400e-9, 475], abs=1e-12)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"p1": 0.1}, "p1"),  # of the other lens
        ({"k4": float("nan")}, "k4"),
        ({"k1": -0.5}, "distortion"),  # t (1 - t^2 / 2) folds over at t = 0.82, 47 degrees
        ({"k1": 1e3}, "distortion"),
    ],
)
def test_what_is_no_fisheye_is_refused_by_name(change, key):
    with pytest.raises(ValueError, match=rf"^camera\.{key}: "):
        fisheye(**change)


def test_a_lens_that_is_no_fisheye_has_no_k4():
    with pytest.raises(ValueError, match=r"^camera\.k4: 0\.1 is not allowed; only a Kannala-Brandt lens has it"):
        core.CameraModel(**SIZE, k4=0.1)


def test_a_fisheyes_calibration_is_read_by_the_name_that_ros_gives_it(tmp_path):
    from pilotfish import coordinator

    text = """image_width: 1280
image_height: 960
camera_matrix: {rows: 3, cols: 3, data: [400, 0, 645, 0, 402, 475, 0, 0, 1]}
distortion_model: equidistant
distortion_coefficients: {rows: 1, cols: 4, data: [0.02, -0.01, 0.004, -0.0007]}
"""
    file = tmp_path / "fisheye.yaml"
    file.write_text(text)
    camera = coordinator.load_calibration(str(file))
    assert camera.lens == Lens.kannala_brandt
    assert (camera.k1, camera.k2, camera.k3, camera.k4) == tuple(COEFFICIENTS.values())
    assert (camera.p1, camera.p2) == (0.0, 0.0)
    for wrong, says in (
        (text.replace("cols: 4, data: [0.02,", "cols: 3, data: ["), "needs the four numbers k1, k2, k3, k4"),
        (text.replace("equidistant", "omni"), "'omni' is not supported; plumb_bob is .* and equidistant"),
    ):
        file.write_text(wrong)
        with pytest.raises(ValueError, match=says):
            coordinator.load_calibration(str(file))

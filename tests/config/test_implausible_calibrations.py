"""A calibration that no camera can have would turn into distances and angles: it is refused with its key, its value and
what is allowed."""

import re

import pytest
from test_config_files import OPENCV, VISP

from pilotfish import coordinator, core

MATRIX = "[ 612.5, 0., 321.25, 0., 611.5, 238.75, 0., 0., 1. ]"
DISTORTION = "[ -2.5e-01, 8.0e-02, 1.0e-03, -2.0e-03, 5.0e-03 ]"


def matrix(**changed):
    """MATRIX with element i (as `_i`) changed."""
    elements = MATRIX.strip("[] ").split(", ")
    for name, value in changed.items():
        elements[int(name[1:])] = value
    return OPENCV.replace(MATRIX, f"[ {', '.join(elements)} ]")


REFUSED = {
    "skew": (matrix(_1="1.0e9"), r"camera_matrix\.data\[1\]: 1e\+09 is not allowed for the skew .*; only 0 is"),
    "small skew": (matrix(_1="0.1"), r"camera_matrix\.data\[1\]: 0\.1 is not allowed"),
    "[3]": (matrix(_3="1"), r"camera_matrix\.data\[3\]: 1 is not allowed .*; only 0 is"),
    "[6]": (matrix(_6="-2"), r"camera_matrix\.data\[6\]: -2 is not allowed"),
    "[7]": (matrix(_7=".nan"), r"camera_matrix\.data\[7\]: nan is not allowed"),
    "[8]": (matrix(_8="2."), r"camera_matrix\.data\[8\]: 2 is not allowed for the last element; only 1 is"),
    "fx beside fy": (matrix(_0="70"), r"camera\.fx: 70 beside fy = 611\.5 is not allowed; .* between 0\.8 and 1\.25"),
    "fy beside fx": (matrix(_4="800"), r"camera\.fx: 612\.5 beside fy = 800 is not allowed"),
    "letters behind": (matrix(_0="612.5px"), r"camera_matrix\.data: '612\.5px' is not a number"),
    "hexadecimal": (OPENCV.replace("width: 640", "width: 0x280"), r"image_width: '0x280' is not a whole number"),
    "half a pixel": (OPENCV.replace("width: 640", "width: 640.5"), r"image_width: '640\.5' is not a whole number"),
    # Positive: stretched a thousand times. Negative: folded over inside the picture.
    "k1": (OPENCV.replace("-2.5e-01", "1.0e9"), r"camera\.distortion: k1 = 1e\+09.* is no lens: allowed is"),
    "-k1": (OPENCV.replace("-2.5e-01", "-9."), r"camera\.distortion: k1 = -9,.* is no lens"),
    "k3": (OPENCV.replace("5.0e-03 ]", "-1.0e300 ]"), r"camera\.distortion: .* k3 = -1e\+300 is no lens"),
    "xml, letters behind": (VISP.replace(">640<", ">640abc<"), r"calibration\.image_width: '640abc' is not a whole"),
    "xml, half a pixel": (VISP.replace(">640<", ">640.7<"), r"calibration\.image_width: '640\.7' is not a whole"),
    "xml, huge": (VISP.replace(">640<", ">99999999999<"), r"calibration\.image_width: '99999999999' is not a whole"),
    "xml, two numbers": (VISP.replace(">605.1<", ">605.1 7<"), r"calibration\.px: '605\.1 7' is not a number"),
    "xml, nothing": (VISP.replace(">605.1<", "> <"), r"calibration\.px: '' is not a number"),
    "xml, comma": (VISP.replace(">605.1<", ">605,1<"), r"calibration\.px: '605,1' is not a number"),
    "xml, nan": (VISP.replace(">605.1<", ">nan<"), r"camera\.fx: nan is not allowed"),
    "xml, aspect": (VISP.replace(">605.1<", ">70<"), r"camera\.fx: 70 beside fy = 606\.2 is not allowed"),
    "xml, kud": (VISP.replace(">-0.19<", ">-19<"), r"camera\.distortion: k1 = -19,.* is no lens"),
}


@pytest.mark.parametrize(("text", "says"), REFUSED.values(), ids=REFUSED)
@pytest.mark.fault("implausible_calibration")
def test_an_implausible_calibration_is_refused(tmp_path, text, says):
    (tmp_path / "camera").write_text(text)
    with pytest.raises(ValueError, match=says):
        coordinator.load_calibration(tmp_path / "camera")


@pytest.mark.parametrize(
    "text",
    [
        OPENCV,
        VISP,
        matrix(_0="+612.5", _1="-0.", _8="1"),
        matrix(_0="500", _4="610"),
        VISP.replace(">640<", ">\n  640\t<"),
        OPENCV.replace("rows: 5", "rows: 4").replace(DISTORTION, "[ 0., 0., 0., 0. ]"),
    ],
    ids=["opencv", "visp", "signs", "a coarse sensor", "spaces", "a perfect lens"],
)
def test_a_plausible_calibration_is_read(tmp_path, text):
    (tmp_path / "camera").write_text(text)
    assert coordinator.load_calibration(tmp_path / "camera").width == 640


def test_the_camera_of_a_program_is_checked_like_that_of_a_file():
    with pytest.raises(ValueError, match=re.escape("camera.fx: 70 beside fy = 600")):
        core.CameraModel(width=640, height=480, fx=70.0, fy=600.0, cx=320.0, cy=240.0)

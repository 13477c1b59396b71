"""The camera model against its formulas, and frames that cannot be read."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import core


def camera(**changes):
    return core.CameraModel(**{"width": 640, "height": 480, "fx": 600, "fy": 590, "cx": 320.5, "cy": 239.5, **changes})


DISTORTED = camera(k1=-0.25, k2=0.08, p1=0.001, p2=-0.002, k3=-0.01)


def test_without_distortion_the_projection_is_the_pinhole():
    # u = 600 * 0.5/2 + 320.5 = 470.5, v = 590 * (-0.2)/2 + 239.5 = 180.5
    assert camera().project([0.5, -0.2, 2.0]) == pytest.approx([470.5, 180.5])


def test_the_distortion_is_opencvs_polynomial():
    # x = 0.3, y = -0.2: r2 = 0.13; radial = 1 - 0.25*0.13 + 0.08*0.0169 - 0.01*0.002197 = 0.96883003
    # x' = 0.3*radial + 2*0.001*0.3*(-0.2) + (-0.002)*(0.13 + 0.18) = 0.290649009 - 0.00012 - 0.00062 = 0.289909009
    # y' = -0.2*radial + 0.001*(0.13 + 0.08) + 2*(-0.002)*0.3*(-0.2) = -0.193766006 + 0.00021 + 0.00024 = -0.193316006
    expected = [600 * 0.289909009 + 320.5, 590 * -0.193316006 + 239.5]
    assert DISTORTED.project([0.3, -0.2, 1.0]) == pytest.approx(expected, abs=1e-5)


@settings(derandomize=True, max_examples=300)
@given(st.floats(0, 639), st.floats(0, 479))
def test_normalising_a_pixel_and_projecting_it_gives_the_pixel_back(u, v):
    x, y = DISTORTED.normalize([u, v])
    assert DISTORTED.project([x, y, 1.0]) == pytest.approx([u, v], abs=1e-7)


def test_a_point_behind_the_camera_has_no_pixel():
    assert camera().project([0, 0, -1]) is None
    assert camera().project([0, 0, 0]) is None
    assert camera().project([0, 0, math.nan]) is None


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"width": 8}, "width"),
        ({"fx": 0}, "fx"),
        ({"fy": math.nan}, "fy"),
        ({"cx": 700}, "cx"),
        ({"k1": math.inf}, "k1"),
    ],
)
def test_intrinsics_that_no_camera_has_are_refused_by_name(change, key):
    with pytest.raises(ValueError, match=rf"camera\.{key}"):
        camera(**change)


def test_a_frame_keeps_its_pixels_and_its_time():
    image = np.arange(20 * 32, dtype=np.uint8).reshape(20, 32)
    frame = core.Frame(image, utime=5)
    assert frame.utime == 5
    assert (frame.image == image).all()
    assert frame.defect == core.Reason.none


@pytest.mark.parametrize(
    "wrong", [np.zeros((4, 4, 3), np.uint8), np.zeros((32, 32)), np.zeros((64, 64), np.uint8)[:, ::2]]
)
def test_an_array_that_is_not_a_contiguous_gray_image_is_a_value_error(wrong):
    with pytest.raises(ValueError, match=r"shape \(H, W\) and dtype uint8"):
        core.Frame(wrong, utime=0)


@pytest.mark.parametrize(
    ("width", "height", "stride", "size", "reason"),
    [
        (0, 0, 0, 0, "frame_too_small"),
        (1, 1, 1, 1, "frame_too_small"),
        (640, 1, 640, 640, "frame_too_small"),
        (40000, 480, 40000, 10, "frame_too_large"),
        (-640, 480, 640, 10, "frame_too_small"),
        (64, 64, 63, 64 * 64, "frame_stride_invalid"),
        (64, 64, -64, 64 * 64, "frame_stride_invalid"),
        (64, 64, 64, 64 * 64 - 1, "frame_truncated"),
        (64, 64, 2**31 - 1, 64 * 64, "frame_truncated"),
        (64, 64, 80, 80 * 63 + 64, "none"),  # the last row needs no padding
    ],
)
def test_a_frame_that_promises_what_it_does_not_hold_is_seen_through(width, height, stride, size, reason):
    frame = core.Frame.unchecked(bytes(size), width=width, height=height, stride_bytes=stride, utime=0)
    assert frame.defect == getattr(core.Reason, reason)

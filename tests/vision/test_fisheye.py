"""A leader seen through a fisheye, without rectifying the picture: Kannala and Brandt's lens."""

from dataclasses import replace

import numpy as np
import pytest
from pinhole_drawing import Photography, draw, leader_pose

from pilotfish.core import BodyTag, CameraModel, CameraMounting, FoundBy, Frame, LeaderBody, Lens
from pilotfish.vision import LeaderObserver, LeaderObserverConfig

# t = 1.344, 77 degrees off the axis: 250 (t - 0.04 t^3 + 0.012 t^5 - 0.005 t^7 + 0.0006 t^9) = 317 px, near the edges.
FISHEYE = CameraModel(
    width=640, height=480, fx=250, fy=250, cx=322, cy=236,
    k1=-0.04, k2=0.012, k3=-0.005, k4=0.0006, lens=Lens.kannala_brandt,
)  # fmt: skip
TAG = BodyTag(id=3, size_m=0.16)
REAL = Photography(blur_sigma_px=0.7, noise_sigma=3.0)


def observer(camera):
    config = LeaderObserverConfig(acquisition_range_m=2.0)
    return LeaderObserver(camera=camera, mounting=CameraMounting(), body=LeaderBody([TAG]), config=config)


def leader_at(distance_m, bearing_rad, heading_rad):
    return leader_pose(distance_m * np.cos(bearing_rad), distance_m * np.sin(bearing_rad), heading_rad, 0.0)


@pytest.mark.parametrize("bearing_deg", [0, -25, 45, -60])
def test_a_leader_far_off_the_axis_is_measured_as_well_as_one_on_it(bearing_deg):
    """With a corner within 0.02 px (see test_leader_observer.py) and the tag facing the camera, so that it is
    f s / d = 250 0.16 / 0.8 = 50 px wide on the axis and two thirds of that off it: 0.02 px of 50 are 0.3 mm of 0.8 m,
    and half as much again off the axis; the bearing is better than a tenth of a pixel, 0.4 mrad."""
    vision, errors = observer(FISHEYE), []
    for i in range(6):
        bearing = np.radians(bearing_deg + i)
        cMo = leader_at(0.8, bearing, bearing + np.radians(10))
        vision.forget()
        found = vision.observe(Frame(draw(FISHEYE, [(TAG, cMo)], replace(REAL, seed=i)), utime=i)).observation
        assert found is not None, f"not found at {np.degrees(bearing):.0f} degrees"
        errors.append([found.distance_m - 0.8, found.bearing_rad - bearing])
    distance_rms, bearing_rms = np.sqrt(np.mean(np.square(errors), axis=0))
    assert distance_rms < 3 * 0.45e-3
    assert bearing_rms < 0.4e-3


def test_taken_for_a_pinhole_the_same_pictures_are_wrong():
    naive = CameraModel(width=640, height=480, fx=250, fy=250, cx=322, cy=236)
    bearing = np.radians(45)
    frame = Frame(draw(FISHEYE, [(TAG, leader_at(0.8, bearing, bearing))], REAL), utime=1)
    found = observer(naive).observe(frame).observation
    # At 45 degrees a pinhole would have the tag at tan(45) = 1, the fisheye has it at 0.785 less its distortion.
    assert found is None or abs(found.bearing_rad - bearing) > np.radians(5)


def test_a_leader_is_followed_across_a_fisheyes_picture():
    vision = observer(FISHEYE)
    for i, bearing in enumerate(np.radians(np.linspace(-60, 60, 80))):
        cMo = leader_at(0.8, bearing, bearing)
        found = vision.observe(
            Frame(draw(FISHEYE, [(TAG, cMo)], replace(REAL, seed=i)), utime=1 + i * 33_333)
        ).observation
        assert found is not None
        assert abs(found.distance_m - 0.8) < 3e-3
        assert i < 2 or found.found_by == FoundBy.track

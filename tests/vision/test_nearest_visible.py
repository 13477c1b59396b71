"""How near a leader may come before the camera sees too little of its tags, and who must know."""

import math

import pytest
from rendered_leaders import BODY, CAMERA, frame, leader_at, render

from pilotfish import ConfigError, coordinator, data, vision
from pilotfish.core import BodyTag, CameraMounting, LeaderBody


def nearest(camera=CAMERA, mounting=None, body=BODY):
    return vision.nearest_visible_distance_m(camera, mounting or CameraMounting(), body)


def test_a_tag_at_the_height_of_the_camera_fills_the_picture():
    """0.16 m: 100 cells of 20 mm, their middles at 10, 30, ... 90 mm from its own. 320 px to the side (f = 600 px) show
    90 mm from a depth of 169 mm on, 240 px up and down 50 mm from 125 mm on: then 6 of 10 rows are inside, whole, and
    all bits. At less than 169 mm 6 rows of 8 remain, which are 48 of 100 cells, less than half."""
    assert nearest() == pytest.approx(0.17)


def test_the_tag_s_and_the_camera_s_places_on_their_robots_count():
    body = LeaderBody([BodyTag(id=3, size_m=0.16, position_m=[-0.20, 0.03, 0.25])])
    mounting = CameraMounting(position_m=[0.05, 0.0, 0.25])
    # The camera stands where the tag is straight ahead of it: 30 mm to the side.
    assert nearest(mounting=mounting, body=body) == pytest.approx(math.hypot(0.17 + 0.05 + 0.20, 0.03))


def test_a_tag_above_the_camera_leaves_the_picture_sooner():
    """0.1 m above: rows 10, 30, ... 190 mm up, of which 5 whole ones (50 cells) are seen when the one at 90 mm is, from
    90 / 0.4 = 225 mm on; but 22 bits are two thirds of the six rows from 50 to 150 mm: 110 mm up, from 275 mm on."""
    body = LeaderBody([BodyTag(id=3, size_m=0.16, position_m=[0.0, 0.0, 0.1])])
    assert nearest(body=body) == pytest.approx(0.28)


def test_a_camera_that_looks_at_the_ceiling_sees_no_leader():
    assert nearest(mounting=CameraMounting(position_m=[0, 0, 0.3], tilt_rad=math.radians(80))) == math.inf


def test_the_tracker_follows_a_leader_to_there_and_no_nearer():
    observer = vision.LeaderObserver(camera=CAMERA, body=BODY)
    for k in range(60):
        distance_m = 0.4 - 0.004 * k
        observation = observer.observe(frame(render([(BODY, leader_at(distance_m))], k), k)).observation
        if observation is None:
            break
    assert nearest() - 0.01 < distance_m < nearest()


def test_a_guard_that_the_camera_cannot_keep_is_refused_at_load():
    shipped = coordinator.load_coordinator(data.path("config/line.yaml")).coordinator
    coordinator.Coordinator(shipped)
    shipped.control.guard.minimum_distance_m = 0.41
    with pytest.raises(ConfigError, match=r"control\.guard\.minimum_distance_m: 0\.41 m .* 0\.415 to 20 m") as refused:
        coordinator.Coordinator(shipped)
    assert refused.value.key == "control.guard.minimum_distance_m"

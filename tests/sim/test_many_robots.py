"""A world of many robots: what is not seen costs nothing and changes nothing, and threads change nothing."""

import numpy as np
import pytest
from tag_scenes import SHARP, body_pose, tag_body, tag_pose

from pilotfish import core, data, sim
from pilotfish.harness.over_lcm import run_over_lcm
from pilotfish.harness.scenario import Scenario

PINHOLE = core.CameraModel(width=320, height=240, fx=300.0, fy=300.0, cx=159.5, cy=119.5)
BARREL = core.CameraModel(width=320, height=240, fx=300.0, fy=300.0, cx=160.0, cy=118.0, k1=-0.2, k2=0.05)
WALL = tag_body(0, box_size_m=[0.1, 0.8, 0.6], box_position_m=[0.1, 0.0, 0.0])  # 1.2 m away it fills +-0.33


def small(tag_id):
    """A box of 0.1 m behind a tag of 0.16 m."""
    return tag_body(tag_id, box_size_m=[0.1, 0.1, 0.1], box_position_m=[0.1, 0.0, 0.0])


def at(x_m, z_m, yaw_deg=0.0, y_m=0.0):
    return body_pose(tag_pose(z_m, yaw_deg=yaw_deg, x_m=x_m, y_m=y_m))


@pytest.mark.parametrize("camera", [PINHOLE, BARREL], ids=["pinhole", "barrel"])
def test_a_body_behind_another_changes_no_pixel(camera):
    """At 3 m a body within +-0.3 m of the axis lies within +-0.1 of it, and the wall reaches to 0.4 / 1.2 = 0.33."""
    renderer = sim.Renderer(camera, SHARP)
    alone = renderer.render([(WALL, at(0.0, 1.2))])
    random = np.random.default_rng(1)
    behind = [(small(i), at(*random.uniform([-0.3, 2.0], [0.3, 8.0]), random.uniform(-60, 60))) for i in range(1, 40)]
    for order in ([*behind, (WALL, at(0.0, 1.2))], [(WALL, at(0.0, 1.2)), *behind]):
        assert np.array_equal(renderer.render(order), alone)


def test_a_body_that_sticks_out_behind_another_is_seen_where_it_does():
    """At 3 m the wall hides +-0.33 * 3 = 1 m; a tag (0.2 m wide, with its margin) at 1 m is half hidden."""
    renderer = sim.Renderer(PINHOLE, SHARP)
    alone = renderer.render([(WALL, at(0.0, 1.2))])
    both = renderer.render([(small(1), at(1.0, 3.0)), (WALL, at(0.0, 1.2))])
    changed = np.flatnonzero((both != alone).any(axis=0))
    edge_px = 159.5 + 300.0 * 0.4 / 1.25  # where the wall ends: its front is 0.05 m behind its tag
    assert edge_px - 1 <= changed.min() <= edge_px + 1
    assert 259 <= changed.max() <= 271  # 159.5 + 300 * (1.0 + 0.1) / 3.0 = 269.5


def test_a_body_nearer_than_what_it_hides_is_drawn_over_it_in_any_order():
    renderer = sim.Renderer(PINHOLE, SHARP)
    near, wall = (small(3), at(0.0, 0.8)), (WALL, at(0.0, 1.2))
    one, other = renderer.render([near, wall]), renderer.render([wall, near])
    assert np.array_equal(one, other)
    assert not np.array_equal(one, renderer.render([wall]))


def test_bodies_out_of_view_change_no_pixel():
    """Behind the camera, and beyond the edge at 160 / 300 = 0.53 by more than a body."""
    renderer = sim.Renderer(PINHOLE, SHARP)
    seen = (small(1), at(0.1, 1.5))
    away = [(small(2), at(0.0, -1.0)), (small(3), at(2.0, 2.0)), (small(4), at(-2.0, 2.0)), (small(5), at(0, 2, y_m=3))]
    assert np.array_equal(renderer.render([seen, *away]), renderer.render([seen]))


def test_sixty_bodies_in_a_row_look_like_the_nearest_of_them():
    """More surfaces lie on one pixel than any fixed number of candidates: the nearest must still be on top."""
    renderer = sim.Renderer(PINHOLE, SHARP)
    narrow_m = [0.6 + 0.4 * k for k in range(60)]  # of the same width, so each lies within the one before
    bodies = [(small(k), at(0.0, z_m)) for k, z_m in enumerate(narrow_m)]
    assert np.array_equal(renderer.render(bodies[::-1]), renderer.render(bodies[:1]))


def test_robots_with_equal_cameras_take_the_pictures_they_would_take_alone():
    """They share what is computed once per camera; a third, with another lens, does not."""
    spec = sim.load_scenario(data.path("scenarios/star.yaml"))
    together = sim.World(spec)
    robots = spec.robots
    changed = robots[2].camera
    changed.model = BARREL
    robots[2].camera = changed
    spec.robots = robots
    apart = sim.World(spec)
    assert np.array_equal(together.capture("robot1").image, apart.capture("robot1").image)
    assert apart.capture("robot2").image.shape == (240, 320)


def test_the_number_of_threads_changes_no_run():
    scenario = Scenario.load(data.path("scenarios/star.yaml"))
    runs = [
        run_over_lcm(scenario, profile="anticipate", duration_s=0.5, sim_options=["--threads", threads])
        for threads in ("1", "3")
    ]
    for robot in ("robot1", "robot2"):
        one, other = (run.recordings[robot] for run in runs)
        for column in ("x_m", "y_m", "heading_rad", "command_linear_mps", "command_angular_radps"):
            assert np.array_equal(getattr(one, column), getattr(other, column)), column

"""A camera that gives the same picture again and again, with new stamps, shows nothing of what is there now."""

import pytest

from pilotfish import coordinator, core
from pilotfish import data as shipped
from pilotfish.core import Reason, Status
from scenes import PERIOD_US, leader_pictures

CONFIG = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
PICTURES = [frame.image for frame in leader_pictures(40)]
STILL = core.Twist()


def step(robot, image, k):
    utime = 1_000_000 + k * PERIOD_US
    return robot.step(core.Frame(image, utime=utime), utime)


@pytest.mark.fault("camera_frozen")
def test_the_third_picture_in_a_row_with_the_same_pixels_moves_nothing():
    robot = coordinator.Coordinator(CONFIG)
    for k in range(10):
        assert step(robot, PICTURES[k], k).status == Status.tracking
    assert step(robot, PICTURES[9], 10).reason == Reason.picture_repeated
    for k in range(11, 100):
        result = step(robot, PICTURES[9], k)
        assert (result.status, result.reason) == (Status.invalid_input, Reason.camera_frozen)
        assert result.command == STILL
    assert step(robot, PICTURES[10], 100).status == Status.tracking, "it has come back to life"


@pytest.mark.parametrize("rate_hz", [12, 15, 20, 30, 60])
def test_a_repeated_picture_does_not_lengthen_the_life_of_the_last_measurement(rate_hz):
    """At 15 Hz the third picture, of which it is certain, comes 133 ms after the first: the command ends at 100 ms."""
    robot = coordinator.Coordinator(CONFIG)
    times = [1_000_000 + round(k * 1e6 / rate_hz) for k in range(12)]
    for k, utime in enumerate(times[:10]):
        assert robot.step(core.Frame(PICTURES[k], utime=utime), utime).status == Status.tracking
    assert robot.held.until_us == times[9] + 100_000
    result = robot.step(core.Frame(PICTURES[9], utime=times[10]), times[10])
    assert (result.status, result.reason) == (Status.coasting, Reason.picture_repeated)
    assert robot.held.until_us == times[9] + 100_000
    assert robot.command_at(times[9] + 100_000).command != STILL
    assert robot.command_at(times[9] + 100_001).command == STILL


def test_one_picture_that_a_driver_delivers_twice_costs_nothing_but_itself():
    robot = coordinator.Coordinator(CONFIG)
    shown = [*range(10), 9, *range(10, 20)]
    results = [step(robot, PICTURES[picture], k) for k, picture in enumerate(shown)]
    assert [r.status for r in results] == [Status.tracking] * 10 + [Status.coasting] + [Status.tracking] * 10
    assert all(r.command != STILL for r in results[1:])


@pytest.mark.parametrize("ring", [2, 4, 8, 16])
def test_a_driver_that_goes_round_its_ring_of_old_buffers_is_frozen_as_well(ring):
    robot = coordinator.Coordinator(CONFIG)
    results = [step(robot, PICTURES[k % ring], k) for k in range(60)]
    assert all(r.reason == Reason.camera_frozen and r.command == STILL for r in results[2 * ring :])


def test_one_gray_level_in_one_pixel_is_a_living_camera():
    robot = coordinator.Coordinator(CONFIG)
    for k in range(20):
        image = PICTURES[0].copy()
        image[(37 * k) % 480, (101 * k) % 640] ^= 1
        assert step(robot, image, k).reason != Reason.camera_frozen


@pytest.mark.parametrize("width", [633, 637, 639])
def test_the_pixels_behind_the_last_whole_word_of_a_row_count_as_well(width):
    """Words have 8 pixels, and 632 are 79 of them. Only the last pixel of the last row changes: a living camera."""
    config = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
    camera = config.camera
    config.camera = core.CameraModel(width=width, height=480, fx=camera.fx, fy=camera.fy, cx=camera.cx, cy=camera.cy)
    robot = coordinator.Coordinator(config)
    for k in range(10):
        image = PICTURES[0][:, :width].copy()
        image[479, width - 1] = 100 + k
        assert step(robot, image, k).reason != Reason.camera_frozen
    step(robot, image, 10)
    assert step(robot, image, 11).reason == Reason.camera_frozen, "the third with the same pixels"


def test_pictures_declared_noiseless_may_repeat():
    config = coordinator.load_coordinator(str(shipped.path("config/line.yaml"))).coordinator
    config.safety.noiseless_camera = True
    robot = coordinator.Coordinator(config)
    assert all(step(robot, PICTURES[0], k).status == Status.tracking for k in range(10))

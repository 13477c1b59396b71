"""Ranges, what they are checked for, and how obstacles are passed."""

import math

import numpy as np
import pytest
from ring_robot import FRAME_US, Robot, leader_at, ring, settings

from pilotfish import control, coordinator, core, fuzzy
from pilotfish import data as shipped
from pilotfish.core import Reason, Status

AHEAD_RAD = math.radians(1.0)  # within the sensor just left of straight ahead
VIEW_RAD = math.atan2(319.5, 600.0)  # half of a picture of 640 px at f = 600 px; sim_640x480 is nearly that


def test_without_the_section_ranges_are_ignored():
    robot = coordinator.Coordinator(settings(avoidance={"enabled": False}, search={"search_by_rotating": False}))
    robot.step_observation(1_000_000, leader_at(1_000_000), 1_000_000)
    assert not robot.set_ranges(ring(1_010_000), 1_010_000)
    result = robot.step_observation(1_033_333, leader_at(1_033_333, distance_m=2.0), 1_033_333)
    assert result.status == Status.tracking
    assert result.control.avoidance is None
    assert result.command.linear_mps > 0.0


def test_without_ranges_the_robot_does_not_drive_and_says_why():
    robot = Robot()
    for result in robot.steps(10, ranges=False, distance_m=2.0):
        assert result.command == core.Twist()
        assert (result.status, result.reason) == (Status.invalid_input, Reason.ranges_not_fresh)
    assert robot.steps(3, distance_m=2.0)[-1].command.linear_mps > 0.0


def test_a_command_does_not_outlive_the_ranges_it_was_made_with():
    # Frames and ranges are 100 and 60 ms good. The last ring came 33 ms before the frame: 27 ms after it all is over.
    robot = Robot(settings(avoidance={"max_age_s": 0.06}))
    robot.steps(5, distance_m=2.0)
    robot.step(ranges=False, distance_m=2.0)
    assert robot.core.held.until_us == robot.now_us - FRAME_US + 60_000
    assert robot.core.command_at(robot.now_us + 26_000).command.linear_mps > 0.0
    assert robot.core.command_at(robot.now_us + 27_000).command == core.Twist()
    result = robot.step(ranges=False, distance_m=2.0)
    assert (result.command, result.reason) == (core.Twist(), Reason.ranges_not_fresh)


def test_a_stamp_does_not_prove_that_ranges_are_fresh():
    # Ten rings arrived at once, with stamps as if they came one by one: their arrival counts.
    robot = Robot()
    robot.steps(5, distance_m=2.0)
    arrived_us = robot.now_us
    for k in range(10):
        assert robot.core.set_ranges(ring(arrived_us + (k + 1) * FRAME_US), arrived_us)
    results = robot.steps(9, ranges=False, distance_m=2.0)
    # 0.15 s are four frames.
    assert [result.reason for result in results] == [Reason.none] * 4 + [Reason.ranges_not_fresh] * 5


@pytest.mark.parametrize(
    "scan",
    [
        ring(6_000_000),  # 0.8 s ahead of the last frame: another clock
        ring(5_000_000),  # not later than the one before
        core.RangeScan(utime=5_210_000, first_rad=0.0, step_rad=0.1, ranges_m=[]),
        core.RangeScan(utime=5_210_000, first_rad=0.0, step_rad=0.1, ranges_m=[math.nan]),
        core.RangeScan(utime=5_210_000, first_rad=math.inf, step_rad=0.1, ranges_m=[1.0]),
    ],
)
def test_a_scan_that_cannot_be_used_is_refused(scan):
    robot = Robot()
    robot.steps(6)
    assert not robot.core.set_ranges(scan, robot.now_us + 1000)


def test_it_stands_before_what_is_right_ahead():
    # Radius 0.25 and margin 0.05 m: at 0.31 m, half a degree to the side, there is 1 cm. v H + v^2 / 2a fits for
    # v = sqrt(0.1^2 + 2 * 0.01) - 0.1 = 0.0732.
    robot = Robot()
    results = robot.steps(6, surfaces=[(AHEAD_RAD, 0.31), (-AHEAD_RAD, 0.31)], distance_m=2.0)
    assert all(result.command.linear_mps < 0.0735 for result in results)
    results = robot.steps(6, surfaces=[(AHEAD_RAD, 0.28), (-AHEAD_RAD, 0.28)], distance_m=2.0)
    assert results[-1].command.linear_mps == 0.0
    assert (results[-1].status, results[-1].reason) == (Status.tracking, Reason.obstacle_in_path)


def test_it_does_not_drive_where_no_sensor_looks():
    # The sensors ahead give no reading at all.
    robot = Robot()
    for _ in range(8):
        robot.now_us += FRAME_US
        scan = ring(robot.now_us)
        ranges = scan.ranges_m
        ranges[10:14] = [-1.0] * 4
        scan = core.RangeScan(utime=robot.now_us, first_rad=scan.first_rad, step_rad=scan.step_rad, ranges_m=ranges)
        assert robot.core.set_ranges(scan, robot.now_us)
        result = robot.core.step_observation(robot.now_us, leader_at(robot.now_us, distance_m=2.0), robot.now_us)
    assert result.command.linear_mps == 0.0


def test_an_obstacle_ahead_on_one_side_is_passed_on_the_other():
    for side in (-1.0, 1.0):
        robot = Robot()
        robot.core.set_setpoint(core.Setpoint(distance_m=1.1, bearing_rad=0.0))
        result = robot.steps(10, surfaces=[(side * math.radians(8.0), 0.7)], bearing_rad=0.0)[-1]
        assert side * result.control.avoidance.bearing_shift_rad < math.radians(-3.0)
        assert side * result.command.angular_radps < 0.0


def test_a_mirrored_world_gives_the_mirrored_command():
    random = np.random.default_rng(4)
    config = settings()
    config.camera = coordinator.load_calibration(shipped.path("calibrations/ideal_640x480.yaml"))  # centred
    for _ in range(20):
        surfaces = [(random.uniform(-1.5, 1.5), random.uniform(0.4, 1.5)) for _ in range(3)]
        bearing_rad, heading_rad = random.uniform(-0.2, 0.2, 2)
        commands = []
        for side in (1.0, -1.0):
            robot = Robot(config)
            robot.core.set_setpoint(core.Setpoint(distance_m=1.1, bearing_rad=side * 0.1))
            mirrored = [(side * direction_rad, range_m) for direction_rad, range_m in surfaces]
            how = {"bearing_rad": side * bearing_rad, "heading_rad": side * heading_rad, "distance_m": 1.4}
            commands.append(robot.steps(8, surfaces=mirrored, **how)[-1].command)
        assert commands[0].linear_mps == pytest.approx(commands[1].linear_mps, abs=1e-6)
        assert commands[0].angular_radps == pytest.approx(-commands[1].angular_radps, abs=1e-6)


def test_the_leader_is_no_obstacle_to_be_passed():
    # It stands 1.1 m ahead, and the sonars read its outline at 0.85 m.
    robot = Robot()
    robot.core.set_setpoint(core.Setpoint(distance_m=1.1, bearing_rad=0.0))
    surfaces = [(math.radians(angle), 0.85) for angle in (-8.0, 8.0)]
    result = robot.steps(10, surfaces=surfaces, bearing_rad=0.0)[-1]
    assert result.control.avoidance.bearing_shift_rad == 0.0


def test_the_leader_is_kept_in_the_picture_whatever_the_ranges_show():
    random = np.random.default_rng(5)
    robot = Robot()
    for _ in range(200):
        surfaces = [(random.uniform(-3.1, 3.1), random.uniform(0.3, 2.0)) for _ in range(6)]
        result = robot.step(surfaces=surfaces, bearing_rad=random.uniform(-0.3, 0.3), heading_rad=random.uniform(-1, 1))
        assert abs(result.control.setpoint.bearing_rad) < VIEW_RAD
        assert math.isfinite(result.command.linear_mps)
        assert math.isfinite(result.command.angular_radps)


def test_the_speed_never_exceeds_what_the_way_straight_ahead_allows():
    # A point within the width of the robot, ahead at x: its way is x - sqrt(r^2 - y^2), and v H + v^2 / 2a has to fit,
    # whatever else is around; lag and latency only take more.
    limits, radius_m = settings().control.limits, 0.30
    hold_s, a = 0.1, limits.max_linear_acceleration_mps2
    random = np.random.default_rng(6)
    for _ in range(20):
        robot = Robot()
        x_m, y_m = random.uniform(0.4, 0.9), random.uniform(-0.2, 0.2)
        range_m, direction_rad = math.hypot(x_m, y_m), math.atan2(y_m, x_m)
        way_m = x_m - math.sqrt(radius_m**2 - y_m**2)
        result = robot.step(surfaces=[(direction_rad, range_m)], distance_m=3.0)
        for _ in range(6):  # it does not move in this test, so the ranges stay as they are
            result = robot.step(surfaces=[(direction_rad, range_m)], distance_m=3.0)
        v = result.command.linear_mps
        assert v * hold_s + v * v / (2.0 * a) <= max(way_m, 0.0) + 1e-6


def test_its_memory_holds_all_that_ranges_left_behind():
    surfaces = [(math.radians(10.0), 0.6)]
    one = Robot()
    one.steps(7, surfaces=surfaces)
    other = Robot()
    other.core.memory, other.now_us = one.core.memory, one.now_us
    for result, again in zip(one.steps(6, surfaces=surfaces), other.steps(6, surfaces=surfaces), strict=True):
        assert result.command == again.command
    assert one.core.memory == other.core.memory


def test_the_rules_in_the_file_are_those_that_are_built_in():
    shown, built_in = fuzzy.load_controller(shipped.path("fuzzy/avoidance.yaml")), control.avoidance_rules()
    for e in np.linspace(-1.0, 1.0, 21):
        for ec in np.linspace(-1.0, 1.0, 21):
            assert fuzzy.infer(shown, e, ec).output == fuzzy.infer(built_in, e, ec).output


def test_a_far_obstacle_changes_nothing_and_a_near_one_turns_to_the_free_side():
    rules = control.avoidance_rules()
    for e in np.linspace(-1.0, 1.0, 41):
        # ZE alone, whose centroid is 0.
        assert fuzzy.infer(rules, e, -1.0).output == pytest.approx(0.0, abs=1e-12)
        near = [fuzzy.infer(rules, e, ec).output for ec in (0.0, 0.5, 1.0)]
        if abs(e) > 0.06:  # beyond the overlap of NZ and PZ
            assert all(math.copysign(1.0, e) * u > 0.0 for u in near)
            assert abs(near[2]) >= abs(near[0]) - 0.05

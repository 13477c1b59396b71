"""Predetermined trajectories against their geometry; and all of them against their own derivative."""

import itertools
import math

import numpy as np
import pytest

from pilotfish import sim

START = sim.Pose2(x_m=1.0, y_m=-2.0, heading_rad=0.7)
PROFILE = sim.SpeedProfile(speed_mps=0.2, acceleration_mps2=0.5)
SQUARE = sim.Waypoints(speed_mps=0.4, acceleration_mps2=0.8, turn_rate_radps=0.5, turn_acceleration_radps2=1.0)
SQUARE.points = [
    sim.Waypoint(x_m=1.0, y_m=0.0, pause_s=1.0),
    sim.Waypoint(x_m=1.0, y_m=1.0, pause_s=0.5),
    sim.Waypoint(x_m=0.0, y_m=1.0),
    sim.Waypoint(x_m=0.0, y_m=0.0),
]
TRAJECTORIES = {
    "still": sim.Still(),
    "line": sim.Line(PROFILE),
    "line backwards": sim.Line(sim.SpeedProfile(speed_mps=-0.3, start_time_s=1.0, stop_time_s=4.0)),
    "circle": sim.Circle(radius_m=1.0, profile=PROFILE),
    "circle clockwise": sim.Circle(radius_m=0.5, clockwise=True, profile=PROFILE),
    "figure of eight": sim.FigureEight(half_length_m=0.6, half_width_m=0.4, profile=PROFILE),
    "square": SQUARE,
}


def distance(a, b):
    return math.hypot(a.x_m - b.x_m, a.y_m - b.y_m)


@pytest.mark.parametrize("trajectory", TRAJECTORIES.values(), ids=TRAJECTORIES)
def test_it_begins_at_the_start_and_at_rest(trajectory):
    state = sim.state_at(trajectory, START, 0.0)
    assert distance(state.pose, START) < 1e-12
    assert state.pose.heading_rad == pytest.approx(0.7)
    assert (state.twist.linear_mps, state.twist.angular_radps) == (0.0, 0.0)


@pytest.mark.parametrize("trajectory", TRAJECTORIES.values(), ids=TRAJECTORIES)
def test_the_pose_moves_as_the_twist_says(trajectory):
    # A unicycle: (dx, dy) = v (cos, sin)(heading) dt, dheading = w dt, here by central differences. Where a ramp
    # has its knee the acceleration jumps (by 1 m/s2 at most), which costs a step of 0.1 ms at most 5e-5.
    step_s = 1e-4
    for time_s in np.linspace(0.05, 30, 400):
        before, here, after = (sim.state_at(trajectory, START, time_s + k * step_s) for k in (-1, 0, 1))
        heading, v = here.pose.heading_rad, here.twist.linear_mps
        velocity = (
            (after.pose.x_m - before.pose.x_m) / (2 * step_s),
            (after.pose.y_m - before.pose.y_m) / (2 * step_s),
        )
        assert velocity == pytest.approx((v * math.cos(heading), v * math.sin(heading)), abs=6e-5)
        turned = math.remainder(after.pose.heading_rad - before.pose.heading_rad, 2 * math.pi)
        assert turned / (2 * step_s) == pytest.approx(here.twist.angular_radps, abs=6e-5)


def test_a_ramp_covers_what_the_closed_form_says():
    # Up to 0.2 m/s in 0.4 s and 0.04 m; 0.2 * 4.6 = 0.92 m until 5 s; down again in 0.04 m.
    line = sim.Line(sim.SpeedProfile(speed_mps=0.2, acceleration_mps2=0.5, stop_time_s=5.0))
    assert sim.state_at(line, sim.Pose2(), 0.2).pose.x_m == pytest.approx(0.01)
    assert sim.state_at(line, sim.Pose2(), 5.0).pose.x_m == pytest.approx(0.96)
    at_rest = sim.state_at(line, sim.Pose2(), 5.4)
    assert at_rest.pose.x_m == pytest.approx(1.0)
    assert at_rest.twist.linear_mps == pytest.approx(0.0, abs=1e-12)
    assert sim.state_at(line, sim.Pose2(), 100.0).pose.x_m == pytest.approx(1.0)


def test_a_stop_before_the_top_speed_brakes_from_what_was_reached():
    # 0.1 m/s after 0.2 s: 0.01 m up, 0.01 m down.
    line = sim.Line(sim.SpeedProfile(speed_mps=0.2, acceleration_mps2=0.5, stop_time_s=0.2))
    assert sim.state_at(line, sim.Pose2(), 9.0).pose.x_m == pytest.approx(0.02)


@pytest.mark.parametrize("clockwise", [False, True])
def test_the_circle_keeps_its_radius_and_closes(clockwise):
    circle = sim.Circle(radius_m=1.5, clockwise=clockwise, profile=PROFILE)
    side = -1.0 if clockwise else 1.0
    centre = (START.x_m - side * 1.5 * math.sin(0.7), START.y_m + side * 1.5 * math.cos(0.7))
    for time_s in np.linspace(0, 60, 50):
        pose = sim.state_at(circle, START, time_s).pose
        assert math.hypot(pose.x_m - centre[0], pose.y_m - centre[1]) == pytest.approx(1.5, abs=1e-12)
    # One lap is 3 pi m; the ramp costs 0.2 s.
    lap_s = 3 * math.pi / 0.2 + 0.2
    assert distance(sim.state_at(circle, START, lap_s).pose, START) < 1e-9


def test_the_figure_of_eight_crosses_itself_at_the_start_and_closes():
    eight = sim.FigureEight(half_length_m=2.0, half_width_m=1.5, profile=PROFILE)
    half_lap_s, lap_s = eight.lap_length_m / 0.4 + 0.2, eight.lap_length_m / 0.2 + 0.2
    crossing, end = (sim.state_at(eight, START, time_s) for time_s in (half_lap_s, lap_s))
    assert distance(crossing.pose, START) < 1e-9
    assert distance(end.pose, START) < 1e-9
    assert end.pose.heading_rad == pytest.approx(0.7)
    # It leaves along (a, b) and comes back through the crossing along (-a, b): between them 2 atan(a / b).
    turned = math.remainder(crossing.pose.heading_rad - 0.7, 2 * math.pi)
    assert abs(turned) == pytest.approx(2 * math.atan2(2.0, 1.5))


def test_the_figure_of_eight_has_constant_speed_and_both_lobes():
    eight = sim.FigureEight(half_length_m=2.0, half_width_m=1.5, profile=PROFILE)
    states = [sim.state_at(eight, sim.Pose2(), time_s) for time_s in np.linspace(1, 60, 2000)]
    assert {round(state.twist.linear_mps, 12) for state in states} == {0.2}
    turn_rates = [state.twist.angular_radps for state in states]
    assert min(turn_rates) == pytest.approx(-max(turn_rates), rel=1e-3)


def test_the_length_of_a_lap_is_that_of_a_fine_polygon():
    eight = sim.FigureEight(half_length_m=2.0, half_width_m=1.5)
    p = np.linspace(0, 2 * np.pi, 200_001)
    polygon = np.hypot(np.diff(2 * np.sin(p)), np.diff(1.5 * np.sin(p) * np.cos(p))).sum()
    assert eight.lap_length_m == pytest.approx(polygon, rel=1e-9)


def test_waypoints_are_reached_at_rest_in_order_and_waited_at():
    # A metre at 0.4 m/s and 0.8 m/s2 takes 1 / 0.4 + 0.4 / 0.8 = 3 s; a right angle at 0.5 rad/s and 1 rad/s2
    # takes (pi / 2) / 0.5 + 0.5 = 3.6416 s.
    drive_s, turn_s = 3.0, math.pi + 0.5
    at_first = sim.state_at(SQUARE, sim.Pose2(), drive_s + 0.5)
    assert (at_first.pose.x_m, at_first.pose.y_m) == pytest.approx((1.0, 0.0))
    assert at_first.twist.linear_mps == 0.0
    turning = sim.state_at(SQUARE, sim.Pose2(), drive_s + 1.0 + turn_s / 2)
    assert (turning.twist.linear_mps, turning.twist.angular_radps) == (0.0, pytest.approx(0.5))
    assert turning.pose.heading_rad == pytest.approx(math.pi / 4)
    at_second = sim.state_at(SQUARE, sim.Pose2(), 2 * drive_s + 1.0 + turn_s + 0.25)
    assert (at_second.pose.x_m, at_second.pose.y_m) == pytest.approx((1.0, 1.0))
    end = sim.state_at(SQUARE, sim.Pose2(), 1000.0)
    assert (end.pose.x_m, end.pose.y_m) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_repeated_waypoints_go_round_and_round():
    again = sim.Waypoints(repeat=True, speed_mps=0.4, acceleration_mps2=0.8)
    again.points = SQUARE.points
    positions = [sim.state_at(again, sim.Pose2(), time_s).pose for time_s in np.linspace(0, 200, 800)]
    visits = sum(
        distance(a, sim.Pose2(x_m=1, y_m=1)) >= 0.05 > distance(b, sim.Pose2(x_m=1, y_m=1))
        for a, b in itertools.pairwise(positions)
    )
    assert visits > 3


def test_a_way_with_no_length_ends_instead_of_going_on_for_ever():
    nowhere = sim.Waypoints(repeat=True)
    nowhere.points = [sim.Waypoint(x_m=0.0, y_m=0.0)]
    assert distance(sim.state_at(nowhere, START, 10.0).pose, START) == 0.0

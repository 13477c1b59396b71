"""Clearances and endings of robots among obstacles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pilotfish import data, sim
from pilotfish.among_obstacles import AT_THE_END_S, passages
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.scenario import Scenario

DURATION_S = 6.0


@pytest.fixture(scope="module")
def driven():
    """The wedge with drawn measurements, and the least clearance of each robot that the world itself has measured."""
    scenario = Scenario.load(data.path("scenarios/wedge_obstacles.yaml"))
    least: dict[str, float] = {}

    def look(event):
        for robot in scenario.robots:
            clear_m = event.world.clearance_m(robot.name)
            least[robot.name] = min(clear_m, least.get(robot.name, math.inf))

    drawn = DrawnObservations(sim.load_scenario(scenario.file).seed, occlusion=True)
    run = run_in_process(scenario, profile="anticipate", drawn=drawn, duration_s=DURATION_S, on_frame=look)
    return scenario, run, least


def test_the_least_clearance_is_what_the_world_measured(driven):
    scenario, run, least = driven
    for passage in passages(scenario, run):
        clearance_m = min(passage.obstacle_clearance_m, passage.robot_clearance_m)
        # The recording has a pose a picture, as the world was asked: no interpolation between them.
        assert clearance_m == pytest.approx(least[passage.robot], abs=1e-6)


def test_the_errors_at_the_end_are_means_of_the_last_two_seconds(driven):
    scenario, run, _ = driven
    for passage in passages(scenario, run):
        own = run.recordings[passage.robot]
        late = own.time_s >= own.time_s[-1] - AT_THE_END_S
        # e = d_p - d, positive: too close.
        expected_m = own.meta.distance_setpoint_m - np.mean(own.true_distance_m[late])
        assert passage.final_distance_error_m == pytest.approx(expected_m, abs=1e-12)


def test_without_obstacles_and_companions_clearances_are_infinite_or_to_the_leader(driven):
    scenario = Scenario.load(data.path("scenarios/line.yaml"))
    run = run_in_process(scenario, profile="anticipate", drawn=DrawnObservations(1), duration_s=1.0)
    (passage,) = passages(scenario, run)
    assert passage.obstacle_clearance_m == math.inf
    own = run.recordings["robot1"]
    radii_m = sum(sim.load_scenario(scenario.file).robot(name).radius_m for name in ("robot1", "leader"))
    between_m = np.hypot(own.leader_x_m - own.x_m, own.leader_y_m - own.y_m).min()
    assert passage.robot_clearance_m == pytest.approx(between_m - radii_m, abs=1e-9)

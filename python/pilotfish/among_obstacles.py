"""What a run of several robots among obstacles amounts to: how near they came to anything, and where they were at the
end."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pilotfish import sim
from pilotfish.harness.run import Run
from pilotfish.harness.scenario import Scenario
from pilotfish.metrics import frames_detected_ratio
from pilotfish.recording import FloatArray, Recording

AT_THE_END_S = 2.0


@dataclass(frozen=True)
class Passage:
    """One robot's way. Clearances are from outline to outline (discs of the robots' ``radius_m``); below 0: hit."""

    robot: str
    obstacle_clearance_m: float  # the least; infinite: there are no obstacles
    robot_clearance_m: float  # the least, to any other robot; infinite: it is alone
    final_distance_error_m: float  # mean over the last AT_THE_END_S, true
    final_bearing_error_rad: float
    frames_detected_ratio: float


def passages(scenario: Scenario, run: Run) -> list[Passage]:
    """One a robot that follows, in the order of the scenario, from the true poses at every picture."""
    spec = sim.load_scenario(scenario.file)
    obstacles = spec.all_obstacles()
    radius_m = {robot.name: robot.radius_m for robot in spec.robots}
    places = {name: np.stack([own.x_m, own.y_m]) for name, own in run.recordings.items()}
    for own in run.recordings.values():
        places.setdefault(own.meta.leader, np.stack([own.leader_x_m, own.leader_y_m]))
    found = []
    for name, own in run.recordings.items():
        to_obstacles_m = [
            _least_m(places[name], np.array([[obstacle.x_m], [obstacle.y_m]])) - obstacle.radius_m - radius_m[name]
            for obstacle in obstacles
        ]
        to_robots_m = [
            _least_m(places[name], place) - radius_m[name] - radius_m[other]
            for other, place in places.items()
            if other != name
        ]
        found.append(_passage(own, min(to_obstacles_m, default=math.inf), min(to_robots_m, default=math.inf)))
    return found


def _least_m(own: FloatArray, other: FloatArray) -> float:
    """The least distance; (2, N) and (2, N) or (2, 1)."""
    return float(np.hypot(*(other - own)).min())


def _passage(own: Recording, obstacle_clearance_m: float, robot_clearance_m: float) -> Passage:
    late = own.time_s >= own.time_s[-1] - AT_THE_END_S
    return Passage(
        own.meta.robot,
        obstacle_clearance_m,
        robot_clearance_m,
        float(own.distance_error_m[late].mean()),
        float(own.bearing_error_rad[late].mean()),
        frames_detected_ratio(own),
    )

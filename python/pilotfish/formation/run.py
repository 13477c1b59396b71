"""Plays a formation, with its changes of shape: in this process with rendered or drawn measurements, or over LCM with
the real programs."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish import coordinator, core, sim
from pilotfish.errors import HarnessError
from pilotfish.formation.drawn_world import without_pictures
from pilotfish.formation.expand import load_expanded
from pilotfish.formation.file import Formation
from pilotfish.formation.sight import Outlook, Pose, seen_from, sees
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.run import OnProgress, Run
from pilotfish.recording import FloatArray, Recording

TRANSPORTS = ("drawn", "in-process", "lcm")


@dataclass(frozen=True)
class FormationRun:
    """What a formation did. By robot that follows: its recording, and the setpoint in force at each of its N rows."""

    formation: Formation
    law: str
    recordings: Mapping[str, Recording]
    distance_setpoint_m: Mapping[str, FloatArray]  # (N,) each
    bearing_setpoint_rad: Mapping[str, FloatArray]  # (N,) each
    # Since when [s] it has followed whom.
    followed: Mapping[str, Sequence[tuple[float, str]]] = field(default_factory=dict)


def play(
    formation: Formation,
    *,
    law: str = "anticipate",
    transport: str = "drawn",
    duration_s: float | None = None,
    on_progress: OnProgress | None = None,
) -> FormationRun:
    """Plays the formation from its first place to its last shape. ``transport``: "drawn" (no pictures: measurements are
    drawn, and a leader outside the picture or behind another robot is not seen), "in-process" (rendered pictures),
    "lcm" (the real programs; setpoints are changed by messages). ValueError for another one."""
    if transport not in TRANSPORTS:
        raise ValueError(f"transport '{transport}' is not one of {', '.join(TRANSPORTS)}")
    with tempfile.TemporaryDirectory(prefix="pilotfish-") as folder:
        scenario = load_expanded(formation, Path(folder))
        if transport == "lcm":
            from pilotfish.formation.over_lcm import run_with_messages

            run, asked = run_with_messages(formation, scenario, law, duration_s, on_progress)
        else:
            feed = SetpointFeed(formation)
            how: dict[str, Any] = {"feed": feed, "duration_s": duration_s, "on_progress": on_progress}
            if transport == "drawn":
                how["drawn"] = FormationSight(formation.seed, outlook=formation.outlook, others=_others(formation))
                how["spec"] = without_pictures(sim.load_scenario(scenario.file))
            run, asked = run_in_process(scenario, profile=law, **how), feed.asked
    return _with_setpoints(formation, law, run, asked)


def _others(formation: Formation) -> dict[str, list[str]]:
    return {robot: [watch.leader for watch in watches] for robot, watches in formation.otherwise.watches.items()}


def setpoint_at(formation: Formation, robot: str, time_s: float) -> core.Setpoint:
    """What the robot is to keep at a time: that of the last stage that has begun, approached in a straight line of
    (d, theta) for ``over_s`` from that of the stage before."""
    now = formation.stages[0].watches[robot]
    distance_m, bearing_rad = now.distance_m, now.bearing_rad
    for stage in formation.stages[1:]:
        if time_s < stage.at_s - 1e-9:
            break
        share = 1.0 if stage.over_s == 0.0 else min(1.0, (time_s - stage.at_s) / stage.over_s)
        goal = stage.watches[robot]
        distance_m += share * (goal.distance_m - distance_m)
        bearing_rad += share * (goal.bearing_rad - bearing_rad)
    return core.Setpoint(distance_m=distance_m, bearing_rad=bearing_rad)


Asked = dict[str, list[tuple[float, core.Setpoint]]]  # by robot: since when [s] what was asked


class SetpointFeed:
    """Sets the setpoints of the coordinators of a run in this process (``feed`` of run_in_process)."""

    def __init__(self, formation: Formation) -> None:
        self.formation = formation
        self.asked: Asked = {robot: [] for robot in formation.leaders}

    def __call__(self, world: sim.World, robot: str, driver: coordinator.Coordinator) -> None:
        setpoint = setpoint_at(self.formation, robot, world.time_s)
        if self.asked[robot] and same(self.asked[robot][-1][1], setpoint):
            return
        if not driver.set_setpoint(setpoint):
            raise HarnessError(f"{robot} refuses {setpoint.distance_m:.2f} m")
        self.asked[robot].append((world.time_s, setpoint))


def same(a: core.Setpoint, b: core.Setpoint) -> bool:
    """Whether both ask for the same place."""
    return a.distance_m == b.distance_m and a.bearing_rad == b.bearing_rad


class FormationSight(DrawnObservations):
    """Drawn measurements of robots that can hide each other: nothing unless a whole tag is in sight (sight.py)."""

    def __init__(
        self, seed: int, *, outlook: Outlook, others: Mapping[str, Sequence[str]] | None = None, **how: float
    ) -> None:
        super().__init__(seed, half_view_rad=math.pi, **how)
        self.outlook = outlook
        self.others = others or {}  # by robot: whom it follows while its leader is lost
        self._visibility: dict[str, sim.Visibility] = {}
        self._utime = -1
        self._leaders: dict[str, str] = {}
        self._now: dict[str, Pose] = {}

    def answer(self, world: sim.World, robot: str, driver: coordinator.Coordinator) -> coordinator.StepResult:
        """As DrawnObservations.answer, of its leader and of everybody whom it follows otherwise."""
        others = self.others.get(robot, ())
        if not others:
            return super().answer(world, robot, driver)
        seen = [self.look(world, robot), *(self._look_at(world, robot, other) for other in others)]
        return driver.step_observations(world.utime, seen, world.utime)

    def _look_at(self, world: sim.World, robot: str, other: str) -> core.Observation | None:
        """What ``robot`` sees of ``other``, which the scenario does not let it follow."""
        poses = self._poses(world)
        x_m, y_m, heading_rad = there = seen_from(poses[robot], poses[other])
        distance_m = math.hypot(x_m, y_m)
        covariance = self.noise.covariance(distance_m)
        errors = self.scale * self._random.standard_normal(3) * np.sqrt(covariance.diagonal())
        hiding = [seen_from(poses[robot], pose) for name, pose in poses.items() if name not in (robot, other)]
        hidden = self._visibility[other]
        if hidden.hidden_from_s <= world.time_s < hidden.hidden_until_s or not sees(self.outlook, there, hiding):
            return None
        return core.Observation(
            utime=world.utime,
            distance_m=distance_m + errors[0],
            bearing_rad=math.atan2(y_m, x_m) + errors[1],
            heading_rad=math.remainder(heading_rad, 2.0 * math.pi) + errors[2],
            covariance=covariance,
        )

    def look(self, world: sim.World, robot: str) -> core.Observation | None:
        """As DrawnObservations.look."""
        seen = super().look(world, robot)
        if seen is None:
            return None
        poses = self._poses(world)
        leader = self._leaders[robot]
        others = [seen_from(poses[robot], pose) for name, pose in poses.items() if name not in (robot, leader)]
        return seen if sees(self.outlook, seen_from(poses[robot], poses[leader]), others) else None

    def _poses(self, world: sim.World) -> dict[str, Pose]:
        """Of all robots now; asked for once a picture, not once a robot."""
        if self._utime != world.utime:
            if not self._leaders:  # the scenario is a copy of all bodies and cameras: read once
                robots = world.scenario.robots
                self._leaders = {spec.name: spec.follows for spec in robots}
                self._visibility = {spec.name: spec.visibility for spec in robots}
            self._utime = world.utime
            self._now = {name: pose_of(world, name) for name in self._leaders}
        return self._now


def pose_of(world: sim.World, robot: str) -> Pose:
    """Where a robot is, in the world frame."""
    pose = world.state(robot).pose
    return pose.x_m, pose.y_m, pose.heading_rad


def _with_setpoints(formation: Formation, law: str, run: Run, asked: Asked) -> FormationRun:
    distance, bearing = {}, {}
    for robot, recording in run.recordings.items():
        since_s = np.array([time_s for time_s, _ in asked[robot]])
        which = np.maximum(0, np.searchsorted(since_s, recording.time_s + 1e-9, side="right") - 1)
        distance[robot] = np.array([setpoint.distance_m for _, setpoint in asked[robot]])[which]
        bearing[robot] = np.array([setpoint.bearing_rad for _, setpoint in asked[robot]])[which]
    return FormationRun(formation, law, run.recordings, distance, bearing, _followed(formation, run))


def _followed(formation: Formation, run: Run) -> dict[str, list[tuple[float, str]]]:
    others = _others(formation)
    followed = {robot: [(0.0, leader)] for robot, leader in formation.leaders.items()}
    for robot, since in followed.items():
        names = [since[0][1], *others.get(robot, ())]
        for report in run.reports[robot]:
            if (leader := names[report.leader_index]) != since[-1][1]:
                since.append(((report.utime - sim.START_UTIME) * 1e-6, leader))
    return followed

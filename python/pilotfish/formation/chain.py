"""A chain of robots behind a leader whose speed is any function of time. Measurements are drawn, nothing is rendered.

A robot of a chain looks only ahead, so the first k robots of a chain do not know whether others follow: a run with
twelve robots contains every chain of two to twelve.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish import coordinator, core, sim
from pilotfish.formation.drawn_world import without_pictures
from pilotfish.formation.expand import load_expanded
from pilotfish.formation.file import Formation, read_formation
from pilotfish.formation.relay import Announcements, Network, listening
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.driving import Driving
from pilotfish.harness.run import OnProgress
from pilotfish.recording import FloatArray

SUB_STEPS = 8  # commands of the leader in one period of the camera: its speed is a staircase of that many steps
SpeedOf = Callable[[float], float]  # time [s] -> speed [m/s]


@dataclass(frozen=True)
class ChainRun:
    """A chain of R robots, N pictures: row 0 is the leader. ``spacing_error_m`` e = d_p + h v - d, with the own speed v
    and the time headway h, shape (R - 1, N); positive: too close."""

    time_s: FloatArray  # (N,)
    speed_mps: FloatArray  # (R, N), true
    spacing_error_m: FloatArray  # (R - 1, N), true
    seen_ratio: FloatArray  # (R - 1,): share of the pictures in which the robot saw its leader


def chain_of(robots: int, spacing_m: float, content: Mapping[str, Any] | None = None) -> Formation:
    """The chain as a Formation; ``content``: more keys of a formation file, such as ``coordinator``."""
    shape = {"name": "chain", "shape": "chain", "robots": robots, "spacing_m": spacing_m}
    return read_formation({**shape, **(content or {})}, Path("chain.yaml"))


def drive_chain(
    formation: Formation,
    law: str,
    leader_speed: SpeedOf,
    duration_s: float,
    *,
    headway_s: float = 0.0,
    intents: Network | None = None,
    seed: int = 1,
    on_progress: OnProgress | None = None,
) -> ChainRun:
    """Drives it straight ahead. ``law`` as in Driving. The leader's drive is ideal: it has the speed it is told.
    ``intents``: every robot, and the leader as long before, announces what it is about to drive, over that network, and
    feeds forward what it hears (control.leader_intent.feed_forward); None: nothing is said."""
    with tempfile.TemporaryDirectory(prefix="pilotfish-") as folder:
        scenario = load_expanded(formation, Path(folder))
        configs = [coordinator.load_coordinator(robot.coordinator_file).coordinator for robot in scenario.robots]
        spec = without_pictures(with_free_leader(sim.load_scenario(scenario.file)))
    if intents:
        for config in configs:
            listening(config)
    drivers = [_driver(config, law, headway_s) for config in configs]
    spoken = [Announcements(intents, seed * 1000 + k) for k in range(len(drivers) + 1)] if intents else []
    world, drawn = sim.World(spec), DrawnObservations(seed)
    names, period_s = formation.robots, 1.0 / formation.frame_rate_hz
    frames = scenario.frame_count(duration_s)
    speed_mps, error_m = np.empty((len(names), frames)), np.empty((len(names) - 1, frames))
    seen = np.zeros(len(names) - 1)
    latency_s = [world.latency_s(name) for name in names[1:]]
    distance_m = [robot.setpoint.distance_m for robot in scenario.robots]
    ahead_s = latency_s[0] + configs[0].control.drive.actuator_lag_s  # of the leader's announcements
    for index in range(frames):
        time_s = index * period_s
        world.advance_to(time_s)
        for step in range(SUB_STEPS):  # the speed in the middle of each piece
            middle_s = time_s + (step + 0.5) / SUB_STEPS * period_s
            twist = core.Twist(linear_mps=leader_speed(middle_s), angular_radps=0.0)
            world.command(names[0], twist, time_s + step / SUB_STEPS * period_s)
        if intents:
            plan = core.Twist(linear_mps=leader_speed(time_s + ahead_s), angular_radps=0.0)
            spoken[0].send(time_s, world.utime + round(1e6 * ahead_s), plan)
        speed_mps[:, index] = [world.state(name).twist.linear_mps for name in names]
        for k, (name, driver) in enumerate(zip(names[1:], drivers, strict=True)):
            if intents:
                spoken[k].deliver(time_s, driver)
            answer = drawn.answer(world, name, driver)
            if intents and answer.control:
                spoken[k + 1].send(time_s, answer.control.effect_utime, answer.command)
            world.command(name, answer.command, time_s + latency_s[k])
            true_distance_m, _, _ = world.true_relative_pose(name)
            error_m[k, index] = distance_m[k] + headway_s * speed_mps[k + 1, index] - true_distance_m
            seen[k] += answer.observation is not None
        if on_progress:
            on_progress(index + 1, frames)
    speed_mps[0] = [leader_speed(index * period_s) for index in range(frames)]
    return ChainRun(np.arange(frames) * period_s, speed_mps, error_m, seen / frames)


def with_free_leader(spec: sim.Scenario) -> sim.Scenario:
    """The scenario with a leader that executes commands at once instead of driving a trajectory."""
    robots = spec.robots
    leader = robots[0]
    leader.trajectory = None
    drive = leader.drive
    drive.max_linear_mps, drive.max_linear_acceleration_mps2, drive.actuator_lag_s = 20.0, 1e3, 0.0
    leader.drive = drive
    spec.robots = robots
    return spec


def _driver(config: coordinator.CoordinatorConfig, law: str, headway_s: float) -> coordinator.Coordinator:
    Driving(law).apply(config)
    if headway_s:
        control = config.control
        spacing = control.spacing
        spacing.headway_s = headway_s
        control.spacing = spacing
        config.control = control
    return coordinator.Coordinator(config)

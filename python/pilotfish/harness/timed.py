"""Runs a coordinator against a robot whose time is not ideal: pictures are dropped, come at another rate or late by
varying times, their stamps jitter. Between pictures the command is renewed as the program does it, so a command that
has expired is zero and the wheels slow down.

Measurements are drawn, nothing is rendered: 20 s of driving take a quarter of a second.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pilotfish import coordinator, core, data, sim
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.driving import Driving
from pilotfish.harness.scenario import Scenario

BEAT_S = 0.005  # the command is renewed and the world advances this often
START_US = 1_000_000  # of the monotonic clock


@dataclass(frozen=True)
class Timing:
    """Of the camera, and of what lies between it and the wheels."""

    frame_rate_hz: float = 30.0
    drop_probability: float = 0.0
    latency_s: float = 1.0 / 30.0  # from the exposure until its command is at the wheels
    latency_jitter_s: float = 0.0  # of the picture's arrival: uniform, either way
    stamp_jitter_s: float = 0.0  # standard deviation of what the stamp is off
    transport_s: float = 0.005  # the part of the latency behind the coordinator


@dataclass(frozen=True)
class Wheels:
    """What a real drive does beyond ramp and lag."""

    lag_s: float = 0.1
    gain: float = 1.0  # driven speed / commanded speed
    slip: float = 0.0  # mean part of the speed that is lost
    slip_sigma: float = 0.0  # its standard deviation; it wanders within 0.3 s
    step_mps: float = 0.0  # of the wheels' speed; 0: none
    track_m: float = 0.3  # between the wheels


@dataclass(frozen=True)
class TimedRun:
    """One row per beat; the truth, and what was commanded."""

    time_s: np.ndarray
    distance_m: np.ndarray
    bearing_rad: np.ndarray
    command_mps: np.ndarray
    command_radps: np.ndarray
    setpoint: core.Setpoint

    def distance_error_m(self, from_s: float) -> np.ndarray:
        """d - d_p of the rows from then on; positive: too far."""
        return self.distance_m[self.time_s >= from_s] - self.setpoint.distance_m


Configure = Callable[[coordinator.CoordinatorConfig], None]
OnAnswer = Callable[[float, coordinator.StepResult], None]


def run_timed(
    scenario_name: str,
    *,
    law: str = "anticipate",
    timing: Timing = Timing(),
    wheels: Wheels = Wheels(),
    seed: int = 1,
    duration_s: float | None = None,
    configure: Configure | None = None,
    on_answer: OnAnswer | None = None,
    drawn: DrawnObservations | None = None,
    change: Callable[[sim.Scenario], None] | None = None,
) -> TimedRun:
    """Plays a shipped scenario. ``configure`` is applied last to the coordinator's configuration, which does not
    contain ``timing`` and ``wheels``; ``on_answer`` gets the time [s] and the answer to each picture; ``change`` gets
    the world's scenario."""
    scenario = Scenario.load(data.path(f"scenarios/{scenario_name}.yaml"))
    robot = scenario.robot()
    spec = _with_lag(sim.load_scenario(scenario.file), robot.name, wheels.lag_s)
    if change:
        change(spec)
    world = sim.World(spec)
    driver = coordinator.Coordinator(_config(robot, law, configure))
    pictures = _Pictures(timing, world, robot.name, drawn or DrawnObservations(seed), np.random.default_rng(seed))
    drive = _Drive(wheels, np.random.default_rng(seed + 1))
    rows = []
    for beat in range(int((duration_s or scenario.duration_s) / BEAT_S)):
        time_s = beat * BEAT_S
        world.advance_to(time_s)
        pictures.expose()
        now_us = START_US + int(time_s * 1e6)
        answers = [driver.step_observation(utime, seen, now_us) for utime, seen in pictures.arrived()]
        for answer in answers if on_answer else ():
            on_answer(time_s, answer)
        command = (answers[-1] if answers else driver.command_at(now_us)).command
        world.command(robot.name, drive.driven(command), time_s + timing.transport_s)
        distance_m, bearing_rad, _ = world.true_relative_pose(robot.name)
        rows.append((time_s, distance_m, bearing_rad, command.linear_mps, command.angular_radps))
    return TimedRun(*np.array(rows).T, setpoint=robot.setpoint)


def _with_lag(spec: sim.Scenario, name: str, lag_s: float) -> sim.Scenario:
    robots = spec.robots
    for robot in robots:
        if robot.name == name:
            drive = robot.drive
            drive.actuator_lag_s = lag_s
            robot.drive = drive
    spec.robots = robots
    return spec


def _config(robot, law: str, configure: Configure | None) -> coordinator.CoordinatorConfig:
    config = coordinator.load_coordinator(robot.coordinator_file).coordinator
    Driving(law, None).apply(config)
    config.setpoint = robot.setpoint
    if configure:
        configure(config)
    return config


@dataclass
class _Pictures:
    """Exposed, perhaps dropped, and on their way."""

    timing: Timing
    world: sim.World
    robot: str
    drawn: DrawnObservations
    random: np.random.Generator

    def __post_init__(self) -> None:
        self.exposures, self.last_utime, self.last_arrival_s = 0, 0, 0.0
        self.under_way: list[tuple[float, int, core.Observation | None]] = []

    def expose(self) -> None:
        timing, time_s = self.timing, self.world.time_s
        if time_s + 1e-9 < self.exposures / timing.frame_rate_hz:
            return
        self.exposures += 1
        dropped = self.random.random() < timing.drop_probability
        utime = self.world.utime + int(1e6 * timing.stamp_jitter_s * self.random.standard_normal())
        late_s = timing.latency_s - timing.transport_s + timing.latency_jitter_s * self.random.uniform(-1, 1)
        if dropped or utime <= self.last_utime:
            return
        self.last_utime = utime
        self.last_arrival_s = max(time_s + late_s, self.last_arrival_s)  # none overtakes another
        self.under_way.append((self.last_arrival_s, utime, _stamped(self.drawn.look(self.world, self.robot), utime)))

    def arrived(self) -> list[tuple[int, core.Observation | None]]:
        due = [picture for picture in self.under_way if picture[0] <= self.world.time_s + 1e-9]
        self.under_way = self.under_way[len(due) :]
        return [(utime, seen) for _, utime, seen in due]


def _stamped(seen: core.Observation | None, utime: int) -> core.Observation | None:
    if seen is None:
        return None
    return core.Observation(
        utime=utime,
        distance_m=seen.distance_m,
        bearing_rad=seen.bearing_rad,
        heading_rad=seen.heading_rad,
        covariance=seen.covariance,
    )


@dataclass
class _Drive:
    wheels: Wheels
    random: np.random.Generator
    slip: float = 0.0

    def driven(self, command: core.Twist) -> core.Twist:
        """The twist that the wheels make of a command."""
        wheels, forgets = self.wheels, BEAT_S / 0.3
        self.slip += forgets * (wheels.slip - self.slip)
        self.slip += wheels.slip_sigma * np.sqrt(2.0 * forgets) * self.random.standard_normal()
        half = wheels.track_m / 2.0
        sides = np.array([-half, half]) * command.angular_radps + command.linear_mps
        if wheels.step_mps > 0.0:
            sides = np.round(sides / wheels.step_mps) * wheels.step_mps
        left, right = sides * wheels.gain * (1.0 - self.slip)
        return core.Twist(linear_mps=float(left + right) / 2.0, angular_radps=float(right - left) / wheels.track_m)

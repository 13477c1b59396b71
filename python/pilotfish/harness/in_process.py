"""Runs a scenario in this process: the simulator's world and the coordinators' steps, without programs or a
bus.

The code is the same as on the robot; only the transport is missing. That makes it the place to look into a
run: every frame and every StepResult can be seen through ``on_frame``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pilotfish import coordinator, sim
from pilotfish.core import Frame, Twist
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.driving import Driving
from pilotfish.harness.frame_report import FrameReport
from pilotfish.harness.run import OnProgress, Run, measured
from pilotfish.harness.scenario import FollowingRobot, Scenario
from pilotfish.recording import Meta, Recording


@dataclass(frozen=True)
class FrameEvent:
    """One robot's camera period, as it happens."""

    robot: str
    index: int
    time_s: float
    frame: Frame | None  # None: dropped by the camera, or nothing was rendered
    result: coordinator.StepResult | None  # the answer to the last frame that was not dropped; None before the first
    world: sim.World


OnFrame = Callable[[FrameEvent], None]
Configure = Callable[[coordinator.CoordinatorConfig], None]
Feed = Callable[[sim.World, str, coordinator.Coordinator], None]


def run_in_process(
    scenario: Scenario,
    *,
    profile: str,
    tuning: Path | None = None,
    spec: sim.Scenario | None = None,
    configure: Configure | None = None,
    drawn: DrawnObservations | None = None,
    feed: Feed | None = None,
    duration_s: float | None = None,
    on_progress: OnProgress | None = None,
    on_frame: OnFrame | None = None,
) -> Run:
    """Plays the scenario: at each exposure every robot takes a picture, steps, and gets the command after its
    latency.

    ``profile`` is anything that can drive (see Driving). ``spec`` is another version of the scenario's world: another
    seed, other imperfections. ``configure`` is applied last to each coordinator's configuration. With ``drawn``
    nothing is rendered: measurements are drawn. A robot's range sensors are fed to its coordinator.
    ``feed`` is called before each step, with the robot's name: it
    supplies the coordinator's other inputs, such as odometry.
    """
    world = sim.World(spec if spec is not None else sim.load_scenario(scenario.file))
    driving = Driving(profile, tuning)
    drivers = {robot.name: _coordinator(robot, driving, configure) for robot in scenario.robots}
    ranging = {robot.name for robot in world.scenario.robots if robot.range_sensors is not None}
    answers: dict[str, coordinator.StepResult | None] = dict.fromkeys(drivers)
    rows: dict[str, list[dict[str, Any]]] = {name: [] for name in drivers}
    reports: dict[str, list[FrameReport]] = {name: [] for name in drivers}
    frames = scenario.frame_count(duration_s or scenario.duration_s)
    for index in range(frames):
        time_s = index / scenario.frame_rate_hz
        world.advance_to(time_s)
        for robot in scenario.robots:
            frame = None if drawn else world.capture(robot.name)
            delivered = drawn is not None or frame is not None
            if robot.name in ranging:
                scan = world.ranges(robot.name)
                if scan is not None:
                    drivers[robot.name].set_ranges(scan, world.utime)
            if feed:
                feed(world, robot.name, drivers[robot.name])
            if delivered:  # else there is no answer, and the wheels keep the last command
                driver = drivers[robot.name]
                result = (
                    driver.step(frame, frame.utime) if frame is not None else drawn.answer(world, robot.name, driver)
                )
                world.command(robot.name, result.command, time_s + world.latency_s(robot.name))
                answers[robot.name] = result
                reports[robot.name].append(FrameReport.from_step(result))
            answer = answers[robot.name]
            rows[robot.name].append(_row(world, robot, delivered, answer))
            if on_frame:
                on_frame(FrameEvent(robot.name, index, time_s, frame, answer, world))
        if on_progress:
            on_progress(index + 1, frames)
    recordings = {}
    for robot in scenario.robots:
        run = Recording.from_rows(rows[robot.name], Meta(robot=robot.name, leader=robot.leader))
        run = run.with_measurements(measured(reports[robot.name]))
        recordings[robot.name] = scenario.annotate(run, profile, "in-process")
    return Run(recordings, reports)


def _coordinator(robot: FollowingRobot, driving: Driving, configure: Configure | None) -> coordinator.Coordinator:
    config = coordinator.load_coordinator(robot.coordinator_file).coordinator
    driving.apply(config)
    config.setpoint = robot.setpoint
    if configure:
        configure(config)
    return coordinator.Coordinator(config)


def _row(
    world: sim.World, robot: FollowingRobot, delivered: bool, answer: coordinator.StepResult | None
) -> dict[str, Any]:
    command = answer.command if answer else Twist()
    own, leader = world.state(robot.name), world.state(robot.leader)
    distance_m, bearing_rad, heading_rad = world.true_relative_pose(robot.name)
    return {
        "time_s": world.time_s,
        "utime_us": world.utime,
        "x_m": own.pose.x_m,
        "y_m": own.pose.y_m,
        "heading_rad": own.pose.heading_rad,
        "linear_mps": own.twist.linear_mps,
        "angular_radps": own.twist.angular_radps,
        "leader_x_m": leader.pose.x_m,
        "leader_y_m": leader.pose.y_m,
        "leader_heading_rad": leader.pose.heading_rad,
        "leader_linear_mps": leader.twist.linear_mps,
        "true_distance_m": distance_m,
        "true_bearing_rad": bearing_rad,
        "true_heading_rad": heading_rad,
        "command_linear_mps": command.linear_mps,
        "command_angular_radps": command.angular_radps,
        "status": answer.status.name if answer else "",
        "delivered": delivered,
    }

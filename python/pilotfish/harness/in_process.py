"""Runs a scenario in this process: the simulator's world and the coordinators' steps, without programs or a
bus.

The code is the same as on the robot; only the transport is missing. That makes it the place to look into a
run: every frame and every StepResult can be seen through ``on_frame``.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish import coordinator, sim
from pilotfish.core import CameraModel, Frame, Twist
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.driving import Driving
from pilotfish.harness.frame_report import FrameReport
from pilotfish.harness.run import OnProgress, Run
from pilotfish.harness.scenario import FollowingRobot, Scenario
from pilotfish.recording import COLUMNS, Meta, Recording


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
    reports: bool = True,
    as_configured: bool = False,
) -> Run:
    """Plays the scenario: at each exposure every robot takes a picture, steps, and gets the command after its
    latency.

    ``profile`` is anything that can drive (see Driving); ``as_configured``: the coordinators' files say so already,
    with parameters of their own. ``spec`` is another version of the scenario's world: another seed, other
    imperfections. A robot's range sensors are fed to its coordinator. ``configure`` is applied last to each
    coordinator's configuration. With ``drawn`` nothing is rendered: measurements are drawn. ``feed`` is called before
    each step, with the robot's name: it supplies the coordinator's other inputs, such as odometry. Without ``reports``
    the run has none, which saves a third of the time of a run of drawn measurements.
    """
    spec = spec if spec is not None else sim.load_scenario(scenario.file)
    world = sim.World(_without_pictures(spec) if drawn and not on_frame and not feed else spec)
    driving = None if as_configured else Driving(profile, tuning)
    drivers = {robot.name: _coordinator(robot, driving, configure) for robot in scenario.robots}
    ranging = {robot.name for robot in world.scenario.robots if robot.range_sensors is not None}
    answers: dict[str, coordinator.StepResult | None] = dict.fromkeys(drivers)
    rows: dict[str, list[tuple[Any, ...]]] = {name: [] for name in drivers}
    reported: dict[str, list[FrameReport]] = {name: [] for name in drivers}
    frames = scenario.frame_count(duration_s or scenario.duration_s)
    for index in range(frames):
        time_s = index / scenario.frame_rate_hz
        world.advance_to(time_s)
        for robot in scenario.robots:
            frame = None if drawn else world.capture(robot.name)
            delivered = drawn.delivers() if drawn else frame is not None
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
                if reports:
                    reported[robot.name].append(FrameReport.from_step(result))
            answer = answers[robot.name]
            rows[robot.name].append(_row(world, robot, delivered, answer))
            if on_frame:
                on_frame(FrameEvent(robot.name, index, time_s, frame, answer, world))
        if on_progress:
            on_progress(index + 1, frames)
    recordings = {}
    for robot in scenario.robots:
        run = _recording(rows[robot.name], Meta(robot=robot.name, leader=robot.leader))
        recordings[robot.name] = scenario.annotate(run, profile, "in-process")
    return Run(recordings, reported)


def _coordinator(
    robot: FollowingRobot, driving: Driving | None, configure: Configure | None
) -> coordinator.Coordinator:
    config = coordinator.load_coordinator(robot.coordinator_file).coordinator
    if driving:
        driving.apply(config)
    config.setpoint = robot.setpoint
    if configure:
        configure(config)
    return coordinator.Coordinator(config)


# A robot that follows needs a camera; this one is as small as a picture can be.
_NO_PICTURES = CameraModel(width=32, height=24, fx=30.0, fy=30.0, cx=15.5, cy=11.5)


def _without_pictures(spec: sim.Scenario) -> sim.Scenario:
    """The same world with tiny pictures: a renderer of 640 x 480 takes as long to make as 20 s take to drive."""
    robots = spec.robots
    for robot in robots:
        if camera := robot.camera:
            camera.model = _NO_PICTURES
            robot.camera = camera
    small = copy.copy(spec)
    small.robots = robots
    return small


def _row(
    world: sim.World, robot: FollowingRobot, delivered: bool, answer: coordinator.StepResult | None
) -> tuple[Any, ...]:
    """In the order of recording.COLUMNS."""
    command = answer.command if answer else Twist()
    own, leader = world.state(robot.name), world.state(robot.leader)
    pose, leader_pose, utime = own.pose, leader.pose, world.utime
    seen = answer.observation if answer and answer.utime == utime else None
    return (
        world.time_s,
        utime,
        pose.x_m,
        pose.y_m,
        pose.heading_rad,
        own.twist.linear_mps,
        own.twist.angular_radps,
        leader_pose.x_m,
        leader_pose.y_m,
        leader_pose.heading_rad,
        leader.twist.linear_mps,
        *world.true_relative_pose(robot.name),
        command.linear_mps,
        command.angular_radps,
        answer.status.name if answer else "",
        delivered,
        *((seen.distance_m, seen.bearing_rad, seen.heading_rad) if seen else (np.nan, np.nan, np.nan)),
    )


def _recording(rows: list[tuple[Any, ...]], meta: Meta) -> Recording:
    types = {"utime_us": np.int64, "status": np.str_, "delivered": np.bool_}
    columns = zip(COLUMNS, zip(*rows, strict=True), strict=True)
    return Recording(meta, **{name: np.array(values, dtype=types.get(name, np.float64)) for name, values in columns})

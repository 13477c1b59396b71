"""Plays a scenario with a law: with the rendered camera, or with one imperfection switched off."""

from __future__ import annotations

from collections.abc import Callable

from pilotfish import data, sim
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.run import OnProgress
from pilotfish.harness.scenario import Scenario
from pilotfish.recording import Recording

Change = Callable[[sim.RobotSpec], None]  # of the robot that follows


def play(
    which: str,
    law: str,
    seed: int,
    *,
    change: Change | None = None,
    noise: float | None = None,
    delays: tuple[float, float] | None = None,
    hardware: str | None = None,
    on_progress: OnProgress | None = None,
) -> Recording:
    """One run: the fuzzy law with what it ships with, a baseline with what `pilotfish tune` found. `noise`: drawn
    measurements with so much of the usual noise instead of rendered pictures. `delays`: (latency_s, actuator_lag_s) of
    the robot, also in its coordinator's configuration. `hardware`: a file of data/hardware, which is not."""
    scenario = Scenario.load(data.path(f"scenarios/{which}.yaml"))
    spec = sim.load_scenario(scenario.file)
    spec.seed = seed
    if hardware:
        spec = sim.with_hardware(spec, data.path(f"hardware/{hardware}.yaml"))
    robots = spec.robots
    for robot in robots:
        if robot.name == scenario.robot().name:
            if delays:
                camera, drive = robot.camera, robot.drive
                camera.latency_s, drive.actuator_lag_s = delays
                robot.camera, robot.drive = camera, drive
            if change:
                change(robot)
    spec.robots = robots

    def configure(config) -> None:
        if delays:
            config.control.drive.latency_s, config.control.drive.actuator_lag_s = delays
        limits, drive = config.control.limits, spec.robot(scenario.robot().name).drive
        limits.max_linear_acceleration_mps2 = drive.max_linear_acceleration_mps2

    run = run_in_process(
        scenario,
        profile=law,
        spec=spec,
        configure=configure,
        drawn=None if noise is None else DrawnObservations(seed, scale=noise),
        on_progress=on_progress,
    )
    return run.recordings[scenario.robot().name]

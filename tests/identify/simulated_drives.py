"""Simulated runs whose drive is known: drawn observations, everything behind them is the real thing."""

from __future__ import annotations

from pilotfish import data, sim
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.scenario import Scenario
from pilotfish.recording import Recording


def simulated(
    scenario: str,
    seed: int,
    duration_s: float,
    *,
    latency_s: float = 0.1,
    lag_s: float = 0.1,
    linear_gain: float = 1.0,
    angular_gain: float = 1.0,
) -> Recording:
    """robot1's run; its coordinator is configured for 33 ms and 100 ms and knows nothing of these."""
    file = data.path(f"scenarios/{scenario}.yaml")
    spec = sim.load_scenario(file)
    robots = spec.robots
    for robot in robots:
        if robot.name == "robot1":
            camera, drive = robot.camera, robot.drive
            camera.latency_s, drive.actuator_lag_s = latency_s, lag_s
            drive.linear_gain, drive.angular_gain = linear_gain, angular_gain
            robot.camera, robot.drive = camera, drive
    spec.robots, spec.seed = robots, seed
    run = run_in_process(
        Scenario.load(file),
        profile="anticipate",
        spec=spec,
        drawn=DrawnObservations(seed=seed),
        duration_s=duration_s,
        reports=False,
    )
    return run.recordings["robot1"]

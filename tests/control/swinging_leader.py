"""Follows a leader that is commanded any speed and turn rate, which no scenario has. Measurements are drawn."""

import numpy as np

from pilotfish import coordinator, core, data, sim
from pilotfish.harness.drawn_observations import DrawnObservations, ObservationNoise

FRAME_RATE_HZ, DISTANCE_M = 30.0, 1.1
BEATS = 3  # the leader is commanded this often in a frame


def sine(mean, amplitude, frequency_hz):
    return lambda time_s: mean + amplitude * np.sin(2 * np.pi * frequency_hz * time_s)


def follow_leader(speed_mps, turn_radps, *, identify=True, duration_s=40.0, lag_s=0.1, heading_sigma_rad_per_m=0.08e-3):
    """The drive used at the end, and the distance's RMS error over the last two thirds [m]. The robot starts where it
    wants to be, behind a leader that does at once what it is told; both are functions of time [s]."""
    world = sim.World(_scenario(lag_s, duration_s))
    driver = coordinator.Coordinator(_config(identify))
    drawn = DrawnObservations(1, noise=ObservationNoise(heading_sigma_rad_per_m=heading_sigma_rad_per_m))
    errors_m, drive = [], None
    for frame in range(int(duration_s * FRAME_RATE_HZ)):
        time_s = frame / FRAME_RATE_HZ
        world.advance_to(time_s)
        for beat in range(BEATS):
            at_s = time_s + beat / (BEATS * FRAME_RATE_HZ)
            leader = core.Twist(linear_mps=speed_mps(at_s), angular_radps=turn_radps(at_s))
            world.command("leader", leader, effective_time_s=at_s)
        answer = drawn.answer(world, "robot1", driver)
        world.command("robot1", answer.command, effective_time_s=time_s + world.latency_s("robot1"))
        drive = answer.control.drive or drive
        errors_m.append(world.true_relative_pose("robot1")[0] - DISTANCE_M)
    return drive, np.sqrt(np.mean(np.square(errors_m[len(errors_m) // 3 :])))


def _scenario(lag_s, duration_s):
    scenario = sim.load_scenario(data.path("scenarios/line.yaml"))
    scenario.duration_s = duration_s
    robots = scenario.robots
    for robot in robots:
        if robot.name == "leader":
            robot.trajectory = None
            robot.drive = sim.DriveConfig(actuator_lag_s=0.0, max_linear_acceleration_mps2=100.0, command_timeout_s=0.0)
        else:
            robot.start = sim.Pose2(x_m=-DISTANCE_M, y_m=0.0, heading_rad=0.0)
            drive = robot.drive
            drive.actuator_lag_s = lag_s
            robot.drive = drive
    scenario.robots = robots
    return scenario


def _config(identify):
    config = coordinator.load_coordinator(data.path("config/line.yaml")).coordinator
    setpoint = config.setpoint
    setpoint.distance_m, setpoint.bearing_rad = DISTANCE_M, 0.0
    config.setpoint = setpoint
    control = config.control
    drive = control.drive
    drive.identify = identify
    control.drive = drive
    config.control = control
    return config

"""What the camera saw in a run: the world is played again with the recorded commands, and only the pictures
one wants are rendered. They are those of the run to the byte, since a picture is a function of the scenario,
the poses and the number of the frame; what the coordinator made of them comes from its own reports."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pilotfish import sim
from pilotfish.camera_view import CameraView
from pilotfish.core import Twist
from pilotfish.errors import HarnessError
from pilotfish.harness.run import OnProgress, Run
from pilotfish.harness.scenario import Scenario

_SAME_PLACE_M = 1e-6


def replay_camera(
    scenario: Scenario, run: Run, robot: str, *, every: int = 1, on_progress: OnProgress | None = None
) -> Iterator[CameraView]:
    """Every so many'th picture of the robot's camera. HarnessError if the world does not go the recorded way
    again."""
    world = sim.World(sim.load_scenario(scenario.file))
    reports = {report.utime: report for report in run.reports[robot]}
    own = run.recordings[robot]
    for index in range(len(own)):
        time_s = index / scenario.frame_rate_hz
        world.advance_to(time_s)
        pose = world.state(robot).pose
        if np.hypot(pose.x_m - own.x_m[index], pose.y_m - own.y_m[index]) > _SAME_PLACE_M:
            raise HarnessError(f"frame {index}: the replayed '{robot}' is not where the recorded one was")
        frame = world.capture(robot) if index % every == 0 else None
        if frame is not None and (report := reports.get(frame.utime)):
            tags = tuple(zip(report.tag_ids, report.corners_px, strict=True))
            yield CameraView(time_s, frame.image, report.status, tags, report.distance_m, report.bearing_rad)
        for follower in scenario.robots:
            recording = run.recordings[follower.name]
            if not recording.delivered[index]:
                continue
            twist = Twist(
                linear_mps=float(recording.command_linear_mps[index]),
                angular_radps=float(recording.command_angular_radps[index]),
            )
            world.command(follower.name, twist, time_s + world.latency_s(follower.name))
        if on_progress:
            on_progress(index + 1, len(own))

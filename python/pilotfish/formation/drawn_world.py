"""The world of a run whose measurements are drawn."""

from __future__ import annotations

from pilotfish import core, sim

_WIDTH, _HEIGHT = 16, 16  # [px]; nothing is rendered


def without_pictures(spec: sim.Scenario) -> sim.Scenario:
    """The scenario with cameras of a few pixels: a world makes a renderer for each camera, which of a 640 x 480 one is
    some 50 MB and takes a tenth of a second. Latency and mounting stay. ``spec`` itself is changed, and returned."""
    robots = spec.robots
    for robot in robots:
        if robot.camera is not None:
            camera = robot.camera
            camera.model = core.CameraModel(width=_WIDTH, height=_HEIGHT, fx=16.0, fy=16.0, cx=7.5, cy=7.5)
            robot.camera = camera
    spec.robots = robots
    return spec

"""A camera on a robot that turns on the spot and then drives straight before fixed tags: what it sees.

Poses are products of ``CameraMounting.bMc`` and ``BodyTag.oMt``, corners come from ``CameraModel.project``: nothing of
the module under test is used.
"""

from __future__ import annotations

import numpy as np
from turning_bodies import CAMERA, tag

from pilotfish import core, sim
from pilotfish.calibration.body import Sightings, TagSizes

MOUNTING = core.CameraMounting(
    position_m=[0.12, -0.03, 0.31], pan_rad=np.radians(3.0), tilt_rad=np.radians(-4.0), roll_rad=np.radians(1.5)
)
# The wall's tags, in the world where the base begins to turn: 1.6 m ahead, the first turned by 25 degrees.
ONE = core.LeaderBody([tag(0, 0.16, [1.7, 0.05, 0.32], 155)])
WALL = core.LeaderBody(
    [
        tag(0, 0.16, [1.7, 0.0, 0.36], 160),
        tag(1, 0.16, [1.65, -0.45, 0.25], 150),
        tag(2, 0.12, [1.6, 0.5, 0.40], -170),
    ]
)


def ground(x_m=0.0, y_m=0.0, heading_rad=0.0):
    """wMb (4, 4)."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    result = np.eye(4)
    result[:2, :2] = [[c, -s], [s, c]]
    result[:2, 3] = [x_m, y_m]
    return result


def turn(count=40, from_deg=-16.0, to_deg=16.0, wander_m=0.0, seed=0):
    offs = np.random.default_rng(seed).normal(0.0, wander_m, (count, 2))
    return [ground(*off, np.radians(a)) for off, a in zip(offs, np.linspace(from_deg, to_deg, count), strict=True)]


def straight(count=30, length_m=0.6, heading_deg=0.0, x_m=0.0, y_m=0.0, curvature_pm=0.0):
    result = []
    for s in np.linspace(0.0, length_m, count):
        a = curvature_pm * s
        along = s if a == 0 else np.sin(a) / curvature_pm
        aside = 0.0 if a == 0 else (1 - np.cos(a)) / curvature_pm
        result.append(ground(x_m, y_m, np.radians(heading_deg)) @ ground(along, aside, a))
    return result


def camera_from_world(wMb, mounting=MOUNTING):
    return np.linalg.inv(wMb @ mounting.bMc)


def sightings_of(wall, places, *, sigma_px, seed, mounting=MOUNTING, camera=CAMERA):
    """Corners with white noise of every tag that is wholly in the picture."""
    rng = np.random.default_rng(seed)
    frames, tags, corners = [], [], []
    for number, wMb in enumerate(places):
        cMw = camera_from_world(wMb, mounting)
        for place, each in enumerate(wall.tags):
            points = each.corners_m @ cMw[:3, :3].T + cMw[:3, 3]
            pixels = np.array([camera.project(p) for p in points])
            if not ((pixels > 3) & (pixels < [camera.width - 4, camera.height - 4])).all():
                continue
            frames.append(number)
            tags.append(place)
            corners.append(pixels + rng.normal(0.0, sigma_px, (4, 2)))
    ids, sizes = np.array([t.id for t in wall.tags]), np.array([t.size_m for t in wall.tags])
    return Sightings(np.array(frames), np.array(tags), np.array(corners), ids, sizes)


def sizes_of(wall):
    return TagSizes(by_id={each.id: each.size_m for each in wall.tags})


def pictures_of(wall, places, mounting=MOUNTING, camera=CAMERA, noise_sigma=2.0):
    """Frames, 33 ms apart, rendered with blur, noise and clutter."""
    renderer = sim.Renderer(camera, sim.Imperfections(blur_sigma_px=0.7, noise_sigma=noise_sigma), mounting)
    robot = sim.RobotBody()
    robot.leader = wall
    return [
        core.Frame(renderer.render([(robot, camera_from_world(wMb, mounting))], seed=k + 1), utime=(k + 1) * 33_333)
        for k, wMb in enumerate(places)
    ]


def error_of(found, truth=MOUNTING):
    """(6,): x, y, z [m], pan, tilt, roll [rad]."""
    angles = [getattr(found, k) - getattr(truth, k) for k in ("pan_rad", "tilt_rad", "roll_rad")]
    return np.concatenate([np.subtract(found.position_m, truth.position_m), angles])

"""Bodies that turn in front of a camera: their poses, and what a detector with noise of known size would report.

The corners come from ``CameraModel.project``, point by point: nothing of the module under test is used.
"""

from __future__ import annotations

import functools

import numpy as np

from pilotfish import coordinator, core, sim
from pilotfish import data as shipped
from pilotfish.calibration.body import Sightings, TagSizes, collect_sightings

CAMERA = coordinator.load_calibration(str(shipped.path("calibrations/sim_640x480.yaml")))
MOUNTING = core.CameraMounting(position_m=[0, 0, 0.35], tilt_rad=-0.05)


def tag(tag_id, size_m, position_m, facing_deg, tilt_deg=0.0, roll_deg=0.0):
    angles = {"facing_rad": facing_deg, "tilt_rad": tilt_deg, "roll_rad": roll_deg}
    radians = {key: float(np.radians(value)) for key, value in angles.items()}
    return core.BodyTag(id=tag_id, size_m=size_m, position_m=position_m, **radians)


# Five tags of three sizes, in five planes.
FIVE = core.LeaderBody(
    [
        tag(0, 0.16, [-0.20, 0.0, 0.25], 180),
        tag(1, 0.12, [-0.14, 0.15, 0.20], 125, tilt_deg=10),
        tag(2, 0.16, [-0.12, -0.1675, 0.25], -130, roll_deg=5),
        tag(5, 0.10, [0.0, -0.24, 0.30], -80),
        tag(7, 0.12, [-0.20, 0.02, 0.42], 175, tilt_deg=30),
    ]
)
# Twelve all round: a hexagon of 0.25 m with two rows, the upper ones smaller and looking up.
TWELVE = core.LeaderBody(
    [
        tag(10 + k, 0.14, [0.25 * np.cos(a), 0.25 * np.sin(a), 0.15], float(np.degrees(a)))
        for k, a in enumerate(np.radians([180, 120, 60, 0, -60, -120]))
    ]
    + [
        tag(20 + k, 0.09, [0.2 * np.cos(a), 0.2 * np.sin(a), 0.32], float(np.degrees(a)), tilt_deg=25, roll_deg=90)
        for k, a in enumerate(np.radians([180, 120, 60, 0, -60, -120]))
    ]
)


def turned(phi_rad, x_m=1.3, y_m=0.05):
    """cMo of a body at (x, y) that has turned by phi from where it looks away from the camera."""
    bMo, c, s = np.eye(4), np.cos(phi_rad), np.sin(phi_rad)
    bMo[:2, :2] = [[c, -s], [s, c]]
    bMo[:3, 3] = [x_m, y_m, 0.0]
    return np.linalg.inv(MOUNTING.bMc) @ bMo


def one_turn(frames, distance_m=1.3, from_deg=0.0, to_deg=360.0):
    steps = np.radians(np.linspace(from_deg, to_deg, frames, endpoint=False))
    return [turned(phi, distance_m) for phi in steps]


def sizes_of(body):
    return TagSizes(by_id={each.id: each.size_m for each in body.tags})


def sightings_of(body, poses, *, sigma_px, seed, steepest_deg=65.0):
    """Of every tag that is seen less steeply than that, with white noise on its corners."""
    rng = np.random.default_rng(seed)
    frames, tags, corners_px = [], [], []
    for number, cMo in enumerate(poses):
        for place, each in enumerate(body.tags):
            cMt = cMo @ each.oMt
            if cMt[:3, 2] @ cMt[:3, 3] / np.linalg.norm(cMt[:3, 3]) < np.cos(np.radians(steepest_deg)):
                continue
            corners_c = each.corners_m @ cMo[:3, :3].T + cMo[:3, 3]
            frames.append(number)
            tags.append(place)
            corners_px.append(np.array([CAMERA.project(p) for p in corners_c]) + rng.normal(0, sigma_px, (4, 2)))
    ids, sizes_m = np.array([each.id for each in body.tags]), np.array([each.size_m for each in body.tags])
    everything = Sightings(np.array(frames), np.array(tags), np.array(corners_px), ids, sizes_m)
    return everything.where(np.ones(len(frames), dtype=bool))


def errors_of(learned, truth):
    """(T, 6): the (v, w) [m, rad] that move each learned tag to where it is, in its own frame; small turns."""
    true = {each.id: each for each in truth.tags}
    result = []
    for each in learned.body.tags:
        difference = np.linalg.inv(each.oMt) @ true[each.id].oMt
        axial = (difference[:3, :3] - difference[:3, :3].T)[[2, 0, 1], [1, 2, 0]] / 2
        result.append(np.concatenate([difference[:3, 3], axial]))
    return np.array(result)


@functools.lru_cache(maxsize=1)
def film():
    """A turn of FIVE to 110 degrees on either side, rendered with blur, noise, distortion and clutter."""
    renderer = sim.Renderer(CAMERA, sim.Imperfections(blur_sigma_px=0.7, noise_sigma=3.0), MOUNTING)
    robot = sim.RobotBody()
    robot.leader = FIVE
    poses = one_turn(44, from_deg=-110, to_deg=110)
    return [core.Frame(renderer.render([(robot, cMo)], seed=k + 1), utime=k) for k, cMo in enumerate(poses)]


@functools.lru_cache(maxsize=1)
def filmed():
    return collect_sightings(film(), CAMERA, sizes_of(FIVE))

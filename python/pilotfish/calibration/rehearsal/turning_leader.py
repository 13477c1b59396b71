"""A leader that turns on the spot before a camera that stands still, its faces a little off from their places."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from pilotfish import sim
from pilotfish.calibration.body.leader_file import body_tag
from pilotfish.calibration.rehearsal.outlets import Shot
from pilotfish.calibration.rehearsal.tags_in_view import STEEPEST_DEG, faces_camera, inside_picture, shortest_side_px
from pilotfish.core import CameraModel, CameraMounting, LeaderBody
from pilotfish.errors import UsageError

_ABOVE_M = 0.1  # by which the camera stands above the tags' mean height
_BESIDE_M = 0.05  # by which the turning centre is beside the middle of the picture, so that nothing is symmetric
_PERIOD_US, _BEGIN_US = 200_000, 1_000_000
SMALL_SIDE_PX = 25.0


@dataclass(frozen=True)
class TurningLeader:
    """``body``: the true one; ``mounting``: of the camera, in a frame on the ground; ``poses``: cMo (4, 4) of each
    picture."""

    body: LeaderBody
    mounting: CameraMounting
    poses: list[np.ndarray]


def with_wrong_faces(body: LeaderBody, off_m: float, off_rad: float, seed: int) -> LeaderBody:
    """The same leader, each tag moved by ``off_m`` in a random direction and turned by ``off_rad`` about a random axis
    (about the direction in which it looks, of the tag with the smallest id: where that one looks defines forward, and a
    camera cannot know better)."""
    rng = np.random.default_rng(seed)
    reference = min(tag.id for tag in body.tags)
    tags = []
    for tag in body.tags:
        place, axis = (each / np.linalg.norm(each) for each in rng.normal(size=(2, 3)))
        if tag.id == reference:
            axis = np.array([0.0, 0.0, math.copysign(1.0, axis[2])])
        moved = tag.oMt
        moved[:3, 3] += off_m * place
        moved[:3, :3] = moved[:3, :3] @ Rotation.from_rotvec(off_rad * axis).as_matrix()
        tags.append(body_tag(tag.id, tag.size_m, moved))
    return LeaderBody(tags, family=body.family, name=body.name)


def plan_turn(camera: CameraModel, body: LeaderBody, pictures: int, distance_m: float) -> TurningLeader:
    """One turn all round, ``distance_m`` before the camera. UsageError if a tag leaves the picture, or is too small in
    it."""
    height_m = float(np.mean([tag.position_m[2] for tag in body.tags]))
    mounting = CameraMounting(position_m=[0.0, 0.0, height_m + _ABOVE_M], tilt_rad=-math.atan2(_ABOVE_M, distance_m))
    poses = []
    for turned in np.linspace(0.0, 2.0 * math.pi, pictures, endpoint=False):
        bMo, c, s = np.eye(4), math.cos(turned), math.sin(turned)
        bMo[:2, :2] = [[c, -s], [s, c]]
        bMo[:2, 3] = [distance_m, _BESIDE_M]
        poses.append(np.linalg.inv(mounting.bMc) @ bMo)
    _check_seen(camera, body, poses, distance_m)
    return TurningLeader(body, mounting, poses)


def turn_shots(
    camera: CameraModel, leader: TurningLeader, imperfections: sim.Imperfections, seed: int = 1
) -> Iterator[Shot]:
    """What the camera sees of it, picture by picture."""
    renderer = sim.Renderer(camera, imperfections, leader.mounting)
    robot = sim.RobotBody()
    robot.leader = leader.body
    for k, cMo in enumerate(leader.poses):
        yield Shot(_BEGIN_US + k * _PERIOD_US, renderer.render([(robot, cMo)], seed=1_000_003 * seed + k))


def _check_seen(camera: CameraModel, body: LeaderBody, poses: list[np.ndarray], distance_m: float) -> None:
    for tag in body.tags:
        sides = []
        for cMo in poses:
            if not faces_camera(cMo, tag, STEEPEST_DEG):
                continue
            if not inside_picture(camera, cMo, tag):
                raise UsageError(
                    f"tag {tag.id} leaves the picture at {distance_m:g} m: take a larger --distance-m or a wider camera"
                )
            sides.append(shortest_side_px(camera, cMo, tag))
        if not sides:
            raise UsageError(
                f"tag {tag.id} never faces the camera: does it look up or down? Or take more pictures (--pictures)"
            )
        if max(sides) < SMALL_SIDE_PX:
            raise UsageError(
                f"tag {tag.id} has a side of {max(sides):.0f} px at most at {distance_m:g} m, {SMALL_SIDE_PX:.0f} are "
                "needed: take a smaller --distance-m, or a larger --size of the pictures"
            )

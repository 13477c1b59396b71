"""A robot that turns on the spot before a fixed tag and then drives straight towards it, and what its camera sees.

The robot is the simulator's unicycle, with its ramps and its lag; the camera sits where ``mounting`` says, which a
calibration is to find.

What a calibration is off by comes less from the pictures' noise than from where the tag's edges fall between the
pixels: there the fitted corners are off by some hundredths of a pixel, the same in every picture of the same place. The
seed therefore decides also where exactly the tag stands and when the first picture is taken: with the noise alone, all
seeds would be off by the same 0.3 mm.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pilotfish import sim
from pilotfish.calibration.rehearsal.lens import directions
from pilotfish.calibration.rehearsal.outlets import Pose, Shot
from pilotfish.calibration.rehearsal.tags_in_view import faces_camera, inside_picture
from pilotfish.core import BodyTag, CameraModel, CameraMounting, LeaderBody, Twist
from pilotfish.errors import UsageError

TURN_RADPS, DRIVE_MPS = 0.2, 0.12
_PAUSE_S = 0.6  # longer than the wheels' lag: a turn by an angle ends at this angle
_STEP_US, _ODOMETRY_US, _BEGIN_US = 10_000, 20_000, 1_000_000
_TAG_TURNED_RAD = math.radians(25.0)  # out of the frontal view: its pose is known better so
_EDGE_RAD, _MOST_TURN_RAD = math.radians(4.0), math.radians(60.0)
MIN_TURN_PICTURES, MIN_DRIVE_PICTURES = 12, 8  # with the whole tag; the calibration needs 8 and 5
_TAG_OFF_M = 0.02  # along each axis, at most: where exactly the tag stands is drawn
_LEAST_LEFT_M = 0.3  # between camera and tag at the end of the drive


@dataclass(frozen=True)
class DriveSettings:
    """``rate_hz``: pictures per second; ``tag_size_m``; ``tag_distance_m``: from the camera where the robot turns,
    along its optical axis; ``drive_m``; ``wander_m``: standard deviation, along each axis, of the turning centre about
    its mean, picture by picture; ``odometry_turn``, ``odometry_way``: what odometry says over what is true;
    ``seed``: of the wandering, of where within 2 cm the tag stands, and of the pictures' phase."""

    rate_hz: float = 5.0
    tag_size_m: float = 0.16
    tag_distance_m: float = 1.6
    drive_m: float = 0.6
    wander_m: float = 0.0
    odometry_turn: float = 1.02
    odometry_way: float = 0.99
    tag_id: int = 0
    seed: int = 1


@dataclass(frozen=True)
class MountingDrive:
    """``wall``: the tag, in the world in which the base turns at the origin; ``places`` of the pictures: wMb (4, 4);
    ``utime`` [us] of each; ``turning`` whether that is in the turn; ``odometry``: as recorded."""

    wall: LeaderBody
    places: list[np.ndarray]
    utime: list[int]
    turning: list[bool]
    odometry: list[Pose]


def plan_drive(camera: CameraModel, mounting: CameraMounting, settings: DriveSettings) -> MountingDrive:
    """The whole drive. UsageError if the camera would not see the tag in enough of it."""
    if settings.tag_distance_m - settings.drive_m < _LEAST_LEFT_M:
        raise UsageError(
            f"--drive-m: {settings.drive_m:g} leaves less than {_LEAST_LEFT_M:g} m to a tag that is "
            f"{settings.tag_distance_m:g} m away; allowed: up to {settings.tag_distance_m - _LEAST_LEFT_M:g}, or a "
            "larger --tag-distance-m"
        )
    rng = np.random.default_rng(settings.seed)
    wall = _wall(mounting, settings, rng.uniform(-_TAG_OFF_M, _TAG_OFF_M, 3))
    ahead = math.atan2(wall.tags[0].position_m[1], wall.tags[0].position_m[0])
    half_rad = _half_turn(camera)
    robot = sim.Unicycle(sim.DriveConfig(), sim.Pose2(heading_rad=-half_rad))
    places, utime, turning, odometry = [], [], [], []
    picture_us = round(1e6 / settings.rate_hz)
    first_us = rng.uniform(0.0, picture_us)
    now_us = 0
    for command, duration_s, turns in _commands(half_rad, settings):
        for _ in range(round(duration_s * 1e6 / _STEP_US)):
            pose = robot.state.pose
            if now_us % _ODOMETRY_US == 0:
                odometry.append(_odometry(pose, now_us + _BEGIN_US, half_rad, settings))
            if now_us >= first_us + len(utime) * picture_us:
                wander = rng.normal(0.0, settings.wander_m, 2) if turns else np.zeros(2)
                places.append(_ground(pose, wander))
                utime.append(now_us + _BEGIN_US)
                turning.append(turns)
            robot.advance(command, _STEP_US * 1e-6)
            now_us += _STEP_US
    drive = MountingDrive(wall, places, utime, turning, odometry)
    _check_seen(camera, mounting, drive, ahead)
    return drive


def drive_shots(
    camera: CameraModel, mounting: CameraMounting, drive: MountingDrive, imperfections: sim.Imperfections, seed: int = 1
) -> Iterator[Shot]:
    """What the camera sees of it, picture by picture."""
    renderer = sim.Renderer(camera, imperfections, mounting)
    wall = sim.RobotBody()
    wall.leader = drive.wall
    for k, (wMb, utime) in enumerate(zip(drive.places, drive.utime, strict=True)):
        heading_rad = math.atan2(wMb[1, 0], wMb[0, 0]) + mounting.pan_rad  # what is far away turns, too
        cMw = np.linalg.inv(wMb @ mounting.bMc)
        image = renderer.render([(wall, cMw)], camera_heading_rad=heading_rad, seed=1_000_003 * seed + k)
        yield Shot(utime, image)


def _half_turn(camera: CameraModel) -> float:
    """From where the tag is at one side of the picture to where it is in the middle."""
    left, right = directions(camera, np.array([[0.0, camera.cy], [camera.width - 1.0, camera.cy]]))
    wide_rad = math.atan2(right[0], right[2]) - math.atan2(left[0], left[2])
    return min(max(wide_rad / 2.0 - _EDGE_RAD, _EDGE_RAD), _MOST_TURN_RAD)


def _commands(half_rad: float, settings: DriveSettings) -> list[tuple[Twist, float, bool]]:
    """(command, for how long [s], whether it is of the turn): from -half to half, back to 0, and ahead. Ramps and lag
    take from the beginning what they add at the end, so a command of v for T, and then rest, moves by v T."""
    left, right, ahead = Twist(angular_radps=TURN_RADPS), Twist(angular_radps=-TURN_RADPS), Twist(linear_mps=DRIVE_MPS)
    return [
        (left, 2.0 * half_rad / TURN_RADPS, True),
        (Twist(), _PAUSE_S, True),
        (right, half_rad / TURN_RADPS, True),
        (Twist(), _PAUSE_S, True),
        (ahead, settings.drive_m / DRIVE_MPS, False),
        (Twist(), _PAUSE_S, False),
    ]


def _wall(mounting: CameraMounting, settings: DriveSettings, off_m: np.ndarray) -> LeaderBody:
    """One tag as high as the camera, on its optical axis as far as that is level, but for ``off_m``."""
    x, y, z = mounting.position_m
    along = settings.tag_distance_m
    place = [x + along * math.cos(mounting.pan_rad), y + along * math.sin(mounting.pan_rad), z]
    place = [float(there + off) for there, off in zip(place, off_m, strict=True)]
    facing = math.remainder(mounting.pan_rad + math.pi - _TAG_TURNED_RAD, 2.0 * math.pi)
    return LeaderBody([BodyTag(id=settings.tag_id, size_m=settings.tag_size_m, position_m=place, facing_rad=facing)])


def _ground(pose: sim.Pose2, off_m: np.ndarray) -> np.ndarray:
    """wMb (4, 4)."""
    c, s = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    result = np.eye(4)
    result[:2, :2] = [[c, -s], [s, c]]
    result[:2, 3] = [pose.x_m + off_m[0], pose.y_m + off_m[1]]
    return result


def _odometry(pose: sim.Pose2, utime: int, half_rad: float, settings: DriveSettings) -> Pose:
    """Scaled about where it began, and in its own world, which begins at 0 there."""
    turned = settings.odometry_turn * (pose.heading_rad + half_rad)
    # The robot drives along the world's x: odometry along the direction that it has turned to.
    way, along = settings.odometry_way * pose.x_m, settings.odometry_turn * half_rad
    return Pose(utime, way * math.cos(along), way * math.sin(along), turned)


def _check_seen(camera: CameraModel, mounting: CameraMounting, drive: MountingDrive, ahead_rad: float) -> None:
    tag = drive.wall.tags[0]
    seen = {True: 0, False: 0}
    for wMb, turns in zip(drive.places, drive.turning, strict=True):
        cMw = np.linalg.inv(wMb @ mounting.bMc)
        seen[turns] += faces_camera(cMw, tag) and inside_picture(camera, cMw, tag)
    for turns, what, least in ((True, "turn", MIN_TURN_PICTURES), (False, "drive", MIN_DRIVE_PICTURES)):
        if seen[turns] < least:
            total = drive.turning.count(turns)
            raise UsageError(
                f"the tag is wholly in {seen[turns]} of {total} pictures of the {what}, {least} are needed. It is "
                f"{round(math.degrees(ahead_rad))} degrees to the left of straight ahead, as high as the camera, whose "
                f"tilt is {round(math.degrees(mounting.tilt_rad))} degrees: take another --tag-distance-m, "
                "--tag-size, a shorter --drive-m, more pictures (--rate-hz), or a camera that looks ahead"
            )

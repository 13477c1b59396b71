"""Frames whose truth is known: one tag on a box, in front of clutter, moving smoothly past a camera.

All poses are cMt, tag frame (x right, y down as one reads it, z into the wall) to camera frame (x right, y down, z
forward). Frames come as sequences with real motion between them, so that the same frame serves a baseline that looks at
every frame anew and a tracker that remembers the last one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pilotfish import core, sim

FRAME_RATE_HZ = 30.0
TAG_ID, TAG_SIZE_M = 5, 0.16
LEADER = core.LeaderBody([core.BodyTag(id=TAG_ID, size_m=TAG_SIZE_M)])
MAX_YAW_DEG = 60.0
REAL = {"blur_sigma_px": 0.7, "noise_sigma": 3.0}


def camera_of(width: int, height: int, f_px: float, **distortion: float) -> core.CameraModel:
    """A camera whose principal point is the middle of the image, pixel centres at whole numbers."""
    middle = {"cx": width / 2 - 0.5, "cy": height / 2 - 0.5}
    return core.CameraModel(width=width, height=height, fx=f_px, fy=f_px, **middle, **distortion)


VGA, HD = camera_of(640, 480, 600.0), camera_of(1280, 720, 1200.0)
CAMERAS = {"640x480": VGA, "1280x720": HD}


@dataclass(frozen=True)
class Picture:
    """One frame and its truth."""

    image: np.ndarray  # (H, W) uint8
    cMt: np.ndarray  # (4, 4): the leader's tag
    utime: int  # [us]


def rotation(yaw_rad: float, pitch_rad: float, roll_rad: float) -> np.ndarray:
    """(3, 3): roll about the camera's forward axis, then pitch about its right, then yaw about its down axis."""
    cy, cp, cr = np.cos([yaw_rad, pitch_rad, roll_rad])
    sy, sp, sr = np.sin([yaw_rad, pitch_rad, roll_rad])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    about_z = np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]])
    return about_y @ about_x @ about_z


def tag_pose(
    distance_m: float,
    *,
    azimuth_rad: float = 0.0,
    elevation_rad: float = 0.0,
    yaw_rad: float = 0.0,
    pitch_rad: float = 0.0,
    roll_rad: float = 0.0,
) -> np.ndarray:
    """cMt (4, 4) of a tag at that distance from the camera, `azimuth_rad` to the right and `elevation_rad` up. The
    angles of the tag are counted from the ray on which it is seen: with all three zero it is seen head-on."""
    cMt = np.eye(4)
    towards = rotation(azimuth_rad, elevation_rad, 0.0)
    cMt[:3, :3] = towards @ rotation(yaw_rad, pitch_rad, roll_rad)
    cMt[:3, 3] = towards @ [0.0, 0.0, distance_m]
    return cMt


def body_pose(cMt: np.ndarray) -> np.ndarray:
    """cMo (4, 4) of LEADER, whose tag hangs at its origin."""
    return cMt @ np.linalg.inv(LEADER.tags[0].oMt)


def corners_px(camera: core.CameraModel, cMt: np.ndarray, size_m: float = TAG_SIZE_M) -> np.ndarray:
    """(4, 2): the black square's corners, bottom left first, counter-clockwise as one reads the tag."""
    corners_t = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]) * size_m / 2
    return np.array([camera.project(point) for point in corners_t @ cMt[:3, :3].T + cMt[:3, 3]])


def triangle(phase: float) -> float:
    """From -1 to 1 and back within a period of 1, at constant speed: every value is equally frequent."""
    return 4.0 * abs(phase - math.floor(phase) - 0.5) - 1.0


class Wander:
    """A smooth function of time: a sine of a given amplitude and random phase, as fast as `speed` allows on average but
    never faster than max_rate_radps (a robot does not tremble)."""

    def __init__(self, rng: np.random.Generator, amplitude: float, speed: float, max_rate_radps: float = 2.0):
        self.amplitude, self.phase = amplitude, rng.uniform(0, 2 * np.pi)
        self.rate_radps = min(speed / amplitude, max_rate_radps) * rng.uniform(0.8, 1.2)

    def __call__(self, time_s: float) -> float:
        return self.amplitude * float(np.sin(self.rate_radps * time_s + self.phase))


@dataclass(frozen=True)
class Motion:
    """How a leader moves at a nominal distance. Speeds are those of a robot indoors."""

    distance_m: float
    max_yaw_deg: float = MAX_YAW_DEG
    sweep_s: float = 3.3  # from one extreme yaw to the other
    sideways_mps: float = 0.3
    sideways_share: float = 0.22  # amplitude over distance
    ahead_mps: float = 0.1
    ahead_share: float = 0.02  # amplitude over distance

    def path(self, rng: np.random.Generator) -> Callable[[float], np.ndarray]:
        """cMt (4, 4) as a function of time [s]."""
        d = self.distance_m
        aside = Wander(rng, self.sideways_share, self.sideways_mps / d)
        above = Wander(rng, 0.06, 0.05 / d)
        ahead = Wander(rng, self.ahead_share * d, self.ahead_mps)
        pitch, roll = (Wander(rng, np.radians(3.0), np.radians(5.0)) for _ in range(2))
        start = rng.uniform()

        def at(t: float) -> np.ndarray:
            yaw_deg = self.max_yaw_deg * triangle(start + t / (2 * self.sweep_s))
            return tag_pose(
                d + ahead(t),
                azimuth_rad=aside(t),
                elevation_rad=above(t),
                yaw_rad=np.radians(yaw_deg),
                pitch_rad=pitch(t),
                roll_rad=roll(t),
            )

        return at

    def poses(self, count: int, rng: np.random.Generator) -> list[np.ndarray]:
        """cMt (4, 4) at the first `count` frames."""
        path = self.path(rng)
        return [path(k / FRAME_RATE_HZ) for k in range(count)]


class Scene:
    """A camera before which a leader can be put. Same seed: same bytes."""

    def __init__(self, camera: core.CameraModel, seed: int, **imperfections: float):
        self.camera = camera
        self._renderer = sim.Renderer(camera, sim.Imperfections(**(REAL | imperfections)), clutter_seed=seed)
        self._seed = seed
        self._furniture = self._placed_furniture(np.random.default_rng(seed))

    def image(self, worn: Sequence[tuple[core.LeaderBody, np.ndarray]], index: float) -> np.ndarray:
        """(H, W) uint8 of robots, given as (what it wears, cMt of its tag), at frame number `index`, which need not be
        whole. The robot that carries the camera sways as it drives, so the clutter moves too."""
        robots = []
        for leader, cMt in worn:
            robot = sim.RobotBody(box_size_m=[0.24, 0.26, 0.26], box_position_m=[0.12, 0.0, 0.0])
            robot.leader = leader
            robots.append((robot, body_pose(cMt)))
        heading_rad = 0.2 * float(np.sin(0.7 * index / FRAME_RATE_HZ))
        seed = 1 + self._seed * 100_003 + math.floor(index)
        return self._renderer.render([*robots, *self._furniture], camera_heading_rad=heading_rad, seed=seed)

    def pictures(self, poses: Sequence[np.ndarray]) -> Iterator[Picture]:
        """LEADER at these poses, one a frame."""
        for index, cMt in enumerate(poses):
            yield Picture(self.image([(LEADER, cMt)], index), cMt, utime_of(index))

    @staticmethod
    def _placed_furniture(rng: np.random.Generator) -> list[tuple[sim.RobotBody, np.ndarray]]:
        """Boxes behind the leader, whose edges and corners are what a detector of squares has to look at."""
        placed = []
        for _ in range(8):
            size_m = [0.2, *rng.uniform(0.2, 1.0, 2)]
            box = sim.RobotBody(box_size_m=size_m, box_gray=float(rng.uniform(20, 235)))
            pose = tag_pose(
                float(rng.uniform(6.0, 9.0)),
                azimuth_rad=float(rng.uniform(-0.55, 0.55)),
                elevation_rad=float(rng.uniform(-0.3, 0.35)),
                yaw_rad=float(rng.uniform(-1, 1)),
                roll_rad=float(rng.uniform(-0.4, 0.4)),
            )
            placed.append((box, body_pose(pose)))
        return placed


def utime_of(index: int) -> int:
    return 1_000_000 + round(index * 1e6 / FRAME_RATE_HZ)

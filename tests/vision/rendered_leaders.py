"""Leaders before a camera, drawn by the simulator with exact areas (tests/sim checks it against ViSP), and how far an
answer is from the truth."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np
from pinhole_drawing import corners_px, leader_pose

from pilotfish import sim
from pilotfish.core import BodyTag, CameraModel, Frame, LeaderBody, Observation
from pilotfish.vision import LeaderObserver, LeaderObserverConfig, TagMeasurement, TagTracker

CAMERA = CameraModel(width=640, height=480, fx=600, fy=600, cx=319.5, cy=239.5)
TAG = BodyTag(id=3, size_m=0.16)
BODY = LeaderBody([TAG])
PERIOD_US = 33_333
# Two faces of a chest, turned by 45 degrees to either side of the leader's rear.
ROOF = LeaderBody(
    [
        BodyTag(id=1, size_m=0.16, position_m=[0.0, 0.12, 0.0], facing_rad=np.radians(135)),
        BodyTag(id=2, size_m=0.16, position_m=[0.0, -0.12, 0.0], facing_rad=np.radians(-135)),
    ]
)


def leader_at(distance_m: float, bearing_rad: float = 0.0, heading_rad: float = 0.0, height_m: float = 0.0):
    """cMo (4, 4); the camera is at its robot's base origin and level."""
    x, y = distance_m * np.cos(bearing_rad), distance_m * np.sin(bearing_rad)
    return leader_pose(x, y, heading_rad, height_m)


@functools.lru_cache(maxsize=32)
def _renderer(camera: CameraModel, clutter_seed: int, settings: tuple) -> sim.Renderer:
    return sim.Renderer(camera, sim.Imperfections(**dict(settings)), clutter_seed=clutter_seed)


def render(
    leaders: Sequence[tuple[LeaderBody, np.ndarray]],
    seed: int,
    *,
    camera: CameraModel = CAMERA,
    clutter_seed: int = 1,
    **imperfections: float,
) -> np.ndarray:
    """(H, W) uint8 of leaders, given as (what it wears, cMo). `seed` of the noise; blur sigma 0.7 px and noise sigma 3
    unless stated otherwise."""
    robots = []
    for body, cMo in leaders:
        robot = sim.RobotBody()
        robot.leader = body
        robots.append((robot, cMo))
    return _renderer(camera, clutter_seed, tuple(sorted(imperfections.items()))).render(robots, seed=1 + seed)


def frame(image: np.ndarray, index: float) -> Frame:
    """Frame number `index` of a camera with 30 frames a second."""
    return Frame(image, utime=1_000_000 + round(index * PERIOD_US))


def observer(body: LeaderBody = BODY, camera: CameraModel = CAMERA, **config) -> LeaderObserver:
    return LeaderObserver(camera=camera, body=body, config=LeaderObserverConfig(**config))


def look(
    image: np.ndarray,
    guess_px: np.ndarray,
    *,
    tag: BodyTag = TAG,
    camera: CameraModel = CAMERA,
    family: str = "tag36h11",
    search_px: float = 0.0,
    **gates,
):
    """The TagMeasurement of that tag near those corners, or the TagRefusal."""
    tracker = TagTracker(camera=camera, body=LeaderBody([tag], family=family), **gates)
    return tracker.track(image, tracker.predict_at(tag.id, corners_px=guess_px, search_px=search_px))


def found(answer) -> bool:
    return isinstance(answer, TagMeasurement)


def true_corners(cMo: np.ndarray, tag: BodyTag = TAG, camera: CameraModel = CAMERA) -> np.ndarray:
    return corners_px(camera, cMo, tag)


def wrapped(angle_rad):
    return (np.asarray(angle_rad) + np.pi) % (2 * np.pi) - np.pi


def error_of(measured, truth: Sequence[float]) -> np.ndarray:
    """(3,): (d, theta, psi) less the truth, of an Observation or a RelativePose."""
    error = np.array([measured.distance_m, measured.bearing_rad, measured.heading_rad]) - truth
    return np.array([error[0], *wrapped(error[1:])])


def squared_in_sigmas(error: np.ndarray, covariance: np.ndarray) -> float:
    """e^T C^-1 e: chi-squared with as many degrees of freedom as `error` has numbers, if the covariance is true."""
    return float(error @ np.linalg.solve(covariance, error))


def bits_of(seen: Observation | None) -> tuple | None:
    """Everything an observation says, to be compared bit by bit."""
    if seen is None:
        return None
    return (
        seen.utime,
        seen.distance_m,
        seen.bearing_rad,
        seen.heading_rad,
        seen.heading_ambiguity,
        seen.ambiguity_ratio,
        seen.found_by,
        seen.covariance.tobytes(),
        seen.measured.covariance.tobytes(),
        seen.cMo.tobytes(),
        None if seen.other_cMo is None else seen.other_cMo.tobytes(),
        *(tag.corners_px.tobytes() for tag in seen.tags),
    )

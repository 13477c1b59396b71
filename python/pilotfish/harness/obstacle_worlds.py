"""Seeded worlds full of obstacles, each played once with drawn measurements: what happened to the follower."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np

from pilotfish import coordinator, core, data, sim
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.in_process import FrameEvent, run_in_process
from pilotfish.harness.scenario import FollowingRobot, Scenario

NEAR_M = 0.4  # from an obstacle's surface to the robot's outline: among obstacles
SETTLE_S = 5.0  # after the last obstacle the formation is to be kept again within this
DISTANCE_TOLERANCE_M, BEARING_TOLERANCE_RAD = 0.05, math.radians(5.0)
ARENA_M2 = 5.0 * 3.0  # of data/scenarios/obstacles.yaml
CLEAR_M = 0.35  # beside the path of the leader, whose outline is 0.25 m from its middle


class Ending(Enum):
    """How a world ended, the worst that applies."""

    COLLIDED = "collided"
    LOST = "leader lost"  # it is not seen at the end
    BLOCKED = "blocked"  # it is seen at the end, and the robot stands before an obstacle
    LATE = "formation not kept again in time"
    KEPT = "formation kept again"


@dataclass(frozen=True)
class Outcome:
    """One world."""

    seed: int
    ending: Ending
    clearance_m: float  # the least of the run, from outline to outline
    settled_s: float  # from the last obstacle until the formation was kept for good; infinite: never
    avoided: bool  # the bearing that is kept was shifted by more than a degree, or the speed was limited
    seen: float  # share of the frames in which the leader was measured


@dataclass(frozen=True)
class Track:
    """Of one run, a value a frame."""

    time_s: np.ndarray
    pose: np.ndarray  # (N, 3): x [m], y [m], heading [rad]
    leader: np.ndarray  # (N, 3), likewise
    clearance_m: np.ndarray  # to the nearest obstacle or robot
    obstacle_m: np.ndarray  # to the nearest obstacle
    distance_error_m: np.ndarray  # true distance less the one that was asked for
    bearing_error_rad: np.ndarray
    shift_rad: np.ndarray  # of the bearing that is kept; NaN: not measured
    status: list[str]
    reason: list[str]
    obstacles: np.ndarray  # (M, 4): x, y, radius, height [m]


def world_spec(seed: int, count: int, clear_m: float = CLEAR_M) -> sim.Scenario:
    """The world of that seed: the field of data/scenarios/obstacles.yaml with ``count`` obstacles; the setpoint
    (1.0 to 1.4 m, -20 to 20 degrees) and the leader's path (straight, or a circle of 4 m or more to either side) are
    drawn, too."""
    random = np.random.default_rng(seed)
    spec = sim.load_scenario(data.path("scenarios/obstacles.yaml"))
    spec.seed = seed
    spec.obstacle_field = field = spec.obstacle_field
    field.count, field.clear_m = count, clear_m
    spec.obstacle_field = field
    leader, robot = spec.robots
    profile = leader.trajectory.profile
    bend = random.uniform(-0.25, 0.25)  # curvature [1/m]
    if abs(bend) > 0.05:
        leader.trajectory = sim.Circle(radius_m=1.0 / abs(bend), clockwise=bool(bend < 0.0), profile=profile)
    distance_m, bearing_rad = random.uniform(1.0, 1.4), math.radians(random.uniform(-20.0, 20.0))
    robot.setpoint = core.Setpoint(distance_m=distance_m, bearing_rad=bearing_rad)
    robot.start = sim.Pose2(x_m=-distance_m * math.cos(bearing_rad), y_m=-distance_m * math.sin(bearing_rad))
    spec.robots = [leader, robot]
    return spec


def play(
    spec: sim.Scenario,
    configure: Callable[[coordinator.CoordinatorConfig], None] | None = None,
    profile: str = "anticipate",
) -> Track:
    """One run of robot1 in that world, with drawn measurements and the sonars of the world."""
    robot = spec.robot("robot1")
    file = data.path("scenarios/obstacles.yaml")
    following = FollowingRobot("robot1", "leader", robot.coordinator_file, robot.setpoint)
    scenario = Scenario(file, spec.name, spec.duration_s, spec.frame_rate_hz, (following,))
    rows: list[tuple[float, ...]] = []
    words: list[tuple[str, str]] = []
    obstacles: list[sim.Obstacle] = []

    def on_frame(event: FrameEvent) -> None:
        world, result = event.world, event.result
        if not obstacles:
            obstacles.extend(world.obstacles)
        own, leader = world.state("robot1").pose, world.state("leader").pose
        distance_m, bearing_rad, _ = world.true_relative_pose("robot1")
        clear_m = min((math.hypot(o.x_m - own.x_m, o.y_m - own.y_m) - o.radius_m for o in obstacles), default=math.inf)
        law = result.control if result else None
        rows.append(
            (
                event.time_s,
                *(own.x_m, own.y_m, own.heading_rad),
                *(leader.x_m, leader.y_m, leader.heading_rad),
                world.clearance_m("robot1"),
                clear_m - robot.radius_m,
                distance_m - robot.setpoint.distance_m,
                bearing_rad - robot.setpoint.bearing_rad,
                law.avoidance.bearing_shift_rad if law and law.avoidance else math.nan,
            )
        )
        words.append((result.status.name, result.reason.name) if result else ("", ""))

    drawn = DrawnObservations(spec.seed, occlusion=True)
    run_in_process(scenario, profile=profile, spec=spec, drawn=drawn, configure=configure, on_frame=on_frame)
    table = np.array(rows)
    return Track(
        time_s=table[:, 0],
        pose=table[:, 1:4],
        leader=table[:, 4:7],
        clearance_m=table[:, 7],
        obstacle_m=table[:, 8],
        distance_error_m=table[:, 9],
        bearing_error_rad=table[:, 10],
        shift_rad=table[:, 11],
        status=[status for status, _ in words],
        reason=[reason for _, reason in words],
        obstacles=np.array([(o.x_m, o.y_m, o.radius_m, o.height_m) for o in obstacles]).reshape(-1, 4),
    )


def judge(seed: int, track: Track) -> Outcome:
    """What that run amounts to."""
    clearance_m = float(track.clearance_m.min())
    near = np.flatnonzero(track.obstacle_m < NEAR_M)
    left_s = track.time_s[near[-1]] if near.size else 0.0
    wrong = (np.abs(track.distance_error_m) > DISTANCE_TOLERANCE_M) | (
        np.abs(track.bearing_error_rad) > BEARING_TOLERANCE_RAD
    )
    last_wrong_s = float(track.time_s[np.flatnonzero(wrong)[-1]]) if wrong.any() else 0.0
    settled_s = math.inf if wrong[-1] else max(0.0, last_wrong_s - left_s)
    seen = np.array([status == "tracking" for status in track.status])
    if clearance_m < 0.0:
        ending = Ending.COLLIDED
    elif settled_s <= SETTLE_S:
        ending = Ending.KEPT
    elif not seen[-1]:
        ending = Ending.LOST
    elif track.reason[-1] == "obstacle_in_path":
        ending = Ending.BLOCKED
    else:
        ending = Ending.LATE
    shifted = np.nan_to_num(track.shift_rad)
    avoided = bool(np.any(np.abs(shifted) > math.radians(1.0))) or "obstacle_in_path" in track.reason
    return Outcome(seed, ending, clearance_m, settled_s, avoided, float(seen.mean()))


def outcome(
    seed: int,
    count: int,
    *,
    clear_m: float = CLEAR_M,
    avoid: bool = True,
    search: bool = True,
    profile: str = "anticipate",
) -> Outcome:
    """The world of that seed, played and judged. avoid: False leaves the law alone among the same obstacles."""

    def configure(config: coordinator.CoordinatorConfig) -> None:
        law = config.control
        avoidance, looking = law.avoidance, law.search
        avoidance.enabled, looking.search_by_rotating = avoid, avoid and search
        law.avoidance, law.search = avoidance, looking
        config.control = law

    return judge(seed, play(world_spec(seed, count, clear_m), configure, profile))

"""Where robots stand in a named shape, behind a leader at the origin that looks along x (x forward, y left)."""

from __future__ import annotations

import math
from dataclasses import dataclass

Place = tuple[float, float]  # (x_m, y_m) in the frame of the leader in front

SHAPES = ("column", "chain", "echelon", "wedge", "diamond", "line_abreast", "star", "tree")
# In these shapes the leader of each robot is a part of the shape; in the others the rule of watching.py says it.
EXPLICIT = ("chain", "star", "tree")

DEFAULT_ANGLE_DEG = {"echelon": 20.0, "wedge": 20.0, "diamond": 20.0, "star": 20.0}
ABREAST_BEARING_RAD = math.radians(18.0)  # at which the outermost robots of a line abreast see the leader by default


@dataclass(frozen=True)
class Branch:
    """One robot of a tree: whom it follows, at which distance and bearing."""

    leader: str
    distance_m: float
    bearing_rad: float


@dataclass(frozen=True)
class Shape:
    """A named shape and its sizes. ``angle_rad``: in an echelon the bearing of the robot in front; in a wedge and a
    diamond half the opening; in a star between two neighbours."""

    name: str
    spacing_m: float
    angle_rad: float = 0.0
    depth_m: float | None = None  # of a line abreast behind its leader; None: as wide as it has to be
    tree: tuple[Branch, ...] = ()


def robot_names(count: int) -> tuple[str, ...]:
    """("leader", "robot1", ...): ``count`` in all."""
    return ("leader", *(f"robot{k}" for k in range(1, count)))


def places(shape: Shape, count: int) -> dict[str, Place]:
    """The place of each of ``count`` robots by name, the leader's first. A diamond needs a square number of robots, a
    tree as many as it has branches and one more; ValueError otherwise."""
    followers = count - 1
    behind = {
        "column": _column,
        "chain": _column,
        "echelon": _echelon,
        "wedge": _wedge,
        "diamond": _diamond,
        "line_abreast": _line_abreast,
        "star": _star,
        "tree": _tree,
    }[shape.name](shape, followers)
    return dict(zip(robot_names(count), [(0.0, 0.0), *behind], strict=True))


def explicit_leaders(shape: Shape, count: int) -> dict[str, str]:
    """Who follows whom where the shape itself says it; empty where it does not."""
    names = robot_names(count)
    if shape.name == "star":
        return dict.fromkeys(names[1:], names[0])
    if shape.name == "chain":
        return dict(zip(names[1:], names[:-1], strict=True))
    return {name: branch.leader for name, branch in zip(names[1:], shape.tree, strict=False)}


def abreast_depth_m(shape: Shape, followers: int) -> float:
    """How far a line abreast is behind its leader: as said, or so far that the outermost robots, at
    y = +-(m - 1)/2 spacing, see it at ABREAST_BEARING_RAD; no less than the spacing."""
    outermost_m = (followers - 1) / 2 * shape.spacing_m
    return shape.depth_m or max(shape.spacing_m, outermost_m / math.tan(ABREAST_BEARING_RAD))


def _column(shape: Shape, followers: int) -> list[Place]:
    return [(-k * shape.spacing_m, 0.0) for k in range(1, followers + 1)]


def _echelon(shape: Shape, followers: int) -> list[Place]:
    """Each sees the one before it at the bearing a: that one is at d (cos a, sin a) from it."""
    step = shape.spacing_m * math.cos(shape.angle_rad), shape.spacing_m * math.sin(shape.angle_rad)
    return [(-k * step[0], -k * step[1]) for k in range(1, followers + 1)]


def _wedge(shape: Shape, followers: int) -> list[Place]:
    """The arms fill in turn, the left one first."""
    step = shape.spacing_m * math.cos(shape.angle_rad), shape.spacing_m * math.sin(shape.angle_rad)
    ranks = [((k + 1) // 2, 1 if k % 2 else -1) for k in range(1, followers + 1)]
    return [(-rank * step[0], side * rank * step[1]) for rank, side in ranks]


def _diamond(shape: Shape, followers: int) -> list[Place]:
    """A lattice of m x m seen over its corner: (i, j) lies -(i + j) s cos a ahead and (i - j) s sin a to the left.
    From the front to the rear, each row from left to right."""
    side = math.isqrt(followers + 1)
    if side * side != followers + 1:
        raise ValueError(f"{followers + 1} robots make no diamond; allowed: 4, 9, 16, 25")
    cells = sorted(((i, j) for i in range(side) for j in range(side)), key=lambda cell: (sum(cell), -cell[0]))
    along, across = shape.spacing_m * math.cos(shape.angle_rad), shape.spacing_m * math.sin(shape.angle_rad)
    return [(-(i + j) * along, (i - j) * across) for i, j in cells[1:]]


def _line_abreast(shape: Shape, followers: int) -> list[Place]:
    """Side by side, from left to right, behind a leader in front: a robot beside another one cannot see it."""
    depth_m = abreast_depth_m(shape, followers)
    return [(-depth_m, ((followers - 1) / 2 - k) * shape.spacing_m) for k in range(followers)]


def _star(shape: Shape, followers: int) -> list[Place]:
    """On an arc around the leader, from left to right: whoever stands on the left sees it on the right."""
    bearings = [(k - (followers - 1) / 2) * shape.angle_rad for k in range(followers)]
    return [(-shape.spacing_m * math.cos(b), -shape.spacing_m * math.sin(b)) for b in bearings]


def _tree(shape: Shape, followers: int) -> list[Place]:
    if len(shape.tree) != followers:
        raise ValueError(f"{followers + 1} robots need {followers} branches of `tree:`, there are {len(shape.tree)}")
    names, known = robot_names(followers + 1), {"leader": (0.0, 0.0)}
    for name, branch in zip(names[1:], shape.tree, strict=True):
        if branch.leader not in known:
            raise ValueError(f"{name} follows '{branch.leader}', which is not before it: {', '.join(known)}")
        x_m, y_m = known[branch.leader]
        ahead = branch.distance_m * math.cos(branch.bearing_rad), branch.distance_m * math.sin(branch.bearing_rad)
        known[name] = (x_m - ahead[0], y_m - ahead[1])
    return list(known.values())[1:]

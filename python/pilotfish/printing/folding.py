"""Which tags of a body can be printed on one sheet that is folded between them, and where they lie on it.

Two tags with the planes a and b adjoin if the line in which the planes meet runs along a side of either tag, just
outside of its white border. Turning plane b about that line until it lies in plane a unfolds it. Tags in one plane
adjoin along the line in the middle between them, without a fold.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

SIDES = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])  # right, down, left, up, as one reads the tag
_FLAT_RAD = math.radians(0.05)
_ALONG = math.cos(math.radians(0.2))  # the cosine from which two directions count as parallel
_NEARER_M = 0.001  # than the end of a white border a fold may be: leader files are rounded, and measured
_FARTHER = 0.3  # a fold may be farther than that, by this part of the tag's half side with its border


@dataclass(frozen=True)
class Joint:
    """A line between two panels. side_a, side_b: index into SIDES; reach_a_m, reach_b_m: from the tag's centre to it;
    angle_rad: b is folded by it away from who reads the sheet (negative: towards; 0: no fold); aTb (2, 3): from
    coordinates in b's plane (x right, y down) to those in a's, unfolded."""

    a: int
    b: int
    side_a: int
    side_b: int
    reach_a_m: float
    reach_b_m: float
    angle_rad: float
    aTb: np.ndarray

    @property
    def gap_m(self) -> float:
        """How far apart the tags' centres are along the sheet."""
        return self.reach_a_m + self.reach_b_m


@dataclass(frozen=True)
class Panel:
    """The part of a net that carries one tag: index of the tag, centre_m (2,) and axes (2, 2) in the net (columns: its
    right and its down), reach_m (4,): from its centre to the four SIDES."""

    tag: int
    centre_m: np.ndarray
    axes: np.ndarray
    reach_m: np.ndarray

    def corners_m(self) -> np.ndarray:
        """(4, 2), clockwise from the top left as one reads it."""
        right, down, left, up = self.reach_m
        corners = np.array([[-left, -up], [right, -up], [right, down], [-left, down]])
        return self.centre_m + corners @ self.axes.T

    def side_m(self, side: int) -> np.ndarray:
        """(2, 2): both ends of one side."""
        corners = self.corners_m()
        first = {3: 0, 0: 1, 1: 2, 2: 3}[side]
        return corners[[first, (first + 1) % 4]]


@dataclass(frozen=True)
class Net:
    """Panels in one plane, joined by ``folds``; ``edges`` are joints to another panel, of this or another net, that are
    not on the sheet: there both are cut and put together."""

    panels: list[Panel]
    folds: list[Joint] = field(default_factory=list)
    edges: list[Joint] = field(default_factory=list)


def find_joint(oMa: np.ndarray, oMb: np.ndarray, half_a_m: float, half_b_m: float) -> Joint | None:
    """How two tags adjoin, or None. oMa, oMb: (4, 4), tag frames to the body's; half: half sides with the white border.

    The joint's tags are numbered 0 and 1.
    """
    direction = np.cross(oMa[:3, 2], oMb[:3, 2])
    angle = math.atan2(float(np.linalg.norm(direction)), float(oMa[:3, 2] @ oMb[:3, 2]))
    if angle < _FLAT_RAD:
        return _flat_joint(oMa, oMb, half_a_m, half_b_m)
    if angle > math.radians(179.0):
        return None
    direction /= np.linalg.norm(direction)
    # A point on both planes, and nearest to the two centres along the line.
    normals = np.array([oMa[:3, 2], oMb[:3, 2], direction])
    centres = oMa[:3, 3], oMb[:3, 3]
    between = (centres[0] + centres[1]) / 2
    point = np.linalg.solve(normals, [normals[0] @ centres[0], normals[1] @ centres[1], direction @ between])
    sides = _side_towards(oMa, point, direction), _side_towards(oMb, point, direction)
    if sides[0] is None or sides[1] is None:
        return None
    (side_a, reach_a), (side_b, reach_b) = sides
    if not (_reaches(reach_a, half_a_m) and _reaches(reach_b, half_b_m)):
        return None
    # About the line, by the angle that turns z_b into z_a.
    turn = _rotation(direction, -angle)
    aMb = np.linalg.inv(oMa) @ _about(turn, point) @ oMb
    away = float(oMa[:3, 2] @ (centres[1] - centres[0])) > 0.0
    return _joint(aMb, side_a, side_b, reach_a, reach_b, angle if away else -angle, half_a_m + half_b_m)


def make_nets(
    poses: Sequence[np.ndarray], halves_m: Sequence[float], fits: Callable[[Net], bool], *, join: bool = True
) -> list[Net]:
    """The tags of a body on as few sheets as this finds: neighbours are joined, the nearest first, while the net
    ``fits``.

    poses: oMt (4, 4) of every tag; halves_m: half of its side with the white border; join: False for one sheet a tag.
    """
    joints = _one_a_side(poses, halves_m)
    reach = [np.full(4, half) for half in halves_m]
    for joint in joints:
        if joint.angle_rad != 0.0 or join:  # tags in one plane have an edge in common only if they stay together
            reach[joint.a][joint.side_a], reach[joint.b][joint.side_b] = joint.reach_a_m, joint.reach_b_m
    groups = [Net([Panel(k, np.zeros(2), np.eye(2), reach[k])]) for k in range(len(poses))]
    kept: list[Joint] = []
    for joint in joints if join else []:
        a, b = (next(net for net in groups if any(p.tag == tag for p in net.panels)) for tag in (joint.a, joint.b))
        if a is b:
            continue  # would close a ring: it is cut there
        merged = _merged(a, b, joint)
        if not _overlaps(merged) and fits(merged):
            groups = [net for net in groups if net is not a and net is not b] + [merged]
            kept.append(joint)
    others = [joint for joint in joints if joint not in kept and joint.angle_rad != 0.0]
    for net in groups:
        tags = {panel.tag for panel in net.panels}
        net.edges.extend(joint for joint in others if tags & {joint.a, joint.b})
    return sorted(groups, key=lambda net: min(panel.tag for panel in net.panels))


def _flat_joint(oMa: np.ndarray, oMb: np.ndarray, half_a_m: float, half_b_m: float) -> Joint | None:
    aMb = np.linalg.inv(oMa) @ oMb
    if abs(aMb[2, 3]) > _NEARER_M:
        return None
    towards = aMb[:2, 3]
    side_a = int(np.argmax(SIDES @ towards))
    gap = float(SIDES[side_a] @ towards) - half_a_m - half_b_m
    if not -_NEARER_M <= gap <= 2 * _FARTHER * min(half_a_m, half_b_m):
        return None
    side_b = int(np.argmax(SIDES @ (aMb[:2, :2].T @ -SIDES[side_a])))
    return _joint(aMb, side_a, side_b, half_a_m + gap / 2, half_b_m + gap / 2, 0.0, half_a_m + half_b_m)


def _joint(
    aMb: np.ndarray, side_a: int, side_b: int, reach_a: float, reach_b: float, angle: float, halves_m: float
) -> Joint | None:
    """None if b would not lie square to a and beyond the line, beside a."""
    axes, centre = aMb[:2, :2], aMb[:2, 3]
    square = np.round(axes)
    if np.abs(axes - square).max() > math.radians(0.2) or round(float(np.linalg.det(square))) != 1:
        return None
    outward = SIDES[side_a]
    across = np.array([-outward[1], outward[0]])
    if abs(outward @ centre - reach_a - reach_b) > _NEARER_M or abs(across @ centre) > 0.9 * halves_m:
        return None
    if square @ SIDES[side_b] @ outward > -0.5:
        return None
    return Joint(0, 1, side_a, side_b, reach_a, reach_b, angle, np.column_stack([square, centre]))


def _side_towards(oMt: np.ndarray, point: np.ndarray, direction: np.ndarray) -> tuple[int, float] | None:
    """The side of the tag that the line runs along, and how far from the centre; None if it runs askew."""
    towards = (oMt[:3, :2].T @ (point - oMt[:3, 3]))[:2]
    along = oMt[:3, :2].T @ direction
    if np.abs(along).max() < _ALONG:
        return None
    across = 1 - int(np.argmax(np.abs(along)))
    side = across if towards[across] > 0 else across + 2
    return side, float(abs(towards[across]))


def _reaches(reach_m: float, half_m: float) -> bool:
    return half_m - _NEARER_M <= reach_m <= (1 + _FARTHER) * half_m


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' formula: (3, 3) about a unit vector."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K


def _about(rotation: np.ndarray, point: np.ndarray) -> np.ndarray:
    moved = np.eye(4)
    moved[:3, :3], moved[:3, 3] = rotation, point - rotation @ point
    return moved


def _one_a_side(poses: Sequence[np.ndarray], halves_m: Sequence[float]) -> list[Joint]:
    """All joints, the nearest first, at most one at each side of a tag."""
    found = []
    for a in range(len(poses)):
        for b in range(a + 1, len(poses)):
            joint = find_joint(poses[a], poses[b], halves_m[a], halves_m[b])
            if joint is not None:
                ends = joint.side_a, joint.side_b, joint.reach_a_m, joint.reach_b_m
                found.append(Joint(a, b, *ends, joint.angle_rad, joint.aTb))
    taken: set[tuple[int, int]] = set()
    chosen = []
    for joint in sorted(found, key=lambda joint: (round(joint.gap_m, 6), joint.b - joint.a, joint.a)):
        ends = {(joint.a, joint.side_a), (joint.b, joint.side_b)}
        if not ends & taken:
            taken |= ends
            chosen.append(joint)
    return chosen


def _merged(a: Net, b: Net, joint: Joint) -> Net:
    """Net a with all of net b, moved to where the joint says."""
    if any(panel.tag == joint.b for panel in a.panels):
        a, b = b, a
        axes = joint.aTb[:, :2].T
        joint_T = np.column_stack([axes, -axes @ joint.aTb[:, 2]])
        here, there = joint.b, joint.a
    else:
        joint_T, here, there = joint.aTb, joint.a, joint.b
    at = next(panel for panel in a.panels if panel.tag == here)
    of = next(panel for panel in b.panels if panel.tag == there)
    # netTb: from net b's plane to net a's, by way of the two panels.
    axes = at.axes @ joint_T[:, :2] @ of.axes.T
    shift = at.centre_m + at.axes @ joint_T[:, 2] - axes @ of.centre_m
    moved = [Panel(p.tag, axes @ p.centre_m + shift, axes @ p.axes, p.reach_m) for p in b.panels]
    return Net([*a.panels, *moved], [*a.folds, *b.folds, joint])


def _overlaps(net: Net) -> bool:
    boxes = [(panel.corners_m().min(axis=0), panel.corners_m().max(axis=0)) for panel in net.panels]
    tolerance = 2 * _NEARER_M
    return any(
        bool((np.minimum(high_a, high_b) - np.maximum(low_a, low_b) > tolerance).all())
        for k, (low_a, high_a) in enumerate(boxes)
        for low_b, high_b in boxes[:k]
    )

"""Who watches whom.

**The rule.** A robot watches the nearest robot in front of it (farther ahead along the leader's x axis) that

1. is not nearer than the coordinator allows: the nearest visible distance, ``control.guard.minimum_distance_m`` and
   ``safety.stop_distance_m``; nor farther than a tag is found;
2. shows a whole tag in the picture, all corners of its paper;
3. is not hidden: no straight line from the camera to that tag crosses the box or the tags of a third robot.

Of two that are equally near it watches the one that it sees farther from the edge of the picture, and of these the one
that comes first. A coordinator knows one leader from start to end, so in a formation that changes its shape the robot
has to fulfil that in every shape, and is the nearest one in the first. In a chain, a star and a tree the shape says who
is watched; what has to be fulfilled is the same.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pilotfish.formation.shapes import Place
from pilotfish.formation.sight import Outlook, Pose, bearing_range_rad, seen_from, sees

_TIE_M = 1e-6


@dataclass(frozen=True)
class Watch:
    """Which robot a robot follows, and the setpoint that keeps it in its place: d_p [m], theta_pd [rad]."""

    leader: str
    distance_m: float
    bearing_rad: float


@dataclass(frozen=True)
class Bounds:
    """Distances at which a leader can be kept [m], and what sets the lower one."""

    nearest_m: float
    farthest_m: float
    why_nearest: str


def refusal(
    outlook: Outlook, bounds: Bounds, places: Mapping[str, Place], robot: str, leader: str
) -> tuple[str, str] | None:
    """None if ``robot`` can watch ``leader`` from where both stand; otherwise what is at fault ("distance", "bearing",
    "hidden") and why, with what would be allowed."""
    if can_watch(outlook, bounds, places, robot, leader):
        return None
    watch = watch_of(places, robot, leader)
    bearing_deg = math.degrees(watch.bearing_rad)
    seen = f"{robot} would watch {leader} at {watch.distance_m:.2f} m, {bearing_deg:.1f} deg"
    if watch.distance_m < bounds.nearest_m - _TIE_M:
        return "distance", f"{seen}: nearer than {bounds.nearest_m:.2f} m, {bounds.why_nearest}"
    if watch.distance_m > bounds.farthest_m:
        return "distance", f"{seen}: farther than {bounds.farthest_m:.2f} m, up to which its tags are found"
    target, others = _seen(places, robot, leader), _others(places, robot, leader)
    if sees(outlook, target):
        hiding = [name for name, pose in others.items() if not sees(outlook, target, [pose])]
        return "hidden", f"{seen}: hidden behind {' and '.join(hiding) or 'the others'}"
    allowed = bearing_range_rad(outlook, watch.distance_m)
    if allowed is None:
        return "bearing", f"{seen}: none of its tags is in the picture there, at any bearing"
    low, high = (math.degrees(edge) for edge in allowed)
    return "bearing", f"{seen}: outside the picture; at that distance a tag is in it from {low:.1f} to {high:.1f} deg"


def can_watch(outlook: Outlook, bounds: Bounds, places: Mapping[str, Place], robot: str, leader: str) -> bool:
    """Whether ``robot`` sees ``leader`` at a distance at which it can be kept."""
    distance_m = watch_of(places, robot, leader).distance_m
    if not bounds.nearest_m - _TIE_M <= distance_m <= bounds.farthest_m:
        return False
    return sees(outlook, _seen(places, robot, leader), _others(places, robot, leader).values())


def choose(outlook: Outlook, bounds: Bounds, stages: Sequence[Mapping[str, Place]], robot: str) -> str | list[str]:
    """The robot that ``robot`` watches by the rule; or, if there is none, why not, robot by robot."""
    first = stages[0]
    in_front = [name for name in first if name != robot and first[name][0] > first[robot][0] + _TIE_M]
    in_front.sort(key=lambda name: watch_of(first, robot, name).distance_m)
    fit: list[str] = []
    for name in in_front:
        if not all(can_watch(outlook, bounds, places, robot, name) for places in stages):
            continue
        if fit and watch_of(first, robot, name).distance_m > watch_of(first, robot, fit[0]).distance_m + _TIE_M:
            break
        fit.append(name)
    if not fit:
        refused = [refusal(outlook, bounds, places, robot, name) for name in in_front for places in stages]
        return [problem[1] for problem in refused if problem] or [f"no robot is in front of {robot}"]
    order = list(first)
    middle = outlook.viewer.mounting.pan_rad
    off_middle = {name: abs(watch_of(first, robot, name).bearing_rad - middle) for name in fit}
    return min(fit, key=lambda name: (round(off_middle[name], 6), order.index(name)))


def watch_of(places: Mapping[str, Place], robot: str, leader: str) -> Watch:
    """The setpoint: with all robots looking along x, theta = atan2(dy, dx) and d = hypot(dx, dy)."""
    x_m, y_m, _ = _seen(places, robot, leader)
    return Watch(leader, math.hypot(x_m, y_m), math.atan2(y_m, x_m))


def _others(places: Mapping[str, Place], robot: str, leader: str) -> dict[str, Pose]:
    return {name: _seen(places, robot, name) for name in places if name not in (robot, leader)}


def _seen(places: Mapping[str, Place], robot: str, other: str) -> Pose:
    return seen_from((*places[robot], 0.0), (*places[other], 0.0))

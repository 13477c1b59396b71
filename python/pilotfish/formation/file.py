"""A formation file: read, checked, and turned into places and setpoints."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pilotfish import data
from pilotfish.coordinator import CoordinatorConfig, load_coordinator
from pilotfish.errors import ConfigError, MissingFileError
from pilotfish.formation import shapes
from pilotfish.formation.keys import Keys, config_error, read_mapping
from pilotfish.formation.otherwise import Dropout, Otherwise, read_dropouts, read_otherwise
from pilotfish.formation.shapes import Branch, Place, Shape
from pilotfish.formation.sight import Outlook
from pilotfish.formation.watching import Bounds, Watch, choose, refusal, watch_of
from pilotfish.leader import Viewer

MAX_ROBOTS = 25
BOX_M = (0.24, 0.30, 0.30)  # length, width, height of every robot's box, as in the shipped scenarios
TRAJECTORY = {"kind": "line", "speed_mps": 0.2, "acceleration_mps2": 0.5}
MAX_BEARING_DEG = 70.0  # core/setpoint.hpp
_FAR_M = 20.0
_LEAST_STAGE_S = 0.1


@dataclass(frozen=True)
class Stage:
    """A shape from ``at_s`` on; setpoints go there within ``over_s`` (0: at once)."""

    at_s: float
    over_s: float
    shape: Shape
    places: Mapping[str, Place]  # [m], in the frame of the leader in front
    watches: Mapping[str, Watch]  # by the name of each robot that follows


@dataclass(frozen=True)
class Formation:
    """A formation file, read and checked."""

    file: Path
    name: str
    description: str
    stages: tuple[Stage, ...]
    duration_s: float
    frame_rate_hz: float
    seed: int
    tolerance_m: float  # within which the formation counts as formed
    trajectory: Mapping[str, Any]  # of the leader in front, as in a scenario
    drive: Mapping[str, Any]  # entries of a scenario's section of that name that replace the usual ones
    camera: Mapping[str, Any]
    hardware: Path | None
    headway_s: float
    coordinator_file: Path
    outlook: Outlook
    otherwise: Otherwise
    dropouts: tuple[Dropout, ...]

    @property
    def robots(self) -> tuple[str, ...]:
        """Names of all, the leader's first."""
        return tuple(self.stages[0].places)

    @property
    def leaders(self) -> dict[str, str]:
        """Who follows whom."""
        return {robot: watch.leader for robot, watch in self.stages[0].watches.items()}


def is_formation(file: str | Path) -> bool:
    """Whether the file is a mapping with the keys ``shape`` and ``robots`` and so no scenario."""
    try:
        content = read_mapping(Path(file))
    except ConfigError:
        return False
    return "shape" in content


def formations() -> dict[str, Path]:
    """The shipped formations by name."""
    return {file.stem: file for file in sorted((data.root() / "formations").glob("*.yaml"))}


def find_formation(name: str | Path) -> Path:
    """A file of one's own, or the shipped formation of that name. MissingFileError lists those there are."""
    own, known = Path(name), formations()
    if own.is_file():
        return own
    stem = own.stem if own.suffix == ".yaml" else str(name)
    if stem in known and len(own.parts) == 1:
        return known[stem]
    raise MissingFileError(f"no formation '{name}'{data.did_you_mean(stem, known)}; shipped are: {', '.join(known)}")


def load_formation(file: str | Path) -> Formation:
    """The formation of a file. ConfigError names file, key, value and what is allowed."""
    file = Path(file)
    if not file.is_file():
        raise MissingFileError(f"no formation file {file}")
    return read_formation(read_mapping(file), file)


def read_formation(content: Mapping[str, Any], file: Path) -> Formation:
    """The same of a mapping; ``file`` is what relative paths count from, and what errors name."""
    keys = Keys(content, file)
    name = keys.text("name")
    if not name.isidentifier() or len(name) > 60:
        raise keys.error("name", f"'{name}' is not one word of letters, digits and underscores")
    first, count = _read_first(keys)
    duration_s = keys.number("duration_s", 30.0, 1.0, 1e4)
    coordinator_file = _path(keys, "coordinator", file) or data.path("config/coordinator.yaml")
    config = _coordinator(keys, coordinator_file)
    outlook = Outlook(Viewer(config.camera, config.mounting, config.vision), config.leader, BOX_M[:2])
    bounds = _bounds(config, outlook)
    timed = [(0.0, 0.0, first, ""), *_read_changes(keys, first, count, duration_s)]
    stages = _stages(timed, count, outlook, bounds, file)
    leaders = {robot: watch.leader for robot, watch in stages[0].watches.items()}
    otherwise = read_otherwise(keys, stages[0].places, leaders, outlook, bounds)
    if otherwise.watches and len(stages) > 1:
        raise keys.error(
            "otherwise", "cannot stand beside `changes`, whose setpoints are of one leader; keep one of them"
        )
    formation = Formation(
        file=file,
        name=name,
        description=keys.text("description", f"{count} robots: {first.name.replace('_', ' ')}"),
        stages=stages,
        duration_s=duration_s,
        frame_rate_hz=keys.number("frame_rate_hz", 30.0, 1.0, 1000.0),
        seed=keys.integer("seed", 1, 0, 2**31 - 1),
        tolerance_m=keys.number("tolerance_m", 0.005, 1e-4, 1.0),
        trajectory=keys.mapping("trajectory", TRAJECTORY),
        drive=keys.mapping("drive", {}),
        camera=keys.mapping("camera", {}),
        hardware=_path(keys, "hardware", file),
        headway_s=keys.number("headway_s", 0.0, 0.0, 3.0),
        coordinator_file=coordinator_file,
        outlook=outlook,
        otherwise=otherwise,
        dropouts=read_dropouts(keys, stages[0].places, duration_s),
    )
    keys.finish()
    return formation


def _read_first(keys: Keys) -> tuple[Shape, int]:
    shape = keys.text("shape", choices=shapes.SHAPES)
    tree = _read_tree(keys, shape)
    if shape == "tree":
        if not tree:
            raise keys.error("tree", "is missing: a list of {leader, distance_m, bearing_deg}, one for each follower")
        count = keys.integer("robots", len(tree) + 1, 2, MAX_ROBOTS)
        return Shape(shape, 1.0, tree=tree), count
    count = keys.integer("robots", None, 2, MAX_ROBOTS)
    spacing_m = keys.number("spacing_m", None, 0.1, _FAR_M)
    return _read_sizes(keys, Shape(shape, spacing_m)), count


def _read_sizes(keys: Keys, shape: Shape) -> Shape:
    """Angle and depth, for the shapes that have one."""
    if shape.name in shapes.DEFAULT_ANGLE_DEG:
        default = shapes.DEFAULT_ANGLE_DEG[shape.name]
        low = -MAX_BEARING_DEG if shape.name == "echelon" else 1.0
        shape = replace(shape, angle_rad=math.radians(keys.number("angle_deg", default, low, MAX_BEARING_DEG)))
    if shape.name == "line_abreast" and keys.has("depth_m"):
        shape = replace(shape, depth_m=keys.number("depth_m", None, 0.1, _FAR_M))
    return shape


def _read_tree(keys: Keys, shape: str) -> tuple[Branch, ...]:
    if shape != "tree":
        return ()
    branches = []
    for entry in keys.mappings("tree"):
        leader = entry.text("leader")
        distance_m = entry.number("distance_m", None, 0.05, _FAR_M)
        bearing_deg = entry.number("bearing_deg", 0.0, -MAX_BEARING_DEG, MAX_BEARING_DEG)
        branches.append(Branch(leader, distance_m, math.radians(bearing_deg)))
        entry.finish()
    return tuple(branches)


def _read_changes(keys: Keys, first: Shape, count: int, duration_s: float) -> list[tuple[float, float, Shape, str]]:
    """(at_s, over_s, shape, "changes[k].") of each; what a change does not say stays as it was."""
    changes, shape, earliest_s = [], first, 0.0
    for k, entry in enumerate(keys.mappings("changes")):
        at_s = entry.number("at_s", None, _LEAST_STAGE_S, duration_s)
        if at_s < earliest_s:
            allowed = f"allowed: {earliest_s:g} to {duration_s:g}"
            raise entry.error("at_s", f"{at_s:g} is before the change before it has ended; {allowed}")
        over_s = entry.number("over_s", 0.0, 0.0, duration_s)
        name = entry.text("shape", shape.name, choices=shapes.SHAPES)
        if name == "tree":
            tree = _read_tree(entry, name) if entry.has("tree") or name != shape.name else shape.tree
            shape = Shape(name, 1.0, tree=tree)
        else:
            default_m = None if shape.name == "tree" else shape.spacing_m
            changed = Shape(name, entry.number("spacing_m", default_m, 0.1, _FAR_M))
            if name == shape.name:
                changed = replace(changed, angle_rad=shape.angle_rad, depth_m=shape.depth_m)
            if name != shape.name or entry.has("angle_deg") or entry.has("depth_m"):
                changed = _read_sizes(entry, changed)
            shape = changed
        earliest_s = at_s + max(over_s, _LEAST_STAGE_S)
        changes.append((at_s, over_s, shape, f"changes[{k}]."))
        entry.finish()
    return changes


def _stages(
    timed: list[tuple[float, float, Shape, str]], count: int, outlook: Outlook, bounds: Bounds, file: Path
) -> tuple[Stage, ...]:
    placed = []
    for _, _, shape, where in timed:
        try:
            placed.append(shapes.places(shape, count))
        except ValueError as error:
            raise config_error(f"{where}{'tree' if shape.name == 'tree' else 'robots'}", str(error), file) from error
        _check_apart(placed[-1], outlook, where, shape, file)
    leaders = _explicit(timed, count, file)
    for robot in list(placed[0])[1:]:
        if robot not in leaders:
            leaders[robot] = _chosen(timed, placed, outlook, bounds, robot, file)
    for (_, _, shape, where), places in zip(timed, placed, strict=True):
        for robot, leader in leaders.items():
            if problem := refusal(outlook, bounds, places, robot, leader):
                raise _refused(problem, shape, where, robot, places, file)
    order = list(placed[0])[1:]
    return tuple(
        Stage(at_s, over_s, shape, places, {robot: watch_of(places, robot, leaders[robot]) for robot in order})
        for (at_s, over_s, shape, _), places in zip(timed, placed, strict=True)
    )


def _explicit(timed: list[tuple[float, float, Shape, str]], count: int, file: Path) -> dict[str, str]:
    leaders: dict[str, str] = {}
    for _, _, shape, where in timed:
        for robot, leader in shapes.explicit_leaders(shape, count).items():
            if leaders.setdefault(robot, leader) != leader:
                raise config_error(
                    f"{where}shape",
                    f"{shape.name} lets {robot} follow {leader}, but it follows {leaders[robot]}: a coordinator keeps "
                    "its leader from start to end",
                    file,
                )
    return leaders


def _chosen(timed, placed, outlook: Outlook, bounds: Bounds, robot: str, file: Path) -> str:
    chosen = choose(outlook, bounds, placed, robot)
    if isinstance(chosen, str):
        return chosen
    alone = choose(outlook, bounds, placed[:1], robot)
    if isinstance(alone, str):  # the first shape is good: a change is at fault
        for (_, _, shape, where), places in zip(timed, placed, strict=True):
            if problem := refusal(outlook, bounds, places, robot, alone):
                raise _refused(problem, shape, where, robot, places, file)
        raise config_error("changes", f"{robot} cannot watch the same robot in all shapes", file)
    shape = timed[0][2]
    key = {"line_abreast": "depth_m"}.get(shape.name, "spacing_m" if not shape.angle_rad else "angle_deg")
    reasons = chosen if len(chosen) <= 3 else [*chosen[:3], f"and {len(chosen) - 3} more"]
    raise config_error(key, f"{robot} has nobody to watch. {'; '.join(reasons)}", file)


def _refused(problem, shape: Shape, where: str, robot: str, places: Mapping[str, Place], file: Path) -> ConfigError:
    kind, text = problem
    if shape.name == "tree":
        entry = f"tree[{list(places).index(robot) - 1}]."
        return config_error(f"{where}{entry}{'distance_m' if kind == 'distance' else 'bearing_deg'}", text, file)
    sized = {"line_abreast": "depth_m"}.get(shape.name, "angle_deg" if shape.angle_rad else "spacing_m")
    return config_error(f"{where}{'spacing_m' if kind == 'distance' else sized}", text, file)


def _check_apart(places: Mapping[str, Place], outlook: Outlook, where: str, shape: Shape, file: Path) -> None:
    """Any two robots are so far apart that both can turn on the spot."""
    least_m = 2.0 * outlook.radius_m
    for (a, at_a), (b, at_b) in itertools.combinations(places.items(), 2):
        if (apart_m := math.dist(at_a, at_b)) < least_m - 1e-9:
            key = {"tree": "tree", "star": "angle_deg"}.get(shape.name, "spacing_m")
            problem = (
                f"{a} and {b} would be {apart_m:.2f} m apart; allowed: {least_m:.2f} m or more, so that both can turn "
                "on the spot"
            )
            raise config_error(f"{where}{key}", problem, file)


def _bounds(config: CoordinatorConfig, outlook: Outlook) -> Bounds:
    nearest_m, found_m = outlook.reach_m
    lower = [
        (nearest_m, "the nearest distance at which the camera sees a tag"),
        (config.control.guard.minimum_distance_m, "the coordinator's control.guard.minimum_distance_m"),
        (config.safety.stop_distance_m, "the coordinator's safety.stop_distance_m"),
    ]
    return Bounds(max(lower)[0], min(found_m, _FAR_M), max(lower)[1])


def _path(keys: Keys, key: str, file: Path) -> Path | None:
    if not keys.has(key):
        return None
    path = (file.parent / keys.text(key)).resolve()
    if not path.is_file():
        raise keys.error(key, f"there is no file {path}")
    return path


def _coordinator(keys: Keys, coordinator_file: Path) -> CoordinatorConfig:
    try:
        return load_coordinator(str(coordinator_file)).coordinator
    except ValueError as error:
        raise keys.error("coordinator", str(error)) from error

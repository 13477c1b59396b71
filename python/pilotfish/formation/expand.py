"""A formation as the files that the simulator and the coordinators read: a scenario, and beside it a folder with the
configuration and the tags of each robot."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import yaml

from pilotfish.errors import ConfigError
from pilotfish.files import read_text
from pilotfish.formation.file import BOX_M, Formation, is_formation, load_formation
from pilotfish.formation.keys import config_error
from pilotfish.formation.watching import Watch
from pilotfish.harness.scenario import Scenario
from pilotfish.vision import TagFamily
from pilotfish.whole_files import write_whole

ID_STEP = 10  # the ids of a robot's tags are those of the one before plus this, or the next multiple that is enough
DRIVE = {
    "max_linear_mps": 0.6,
    "max_linear_acceleration_mps2": 1.0,
    "max_angular_radps": 2.0,
    "actuator_lag_s": 0.1,
}
CAMERA = {"latency_s": 1.0 / 30.0, "drop_probability": 0.0, "blur_sigma_px": 0.7, "noise_sigma": 3.0}
_BOX = {"box_size_m": list(BOX_M), "box_position_m": [0.0, 0.0, 0.17]}


def expand(formation: Formation, file: Path) -> Path:
    """Writes the scenario and, beside it, the folder ``<stem>_files``; the scenario's path. All paths in it are
    relative: scenario and folder can be moved together. The scenario has the formation's first shape alone; who changes
    it is ``pilotfish.formation.run``."""
    folder = file.parent / f"{file.stem}_files"
    own = _own_config(formation)
    calibration = _copy(formation, own["camera"]["calibration"], folder, "camera")
    own["camera"]["calibration"] = calibration.name
    own["fuzzy"] = _copy(formation, own["fuzzy"], folder, "fuzzy").name
    if "tuning" in own:
        own["tuning"] = _copy(formation, own["tuning"], folder, "tuning").name
    if "key_file" in own:
        own["key_file"] = str(_beside(formation, own["key_file"]))
    for robot, ids_from in tag_offsets(formation).items():
        write_whole(folder / f"{robot}_tags.yaml", _text(_tags(formation, robot, ids_from), f"The tags of {robot}."))
    for robot, watch in formation.stages[0].watches.items():
        said = f"The coordinator of {robot}, which follows {watch.leader}."
        write_whole(folder / f"{robot}.yaml", _text(_config(formation, own, robot, watch), said))
    scenario = _scenario(formation, folder.name, calibration.name, own["camera"].get("mounting", {}))
    write_whole(file, _text(scenario, f"Made from the formation {formation.name}: {formation.description}."))
    return file


def load_expanded(formation: Formation, folder: Path) -> Scenario:
    """Expands into the folder and loads the scenario. ConfigError names the key, such as one of ``trajectory``."""
    try:
        return Scenario.load(expand(formation, folder / f"{formation.name}.yaml"))
    except ConfigError as error:
        text = str(error).replace(f"{folder}/", "")
        raise ConfigError(f"{formation.file}: as a scenario: {text}") from error


@contextmanager
def scenario_of(name: str) -> Iterator[str]:
    """The scenario that ``name`` stands for: if it is a formation file, one made of it, which is gone afterwards; any
    other name as it is. ConfigError if the formation changes its shape, which no scenario can say."""
    if not (Path(name).is_file() and is_formation(name)):
        yield name
        return
    formation = load_formation(name)
    if len(formation.stages) > 1:
        raise config_error("changes", f"a scenario has none; play it with: pilotfish formation run {name}", name)
    with tempfile.TemporaryDirectory(prefix="pilotfish-") as folder:
        load_expanded(formation, Path(folder))
        yield str(Path(folder) / f"{formation.name}.yaml")


def tag_offsets(formation: Formation) -> dict[str, int]:
    """What is added to the ids of the configured body, by robot: 0 for the leader in front. ConfigError if the family
    has not enough ids."""
    body = formation.outlook.body
    highest = max(tag.id for tag in body.tags)
    step = ID_STEP * (highest // ID_STEP + 1)
    size = TagFamily(body.family).size
    most = (size - 1 - highest) // step + 1
    if len(formation.robots) > most:
        raise config_error(
            "robots",
            f"{len(formation.robots)} robots with ids of their own need more than the {size} ids of {body.family}; "
            f"allowed: 2 to {most}",
            formation.file,
        )
    return {robot: k * step for k, robot in enumerate(formation.robots)}


def _own_config(formation: Formation) -> dict[str, Any]:
    """What the coordinator's file says, as it stands: the coordinator's own reader has checked it."""
    return yaml.safe_load(read_text(formation.coordinator_file, ConfigError))


def _config(formation: Formation, own: Mapping[str, Any], robot: str, watch: Watch) -> dict[str, Any]:
    kept = {key: value for key, value in own.items() if key != "alternatives"}  # of another formation's robots
    config = {**kept, "name": robot, "source": "lcm", "leader": f"{watch.leader}_tags.yaml"}
    config["setpoint"] = _setpoint(watch)
    if others := formation.otherwise.watches.get(robot):
        config["alternatives"] = {
            "after_lost_s": formation.otherwise.after_lost_s,
            "back_after_s": formation.otherwise.back_after_s,
            "leaders": [{"leader": f"{other.leader}_tags.yaml", **_setpoint(other)} for other in others],
        }
    if formation.headway_s:
        control = dict(config.get("control") or {})
        control["spacing"] = {**control.get("spacing", {}), "headway_s": formation.headway_s}
        config["control"] = control
    return config


def _tags(formation: Formation, robot: str, ids_from: int) -> dict[str, Any]:
    body = formation.outlook.body
    tags = [
        {
            "id": tag.id + ids_from,
            "size_m": tag.size_m,
            "position_m": [float(value) for value in tag.position_m],
            "facing_rad": tag.facing_rad,
            "tilt_rad": tag.tilt_rad,
            "roll_rad": tag.roll_rad,
        }
        for tag in body.tags
    ]
    return {"name": f"{robot}_tags", "family": body.family, "tags": tags}


def _scenario(formation: Formation, files: str, calibration: str, mounting: Mapping[str, Any]) -> dict[str, Any]:
    robots = []
    for robot, (x_m, y_m) in formation.stages[0].places.items():
        entry: dict[str, Any] = {"name": robot, "start": {"x_m": x_m, "y_m": y_m, "heading_rad": 0.0}}
        watch = formation.stages[0].watches.get(robot)
        if watch is None:
            entry["trajectory"] = dict(formation.trajectory)
        else:
            camera = {"calibration": f"{files}/{calibration}", "mounting": dict(mounting)}
            entry |= {
                "follows": watch.leader,
                "drive": {**DRIVE, **formation.drive},
                "camera": {**camera, **CAMERA, **formation.camera},
                "coordinator": f"{files}/{robot}.yaml",
                "setpoint": _setpoint(watch),
            }
            if formation.hardware:
                entry["hardware"] = str(formation.hardware)
        entry["body"] = {"leader": f"{files}/{robot}_tags.yaml", **_BOX}
        for dropout in formation.dropouts:
            if dropout.robot == robot:
                entry["body"] |= {"hidden_from_s": dropout.at_s, "hidden_until_s": dropout.until_s}
        robots.append(entry)
    return {
        "name": formation.name,
        "description": formation.description,
        "duration_s": formation.duration_s,
        "frame_rate_hz": formation.frame_rate_hz,
        "seed": formation.seed,
        "robots": robots,
    }


def _setpoint(watch: Watch) -> dict[str, float]:
    return {"distance_m": watch.distance_m, "bearing_deg": math.degrees(watch.bearing_rad)}


def _beside(formation: Formation, path: str) -> Path:
    return (formation.coordinator_file.parent / path).resolve()


def _copy(formation: Formation, path: str, folder: Path, stem: str) -> Path:
    source = _beside(formation, path)
    copy = folder / f"{stem}{source.suffix}"
    write_whole(copy, read_text(source, ConfigError))
    return copy


def _text(content: Mapping[str, Any], says: str) -> str:
    return f"# {says}\n" + yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True, width=120)

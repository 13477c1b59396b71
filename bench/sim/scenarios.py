"""The scenarios that are played, as files: a robot behind a leader under three cameras, and columns of many robots."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import yaml

from bench.common.configuration import shipped_coordinator, shipped_scenario
from pilotfish import data

SPACING_M = 1.0
TAGS_PER_ROBOT = 3

# What is changed in the scenario `line` as shipped.
CONDITIONS: dict[str, dict[str, Any]] = {
    "ideal": {
        "says": "ideal camera: pinhole, sharp, no noise, plain wall",
        "pinhole": True,
        "camera": {"blur_sigma_px": 0.0, "noise_sigma": 0.0, "clutter": 0.0},
    },
    "shipped": {"says": "camera as shipped: lens, blur, noise, clutter", "pinhole": False, "camera": {}},
    "non-ideal": {
        "says": "non-ideal camera and robot: hardware/nonideal.yaml",
        "pinhole": False,
        "camera": {},
        "hardware": True,
    },
}


def following(condition: str, folder: Path) -> Path:
    """`line` under that condition: scenario, camera and coordinator in `folder`."""
    change = CONDITIONS[condition]
    folder.mkdir(parents=True, exist_ok=True)
    scenario, config = shipped_scenario("line"), shipped_coordinator()
    config["safety"] = {"noiseless_camera": change["pinhole"]}  # without noise one picture can equal the last
    robot = scenario["robots"][1]
    calibration = Path(config["camera"]["calibration"])
    if change["pinhole"]:
        pinhole = folder / "pinhole.yaml"
        pinhole.write_text(calibration.read_text().replace("[ -0.08, 0.012, 0.0004, -0.0003, 0.0 ]", "[0, 0, 0, 0, 0]"))
        calibration = pinhole
    config["camera"]["calibration"] = robot["camera"]["calibration"] = str(calibration)
    robot["camera"] |= change["camera"]
    if change.get("hardware"):
        robot["hardware"] = str(data.path("hardware/nonideal.yaml"))
    robot["coordinator"] = _written(folder / "robot1.yaml", config)
    return Path(_written(folder / "line.yaml", scenario))


def column(robots: int, folder: Path) -> Path:
    """`robots` robots behind a leader on a straight line, each following the one before it at 1 m. Each wears three
    tags of its own, as the leader does; every camera has all robots before it in its field of view."""
    folder.mkdir(parents=True, exist_ok=True)
    scenario, config = shipped_scenario("line"), shipped_coordinator()
    leader, follower = scenario["robots"]
    setpoint = {"distance_m": SPACING_M, "bearing_deg": 0.0}
    body = yaml.safe_load(data.path("leaders/three_faces.yaml").read_text())
    box = {key: value for key, value in leader["body"].items() if key != "leader"}
    follower["camera"]["calibration"] = config["camera"]["calibration"]
    everyone = []
    for k in range(robots + 1):
        name = f"robot{k}" if k else "leader"
        tags = {**body, "name": f"{name}_tags"}
        tags["tags"] = [{**tag, "id": tag["id"] + k * TAGS_PER_ROBOT} for tag in body["tags"]]
        worn = _written(folder / f"{name}_tags.yaml", tags)
        entry = copy.deepcopy(follower if k else leader)
        entry |= {"name": name, "start": {"x_m": -k * SPACING_M, "y_m": 0.0}, "body": {**box, "leader": worn}}
        if k:
            before = everyone[-1]
            own = {**config, "name": name, "leader": before["body"]["leader"], "setpoint": setpoint}
            entry |= {"follows": before["name"], "setpoint": setpoint}
            entry["coordinator"] = _written(folder / f"{name}.yaml", own)
        everyone.append(entry)
    scenario |= {"name": "column", "description": f"{robots} robots in a column", "robots": everyone}
    return Path(_written(folder / "column.yaml", scenario))


def _written(file: Path, content: dict[str, Any]) -> str:
    file.write_text(yaml.safe_dump(content, sort_keys=False))
    return str(file.resolve())

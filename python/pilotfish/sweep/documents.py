"""A scenario with everything it names, as data: it can be varied key by key, and sent to another computer as contents.

What a file names (calibration, leader, fuzzy sets, tuning) is replaced by a name made of its content. Scalars stay the
texts that they are in the files, so that a number keeps its bits until the program's own readers read it.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from pilotfish.errors import ConfigError
from pilotfish.files import read_text
from pilotfish.harness.driving import BASELINES, Driving

ROBOT_FILES = ("camera.calibration", "body.leader")
CONFIG_FILES = ("camera.calibration", "leader", "fuzzy", "tuning")
SCENARIO_FILE = "scenario.yaml"
MAX_YAML_BYTES = 1_000_000

_PLAIN = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)|true|false")


@dataclass
class Documents:
    """What a simulation is made of. Hardware files are merged into the robots, as the program's reader does it."""

    scenario: dict[str, Any]
    configs: dict[str, dict[str, Any]]  # of each robot that follows, by its name
    files: dict[str, str]  # contents by the names that stand in the others
    tunings: dict[str, str]  # shipped ones: names in `files`, by the law

    def robot(self, name: str) -> dict[str, Any]:
        """The scenario's entry of a robot. KeyError if there is none."""
        return {robot["name"]: robot for robot in self.robots()}[name]

    def robots(self) -> list[dict[str, Any]]:
        """The scenario's entries, in the order of the file."""
        return self.scenario["robots"]

    def names(self) -> list[str]:
        """The robots' names."""
        return [robot["name"] for robot in self.robots()]

    def add_file(self, file: Path) -> str:
        """Keeps the content of a file; the name under which it is kept."""
        text = read_text(file)
        suffix = ".fll" if file.suffix == ".fll" else ".txt"  # readers know FLL by its name's end, all else by content
        name = hashlib.sha256(text.encode()).hexdigest()[:16] + suffix
        self.files[name] = text
        return name

    def write_files(self, folder: Path) -> None:
        """The contents, under their names."""
        for name, text in self.files.items():
            (folder / name).write_text(text, encoding="utf-8")

    def write(self, folder: Path) -> Path:
        """Scenario and configurations beside the files; the path of the scenario."""
        robots = []
        for robot in self.robots():
            if robot["name"] in self.configs:
                config_file = f"config-{robot['name']}.yaml"
                (folder / config_file).write_text(to_yaml(self.configs[robot["name"]]), encoding="utf-8")
                robot = {**robot, "coordinator": config_file}
            robots.append(robot)
        file = folder / SCENARIO_FILE
        file.write_text(to_yaml({**self.scenario, "robots": robots}), encoding="utf-8")
        return file


def read_documents(file: Path) -> Documents:
    """Of a scenario that the program's own reader has accepted."""
    documents = Documents({}, {}, {}, {})
    documents.scenario = _scenario(file, documents)
    for law in BASELINES:
        if tuning := Driving(law).tuning_file:
            documents.tunings[law] = documents.add_file(tuning)
    return documents


def _scenario(file: Path, documents: Documents) -> dict[str, Any]:
    """As the program reads it: what it is like, then its own keys upon that, then its hardware upon the robots."""
    own = _mapping(file)
    like = own.pop("like", None)
    base = _scenario(file.parent / like, documents) if like else {}
    hardware = own.pop("hardware", None)
    if "robots" in own:
        own["robots"] = [_robot(robot, file.parent, documents) for robot in own["robots"]]
    merged = base | own
    if hardware:
        apply_hardware(merged["robots"], _mapping(file.parent / hardware))
    return merged


def _robot(robot: dict[str, Any], folder: Path, documents: Documents) -> dict[str, Any]:
    _keep_files(robot, ROBOT_FILES, folder, documents)
    if hardware := robot.pop("hardware", None):
        apply_hardware([robot], _mapping(folder / hardware), every=True)
    if config := robot.pop("coordinator", None):
        own = _mapping(folder / config)
        _keep_files(own, CONFIG_FILES, (folder / config).parent, documents)
        documents.configs[robot["name"]] = own
    return robot


def _keep_files(owner: dict[str, Any], keys: tuple[str, ...], folder: Path, documents: Documents) -> None:
    for key in keys:
        *sections, last = key.split(".")
        section = owner
        for name in sections:
            section = section.get(name) or {}
        if section.get(last):
            section[last] = documents.add_file(folder / section[last])


def apply_hardware(robots: list[dict[str, Any]], hardware: Mapping[str, Any], every: bool = False) -> None:
    """What a hardware file says counts in place of what a robot that follows says; of every robot, if asked."""
    for robot in robots:
        if not (every or robot.get("follows")):
            continue
        for section in ("drive", "camera"):
            if section == "camera" and "camera" not in robot:
                continue
            for key, value in (hardware.get(section) or {}).items():
                put(robot.setdefault(section, {}), key, value)


def put(section: dict[str, Any], key: str, value: Any) -> None:
    """Sets a key; None removes it. An angle may stand in degrees or in radians, but not in both."""
    for ours, other in (("_deg", "_rad"), ("_rad", "_deg")):
        if key.endswith(ours):
            section.pop(key.removesuffix(ours) + other, None)
    section.pop(key, None)
    if value is not None:
        section[key] = value


def yaml_text(file: Path) -> str:
    """Of a file that may be YAML: PyYAML takes a minute for what is larger."""
    if file.is_file() and file.stat().st_size > MAX_YAML_BYTES:
        raise ConfigError(f"{file}: larger than {MAX_YAML_BYTES // 1000} kB: not a file of this kind")
    return read_text(file)


def _mapping(file: Path) -> dict[str, Any]:
    """YAML with every scalar as the text that it is."""
    try:
        read = yaml.load(yaml_text(file), yaml.BaseLoader)
    except yaml.YAMLError as error:
        raise ConfigError(f"{file}: not YAML: {error}") from error
    if not isinstance(read, dict):
        raise ConfigError(f"{file}: not a YAML mapping (key: value)")
    return read


def to_yaml(value: Any) -> str:
    """One line of YAML (flow style). Texts that are numbers or truth values stay without quotes."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(str(key))}: {to_yaml(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(to_yaml, value)) + "]"
    text = scalar_text(value)
    return text if text and _PLAIN.fullmatch(text) else json.dumps(text)


def scalar_text(value: Any) -> str:
    """As YAML writes it; a float with all its bits."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        text = repr(value)
        return {"inf": ".inf", "-inf": "-.inf", "nan": ".nan"}.get(text, text)
    return str(value)

"""The dotted keys of a campaign: what each sets, and which of them would have no effect."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from pilotfish import data
from pilotfish.data import did_you_mean
from pilotfish.errors import ConfigError
from pilotfish.harness.driving import BASELINES, PROFILES, Driving
from pilotfish.sweep.documents import CONFIG_FILES, ROBOT_FILES, Documents, apply_hardware, put

DEFAULT_LAW = "anticipate"
ROOTS = {
    "law": f"who drives: {', '.join(PROFILES + BASELINES)} (default {DEFAULT_LAW}); a baseline with its shipped tuning",
    "scenario.KEY": "a key at the top of the scenario: duration_s, frame_rate_hz, hardware (a file), seed",
    "robots.NAME.KEY": "a key of a robot in the scenario: robots.leader.trajectory.speed_mps",
    "robots.NAME.config.KEY": "a key of its coordinator's configuration",
    "config.KEY": "the same of every robot that follows: config.control.heading.gain_per_s",
    "measurements.KEY": "of drawn measurements, see below",
}


@dataclass(frozen=True)
class MeasurementKey:
    """A number that describes drawn measurements."""

    low: float
    high: float
    text: str


MEASUREMENTS = {
    "scale": MeasurementKey(0.0, 1e3, "of the noise that is drawn; what the measurement claims of itself stays"),
    "distance_sigma_per_m": MeasurementKey(1e-9, 1.0, "sigma of d = this times d^2"),
    "bearing_sigma_rad": MeasurementKey(1e-9, 1.0, "sigma of theta"),
    "heading_sigma_rad_per_m": MeasurementKey(1e-9, 1.0, "sigma of psi = this times d"),
    "half_view_deg": MeasurementKey(1.0, 180.0, "bearing beyond which nothing is measured"),
    "vibration_hz": MeasurementKey(0.01, 1e3, "of a sine; without it the vibration is new in every picture"),
}

# In this process there is no bus and no program around the coordinator.
_NO_PROGRAM = ("name", "source", "odometry", "leader_intent_from", "key_file", "black_box", "preview")
# What drawn measurements take from the robots; everything else of a camera or a body is for pictures.
_DRAWN = re.compile(
    r"camera\.(calibration|latency_s|latency_jitter_s|drop_probability|vibration_(rad|deg)|mounting\.position_m(\.2)?)"
    r"|body\.hidden_(from|until)_s"
)
_FOR_PICTURES = "no effect on drawn measurements; set `observations: rendered` (some 100 times slower)"
_SET_BY_CAMPAIGN = {"law", "profile"}


def check_key(key: str, documents: Documents, rendered: bool) -> None:
    """ConfigError if there is nothing of that name, or if it would have no effect."""
    root, _, rest = key.partition(".")
    if key == "law":
        return
    if root == "measurements":
        if rest not in MEASUREMENTS:
            near = did_you_mean(rest, MEASUREMENTS)
            raise ConfigError(f"there is no key '{rest}'{near}; there are: {', '.join(MEASUREMENTS)}")
        if rendered:
            raise ConfigError("no effect on rendered pictures, which have the noise of robots.NAME.camera")
        return
    if root not in ("scenario", "robots", "config") or not rest:
        near = did_you_mean(root, ["law", "scenario", "robots", "config", "measurements"])
        raise ConfigError(f"a key begins with law, scenario, robots, config or measurements{near}")
    if root == "scenario":
        _check_scenario(rest)
    elif root == "config":
        for name in documents.configs:
            _check_config(rest, documents, name, rendered)
    else:
        _check_robot(rest, documents, rendered)


def _check_scenario(rest: str) -> None:
    if rest.split(".")[0] in ("robots", "like", "name", "description"):
        raise ConfigError(f"scenario.{rest} cannot be varied; a robot's keys are robots.NAME.KEY")


def _check_robot(rest: str, documents: Documents, rendered: bool) -> None:
    name, _, key = rest.partition(".")
    if name not in documents.names():
        near = did_you_mean(name, documents.names())
        raise ConfigError(f"the scenario has no robot '{name}'{near}; there are: {', '.join(documents.names())}")
    if key.startswith("config."):
        if name not in documents.configs:
            raise ConfigError(f"no coordinator drives '{name}'; those of {', '.join(documents.configs)} have a config")
        _check_config(key.removeprefix("config."), documents, name, rendered)
    elif key in ("", "name", "follows", "coordinator"):
        raise ConfigError("cannot be varied; single keys of its coordinator can: robots.NAME.config.KEY")
    elif key.startswith(("camera.", "body.")) and not rendered and not _DRAWN.fullmatch(key):
        raise ConfigError(_FOR_PICTURES)


def _check_config(key: str, documents: Documents, name: str, rendered: bool) -> None:
    top = key.split(".")[0]
    if top in _SET_BY_CAMPAIGN:
        raise ConfigError("say it by the key `law`")
    if top in _NO_PROGRAM:
        raise ConfigError("no effect: in a campaign there is no program around the coordinator, and no bus")
    if top == "setpoint" and "setpoint" in documents.robot(name):
        raise ConfigError(f"no effect: the scenario has its own; the key is robots.{name}.{key}")
    if top == "vision" and not rendered:
        raise ConfigError(_FOR_PICTURES)


def file_key(key: str) -> bool:
    """Whether the value names a file."""
    root, _, rest = key.partition(".")
    if root == "scenario":
        return rest == "hardware"
    if root == "config":
        return rest in CONFIG_FILES
    own = rest.partition(".")[2]
    if own.startswith("config."):
        return own.removeprefix("config.") in CONFIG_FILES
    return root == "robots" and own in (*ROBOT_FILES, "hardware")


def resolve_file(value: str, folder: Path) -> Path:
    """Beside the campaign's file, or a shipped one by its name ("hardware/nonideal.yaml")."""
    own = folder / value
    return own if own.exists() else data.find(value)


def varied(documents: Documents, settings: Mapping[str, Any]) -> tuple[Documents, dict[str, float]]:
    """A copy in which each key has its value, and the settings of drawn measurements. Files are named by what
    Documents.add_file() returned; hardware counts before single keys, whatever their order."""
    result = replace(documents, scenario=copy.deepcopy(documents.scenario), configs=copy.deepcopy(documents.configs))
    measurements = {}
    law = str(settings.get("law", DEFAULT_LAW))
    for config in result.configs.values():
        _set_law(config, law, result)
    for key in sorted(settings, key=lambda key: not key.endswith("hardware")):
        root, _, rest = key.partition(".")
        if root == "measurements":
            measurements[rest] = settings[key]
        elif key != "law":
            _assign(result, root, rest, settings[key])
    return result, measurements


def _assign(documents: Documents, root: str, rest: str, value: Any) -> None:
    if root == "config":
        for config in documents.configs.values():
            _put_at(config, rest, value)
        return
    if root == "scenario":
        if rest == "hardware":
            _hardware(documents.robots(), value, documents)
        else:
            _put_at(documents.scenario, rest, value)
        return
    name, _, key = rest.partition(".")
    if key.startswith("config."):
        _put_at(documents.configs[name], key.removeprefix("config."), value)
    elif key == "hardware":
        _hardware([documents.robot(name)], value, documents, every=True)
    else:
        _put_at(documents.robot(name), key, value)


def _hardware(robots: list[dict[str, Any]], name: str | None, documents: Documents, every: bool = False) -> None:
    if name is not None:
        apply_hardware(robots, yaml.load(documents.files[name], yaml.BaseLoader) or {}, every)


def _put_at(section: Any, key: str, value: Any) -> None:
    *path, last = key.split(".")
    for name in path:
        section = _entry(section, name, key)
    if isinstance(section, list):
        section[_index(section, last, key)] = value
    elif isinstance(section, dict):
        put(section, last, value)
    else:
        raise ConfigError(f"{key}: '{section}' has no keys below it")


def _entry(section: Any, name: str, key: str) -> Any:
    if isinstance(section, list):
        return section[_index(section, name, key)]
    if isinstance(section, dict):
        return section.setdefault(name, {})
    raise ConfigError(f"{key}: '{section}' has no keys below it")


def _index(entries: list[Any], name: str, key: str) -> int:
    if not name.isdecimal() or int(name) >= len(entries):
        raise ConfigError(f"{key}: '{name}' is not a number from 0 to {len(entries) - 1}")
    return int(name)


def _set_law(config: dict[str, Any], law: str, documents: Documents) -> None:
    """As --law, --profile and --tuning; in the file, so that keys of `control` win over the tuning."""
    driving = Driving(law)
    if law in BASELINES:
        put(config, "tuning", documents.tunings.get(law))
    elif config.get("law") in BASELINES:  # whose tuning is not for the fuzzy law
        put(config, "tuning", None)
    put(config, "law", driving.law)
    if law in PROFILES:
        put(config, "profile", law)

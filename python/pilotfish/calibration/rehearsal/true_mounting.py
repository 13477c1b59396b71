"""The truth about a rehearsed mounting: the lines ``camera: mounting:``, as a coordinator's configuration has them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from pilotfish.core import CameraMounting
from pilotfish.errors import ConfigError
from pilotfish.files import read_text
from pilotfish.whole_files import write_whole

_ANGLES = ("pan", "tilt", "roll")


def write_true_mounting(file: Path, mounting: CameraMounting, remarks: Sequence[str] = ()) -> None:
    """OSError if it cannot be written."""
    place = ", ".join(f"{value:.6f}" for value in mounting.position_m)
    angles = [f"    {name}_deg: {math.degrees(getattr(mounting, f'{name}_rad')):.6f}" for name in _ANGLES]
    lines = [*(f"# {each}" for each in remarks), "camera:", "  mounting:", f"    position_m: [{place}]", *angles]
    write_whole(file, "\n".join(lines) + "\n")


def read_true_mounting(file: Path) -> CameraMounting:
    """Of any YAML file with ``camera: mounting:``, also a coordinator's configuration. MissingFileError,
    ConfigError."""
    section = _section(file)
    known = ("position_m", *(f"{name}_deg" for name in _ANGLES))
    for key in section:
        if key not in known:
            raise ConfigError(f"{file}: camera.mounting.{key}: unknown key; known are {', '.join(known)}")
    place = section.get("position_m")
    if not isinstance(place, list) or len(place) != 3 or not all(map(_is_number, place)):
        raise ConfigError(f"{file}: camera.mounting.position_m: {place}; needed are three numbers, forward, left, up")
    angles = {}
    for name in _ANGLES:
        value = section.get(f"{name}_deg", 0.0)
        if not _is_number(value):
            raise ConfigError(f"{file}: camera.mounting.{name}_deg: {value}; needed is a number of degrees")
        angles[f"{name}_rad"] = math.radians(value)
    try:
        return CameraMounting(position_m=[float(value) for value in place], **angles)
    except ConfigError as error:
        raise ConfigError(f"{file}: {error}") from error


def _section(file: Path) -> dict[str, Any]:
    try:
        found = yaml.safe_load(read_text(file))
        for name in ("camera", "mounting"):
            found = found.get(name) if isinstance(found, dict) else None
    except (yaml.YAMLError, RecursionError):  # also what OpenCV calls YAML
        found = None
    if not isinstance(found, dict):
        raise ConfigError(
            f"{file}: no mounting in it; needed is camera: mounting:, as in the truth.yaml of `pilotfish render "
            "mounting`, or a coordinator's configuration"
        )
    return found


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)

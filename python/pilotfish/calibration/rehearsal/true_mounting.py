"""The truth about a rehearsed mounting: the lines ``camera: mounting:``, as a coordinator's configuration has them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

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
    try:
        section = yaml.safe_load(read_text(file))["camera"]["mounting"]
        if not set(section) <= {"position_m", *(f"{name}_deg" for name in _ANGLES)}:
            raise ValueError(f"unknown keys among {', '.join(map(str, section))}")
        place = [float(value) for value in section["position_m"]]
        angles = {f"{name}_rad": math.radians(float(section.get(f"{name}_deg", 0.0))) for name in _ANGLES}
        return CameraMounting(position_m=place, **angles)
    except ConfigError as error:
        raise ConfigError(f"{file}: {error}") from error
    except (yaml.YAMLError, KeyError, TypeError, ValueError, RecursionError) as error:
        if isinstance(error, FileNotFoundError):
            raise
        raise ConfigError(
            f"{file}: no mounting in it ({' '.join(str(error).split())}): needed is camera: mounting: with position_m: "
            "[forward, left, up] and pan_deg, tilt_deg, roll_deg, as in the truth.yaml of `pilotfish render mounting`"
        ) from error

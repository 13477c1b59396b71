"""Whether the wheels' process lets through what the coordinator counts on: it brakes as hard, and is as fast."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

from pilotfish import base, coordinator
from pilotfish.config_message import in_file, with_meant_key
from pilotfish.doctor.finding import Finding, ok, wrong
from pilotfish.errors import ConfigError

CHECK = "wheels' limits"
# key of pilotfish-base -> key of the coordinator's `control.limits` that it must not be below
_NEEDED = {
    "max_linear_mps": "max_linear_mps",
    "max_reverse_mps": "max_reverse_mps",
    "max_linear_acceleration_mps2": "max_linear_acceleration_mps2",
    "brake_mps2": "max_linear_acceleration_mps2",
    "max_angular_radps": "max_angular_radps",
    "max_angular_acceleration_radps2": "max_angular_acceleration_radps2",
}


@dataclass(frozen=True)
class Beside:
    """The wheels' configuration beside a coordinator's. ``loaded``: None where there is none that can be used."""

    file: Path
    loaded: base.BaseFile | None = None
    problem: str = ""  # why it cannot be used
    other_names: dict[str, str] = field(default_factory=dict)  # file -> robot that it is of


def base_beside(coordinator_file: Path, robot: str) -> Beside:
    """``base.yaml`` in the coordinator's folder, ``NAME-base.yaml`` as the Debian package has it, or another
    ``*base*.yaml`` there that is of this robot."""
    folder = coordinator_file.parent
    usual = [file for name in ("base.yaml", f"{robot}-base.yaml") if os.path.lexists(file := folder / name)]
    broken: Beside | None = None
    of_others: dict[str, str] = {}
    for file in [*usual, *sorted(file for file in folder.glob("*base*.yaml") if file not in usual)]:
        try:
            loaded = base.load_base(str(file))
        except ConfigError as error:
            if file in usual:
                broken = broken or Beside(file, None, str(error))
            continue
        if loaded.name == robot:
            return Beside(file, loaded)
        of_others[file.name] = loaded.name
    return broken or Beside(folder / "base.yaml", None, "", of_others)


def too_low(allowed: base.BaseFile, told: coordinator.CoordinatorFile) -> list[str]:
    """Limits of the wheels' process below the coordinator's, as texts; empty: none."""
    limits = told.coordinator.control.limits
    return [
        f"limits.{key} {getattr(allowed.base.limits, key):g} < control.limits.{needed} {getattr(limits, needed):g}"
        for key, needed in _NEEDED.items()
        if getattr(allowed.base.limits, key) < getattr(limits, needed)
    ]


def check_wheel_limits(coordinator_file: Path) -> Finding:
    """Of ``base.yaml`` beside the coordinator's file. A coordinator predicts with its own limits how its robot
    moves, and its collision guard how it stops: where the base brakes less, the minimum distance is no promise."""
    told = coordinator.load_coordinator(str(coordinator_file))
    beside = base_beside(coordinator_file, told.name)
    if beside.loaded is None:
        return _unusable(beside, coordinator_file.name, told.name)
    less = too_low(beside.loaded, told)
    if not less:
        return ok(CHECK, f"{beside.file.name} lets through what {coordinator_file.name} commands")
    return wrong(CHECK, "; ".join(less), limits_advice(less, coordinator_file.name, beside.file.name))


def limits_advice(less: list[str], coordinator_file: str, base_file: str) -> str:
    """What to do about limits that are too low."""
    braking = any(line.startswith("limits.brake") for line in less)
    stops = "it stops later than its collision guard counts on; " if braking else ""
    return f"{stops}set control.limits in {coordinator_file} to what the wheels can do, or raise {base_file}'s"


def _unusable(beside: Beside, coordinator_file: str, robot: str) -> Finding:
    if beside.problem:
        return wrong(
            CHECK,
            f"pilotfish-base does not start: {with_meant_key(in_file(beside.problem, beside.file))}",
            "correct what is named; pilotfish-base --describe-config lists every key, its range and its default",
        )
    if beside.other_names:
        listed = ", ".join(f"{file} is of {name}" for file, name in beside.other_names.items())
        first = next(iter(beside.other_names))
        return wrong(
            CHECK,
            f"{listed}, {coordinator_file} of {robot}: commands of {robot} do not reach these wheels",
            f"name: {robot} in {first}, or name: in {coordinator_file}: both must be the same",
        )
    return wrong(
        CHECK,
        f"no base.yaml beside {coordinator_file}: nobody says how fast the wheels may drive and how hard they brake",
        f"pilotfish init {robot} --dir NEW writes one to copy; with a driver of your own, enter there what it can do",
    )

"""Whether the wheels' process lets through what the coordinator counts on: it brakes as hard, and is as fast."""

from __future__ import annotations

from pathlib import Path

from pilotfish import base, coordinator
from pilotfish.doctor.finding import Finding, note, ok, wrong

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


def check_wheel_limits(coordinator_file: Path) -> Finding:
    """Of ``base.yaml`` beside the coordinator's file. A coordinator predicts with its own limits how its robot
    moves, and its collision guard how it stops: where the base brakes less, the minimum distance is no promise."""
    beside = coordinator_file.parent / "base.yaml"
    if not beside.is_file():
        return note(CHECK, f"no base.yaml beside {coordinator_file.name}")
    told = coordinator.load_coordinator(str(coordinator_file))
    limits, allowed = told.coordinator.control.limits, base.load_base(str(beside))
    if allowed.name != told.name:
        return note(CHECK, f"{beside.name} is of {allowed.name}, {coordinator_file.name} of {told.name}")
    less = [
        f"limits.{key} {getattr(allowed.base.limits, key):g} < control.limits.{needed} {getattr(limits, needed):g}"
        for key, needed in _NEEDED.items()
        if getattr(allowed.base.limits, key) < getattr(limits, needed)
    ]
    if not less:
        return ok(CHECK, f"{beside.name} lets through what {coordinator_file.name} commands")
    braking = any(line.startswith("limits.brake") for line in less)
    stops = "it stops later than its collision guard counts on; " if braking else ""
    return wrong(
        CHECK,
        "; ".join(less),
        f"{stops}set control.limits in {coordinator_file.name} to what the wheels can do, or raise {beside.name}'s",
    )

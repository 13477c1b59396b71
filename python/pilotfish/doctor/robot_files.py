"""The files of a robot's folder: what is still an example, and whether its camera sees where the leader is to be."""

from __future__ import annotations

from pathlib import Path

import yaml

from pilotfish.doctor.finding import Finding, note, ok, wrong
from pilotfish.doctor.following.mounting import out_of_view
from pilotfish.doctor.following.setup import Setup
from pilotfish.errors import PilotfishError
from pilotfish.files import read_text

CALIBRATION, LEADER, VIEW = "calibration", "leader", "view"
_MARK = "TO BE REPLACED"  # pilotfish init writes it into what it cannot know


def check_robot_files(setup: Setup) -> list[Finding]:
    """Whether calibration and leader are this robot's own, and whether its camera sees where the leader is to be."""
    calibration, leader = _named_files(setup.file)
    return [_calibration(setup, calibration), _leader(leader), check_view(setup)]


def check_view(setup: Setup) -> Finding:
    """Whether the place where the leader is to be kept is in the picture."""
    if outside := out_of_view(setup):
        return wrong(
            VIEW,
            f"the camera does not see where the leader is to be kept: {outside}",
            "measure camera.mounting.pan_deg again (positive: the camera looks left), or choose another "
            "setpoint.bearing_deg",
        )
    return ok(VIEW, "the camera sees where the leader is to be kept")


def _calibration(setup: Setup, file: Path | None) -> Finding:
    if file is None or not _is_stand_in(file):
        return ok(CALIBRATION, f"{file.name if file else 'calibration'} is no example")
    seen = f"{file} is still the simulated camera's, as pilotfish init wrote it"
    if not setup.source.startswith("camera:"):
        return note(CALIBRATION, f"{seen}: right for pictures of pilotfish-sim alone", _CALIBRATE)
    return wrong(CALIBRATION, f"{seen}: distances and bearings of {setup.source} are wrong with it", _CALIBRATE)


def _leader(file: Path | None) -> Finding:
    if file is None or not _is_stand_in(file):
        return ok(LEADER, f"{file.name if file else 'leader'} is no example")
    return note(
        LEADER,
        f"{file} is still the example of pilotfish init: three tags of 0.16 m on folded faces",
        "enter ids, sizes and places of your leader's tags (pilotfish learn-body takes them from a video), and remove "
        f"the line '{_MARK}'; if yours is built exactly like the example, the line alone",
    )


_CALIBRATE = "pilotfish calibrate camera, at the size you will use; put its file in place (the new one lacks the mark)"


def _is_stand_in(file: Path) -> bool:
    try:
        return _MARK in read_text(file)
    except PilotfishError:
        return False  # whoever loads it says what is wrong with it


def _named_files(config: Path) -> tuple[Path | None, Path | None]:
    """Calibration and leader of a configuration that has been loaded."""
    try:
        content = yaml.safe_load(read_text(config))
        named = content["camera"]["calibration"], content["leader"]
    except (PilotfishError, yaml.YAMLError, KeyError, TypeError):
        return None, None
    calibration, leader = (config.parent / name if isinstance(name, str) else None for name in named)
    return calibration, leader

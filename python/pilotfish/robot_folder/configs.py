"""The configurations of a new robot, made from the shipped ones: comments stay, paths become those of its folder.

A change of a shipped file that would make an edit here miss its place raises; a test makes a folder with every change.
"""

from __future__ import annotations

from pilotfish import data
from pilotfish.files import read_text

_STANDS_STILL = "  run: false          # looks, and stands still until `pilotfish go @NAME@`; true: drives at once\n"
_CALIBRATION_NOTE = (
    "# TO BE REPLACED by your camera's calibration: with this one, of the simulated camera, distances and bearings\n"
    "# are wrong. OpenCV's and ViSP's files are read as they are.\n"
)
_LEADER_NOTE = (
    "# TO BE REPLACED by what your leader wears: ids, the side of the black square, and where the tags sit. Measured,\n"
    "# or learned from a video of it turning in place: pilotfish learn-body.\n"
)


def coordinator(name: str, source: str) -> str:
    """NAME.yaml: data/config/coordinator.yaml, told to stand still."""
    text = read_text(data.path("config/coordinator.yaml"))
    _, found, rest = text.partition("\nname: robot1 ")
    if not found:
        raise AssertionError("data/config/coordinator.yaml has changed: it does not begin with its name")
    head = (
        f"# The coordinator of {name}. Every key, its range and its default: pilotfish-coordinator --describe-config."
    )
    return _edited(
        f"{head}\nname: {name} {rest}",
        ("ROBOT1_IMAGE, ROBOT1_COMMAND", f"{name.upper()}_IMAGE, {name.upper()}_COMMAND"),
        ("\nsource: lcm           ", f"\nsource: {source:<14}"),
        ("../calibrations/sim_640x480.yaml", "calibration.yaml"),
        ("../leaders/three_faces.yaml", "leader.yaml"),
        ("../fuzzy/coordination.yaml", "fuzzy.yaml"),
        ("\nsetpoint:\n", "\nsetpoint:\n" + _STANDS_STILL.replace("@NAME@", name)),
    )


def base(name: str) -> str:
    """base.yaml: data/config/base.yaml; its driver moves nothing until another one is entered."""
    return _edited(
        read_text(data.path("config/base.yaml")),
        ("docs/base-configuration.md", "pilotfish-base --describe-config"),
        ("\nname: robot1 ", f"\nname: {name} "),
        ("ROBOT1_COMMAND, ROBOT1_BASE", f"{name.upper()}_COMMAND, {name.upper()}_BASE"),
    )


def calibration() -> str:
    """calibration.yaml: the simulated camera's, marked as such. OpenCV wants %YAML in the first line."""
    return _edited(read_text(data.path("calibrations/sim_640x480.yaml")), ("---\n", "---\n" + _CALIBRATION_NOTE))


def leader() -> str:
    """leader.yaml: three tags on three faces, marked as an example."""
    return _LEADER_NOTE + read_text(data.path("leaders/three_faces.yaml"))


def fuzzy() -> str:
    """fuzzy.yaml: the law as shipped."""
    return read_text(data.path("fuzzy/coordination.yaml"))


def wheel_driver(name: str) -> str:
    """wheel_driver.py, for this robot."""
    return _edited(
        read_text(data.path("robot/wheel_driver.py")),
        ('ROBOT = "robot1"', f'ROBOT = "{name}"'),
        ("ROBOT1_COMMAND", f"{name.upper()}_COMMAND"),
    )


def _edited(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        if text.count(old) != 1:
            raise AssertionError(f"a shipped file has changed: '{old}' is there {text.count(old)} times, not once")
        text = text.replace(old, new)
    return text

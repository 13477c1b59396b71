"""A shipped scenario with something changed, as a file of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from pilotfish import data as shipped
from pilotfish.harness.scenario import Scenario


def edited_scenario(folder: Path, which: str, change: Callable[[dict[str, Any]], None]) -> Scenario:
    """Paths inside become absolute. robots[0] leads, robots[1] follows."""
    original = shipped.path(f"scenarios/{which}.yaml")
    content = yaml.safe_load(original.read_text())
    for robot in content["robots"]:
        for place, key in ((robot.get("body"), "leader"), (robot.get("camera"), "calibration"), (robot, "coordinator")):
            if place and key in place:
                place[key] = str((original.parent / place[key]).resolve())
    change(content)
    file = folder / f"{which}.yaml"
    file.write_text(yaml.safe_dump(content))
    return Scenario.load(file)

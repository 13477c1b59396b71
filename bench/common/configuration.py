"""The shipped configuration and scenarios, to be changed and written elsewhere."""

from __future__ import annotations

from typing import Any

import yaml

from pilotfish import data


def shipped_coordinator() -> dict[str, Any]:
    """config/line.yaml; the files it names have absolute paths."""
    source = data.path("config/line.yaml")
    config = yaml.safe_load(source.read_text())
    for table, key in ((config["camera"], "calibration"), (config, "leader"), (config, "fuzzy")):
        table[key] = str((source.parent / table[key]).resolve())
    return config


def shipped_scenario(which: str) -> dict[str, Any]:
    """scenarios/WHICH.yaml; the files its robots name have absolute paths."""
    source = data.path(f"scenarios/{which}.yaml")
    scenario = yaml.safe_load(source.read_text())
    for robot in scenario["robots"]:
        for table, key in ((robot.get("body"), "leader"), (robot.get("camera"), "calibration"), (robot, "coordinator")):
            if table and key in table:
                table[key] = str((source.parent / table[key]).resolve())
    return scenario

"""The shipped configuration, to be changed and written elsewhere."""

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

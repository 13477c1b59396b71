"""A shipped scenario with something changed, as a file of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from bench.common.configuration import shipped_scenario
from pilotfish.harness.scenario import Scenario


def edited_scenario(folder: Path, which: str, change: Callable[[dict[str, Any]], None]) -> Scenario:
    """Paths inside become absolute. robots[0] leads, robots[1] follows."""
    content = shipped_scenario(which)
    change(content)
    file = folder / f"{which}.yaml"
    file.write_text(yaml.safe_dump(content))
    return Scenario.load(file)

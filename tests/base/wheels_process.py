"""Runs pilotfish-base."""

from __future__ import annotations

from pathlib import Path

from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, find_executable

CONFIG = shipped.path("config/base.yaml")


class WheelsProcess(Child):
    """A running pilotfish-base."""

    def __init__(
        self, folder: Path, url: str, driver: str, *options: str, config: Path = CONFIG, name: str = "base"
    ) -> None:
        command = [find_executable(BASE), "--config", config, "--driver", driver, "--lcm-url", url, *options]
        super().__init__(command, folder, name)

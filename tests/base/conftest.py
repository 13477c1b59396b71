from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from commander import Commander
from motor_controller import MotorController
from wheels_process import WheelsProcess

from pilotfish.harness.ports import private_lcm_url


@pytest.fixture
def url() -> str:
    return private_lcm_url()


@pytest.fixture
def controller() -> Iterator[MotorController]:
    with MotorController() as controller:
        yield controller


@pytest.fixture
def robot(tmp_path: Path, url: str, controller: MotorController) -> Iterator[WheelsProcess]:
    """pilotfish-base on a serial line, and a commander from which it has received nothing yet."""
    with WheelsProcess(tmp_path, url, f"serial:{controller.device}") as robot:
        yield robot


@pytest.fixture
def commander(url: str, robot: WheelsProcess) -> Commander:
    commander = Commander(url)
    commander.listen_until(lambda: bool(commander.received), "a message of the base")
    return commander

"""The rule under random calls, in C++ because there are many: tests/probes/random_steps.cpp keeps its own books."""

import json
import subprocess
from pathlib import Path

import pytest

from pilotfish import data as shipped

RELEASE = Path(__file__).parents[2] / "build" / "release"
STEPS = 1_000_000  # ten times as many were run once, with ten seeds: no violation


@pytest.mark.fault("random_steps")
@pytest.mark.parametrize("seed", [1, 2])
def test_no_random_sequence_of_stamps_arrivals_and_setpoints_moves_the_robot_blindly(seed):
    if not (RELEASE / "build.ninja").exists():
        pytest.skip("needs build/release: run scripts/build --tests")
    subprocess.run(["cmake", "--build", str(RELEASE), "--target", "random_steps"], check=True, capture_output=True)
    command = [RELEASE / "tests" / "probes" / "random_steps", shipped.path("config/line.yaml"), STEPS, seed]
    counted = json.loads(subprocess.run(list(map(str, command)), capture_output=True, text=True).stdout)
    assert counted["steps"] == STEPS
    assert counted["violations"] == 0
    # It moved, it was refused, its clock was set: else the test would test nothing.
    assert counted["moving"] > STEPS / 50 and counted["tracked"] > STEPS / 50 and counted["epochs"] > 100

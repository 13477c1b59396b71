"""Obstacles with the real programs, rendered pictures and ranges on a real bus."""

import subprocess
import sys

import numpy as np
import pytest
from edited_scenario import edited_scenario

from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.over_lcm import run_over_lcm


def one_in_the_way(content):
    """A low one beside robot1's path, which is 0.285 m to the left of the leader's: 0.265 m between middles, and 0.40 m
    of radii."""
    del content["obstacle_field"]
    content["obstacles"] = [{"x_m": -0.1, "y_m": 0.55, "radius_m": 0.15, "height_m": 0.12}]
    content["duration_s"] = 5.0


def test_the_programs_pass_an_obstacle_as_the_same_code_in_one_process(tmp_path):
    scenario = edited_scenario(tmp_path, "obstacles", one_in_the_way)
    clearance_m = []

    def look(event):
        clearance_m.append(event.world.clearance_m("robot1"))

    inside = run_in_process(scenario, profile="anticipate", on_frame=look).recordings["robot1"]
    outside = run_over_lcm(scenario, profile="anticipate").recordings["robot1"]
    # On the wire directions are floats: 172.5 degrees come with an error of 1e-7 rad.
    assert outside.command_linear_mps == pytest.approx(inside.command_linear_mps, abs=1e-4)
    assert outside.command_angular_radps == pytest.approx(inside.command_angular_radps, abs=1e-3)
    assert min(clearance_m) > 0.0
    # It has gone past, farther to the right than the 0.135 m that were missing.
    assert inside.x_m[-1] > 0.0
    assert np.min(inside.y_m) < inside.y_m[0] - 0.135


def test_without_ranges_the_robot_stands_and_says_why(tmp_path):
    def without_sensors(content):
        one_in_the_way(content)
        content["duration_s"] = 1.0
        del content["robots"][1]["range_sensors"]

    scenario = edited_scenario(tmp_path, "obstacles", without_sensors)
    run = run_over_lcm(scenario, profile="anticipate")
    assert not run.recordings["robot1"].command_linear_mps.any()
    assert {report.reason for report in run.reports["robot1"]} == {"no fresh ranges, without which it does not drive"}


def test_a_recording_with_ranges_is_replayed_bit_for_bit(tmp_path):
    def short(content):
        one_in_the_way(content)
        content["duration_s"] = 2.0

    box = tmp_path / "box"
    scenario = edited_scenario(tmp_path, "obstacles", short)
    run_over_lcm(scenario, profile="anticipate", coordinator_options=["--black-box", str(box)])
    command = [sys.executable, "-m", "pilotfish", "replay", str(box), "--assert"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr

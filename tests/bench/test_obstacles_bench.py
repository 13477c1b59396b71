"""Twenty of the benchmark's worlds: no collision, and the formation is kept again; its figures are what they say."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pilotfish.harness.obstacle_worlds import Ending, judge, outcome, play, world_spec

ROOT = Path(__file__).parents[2]


def test_in_twenty_worlds_nothing_is_hit_and_the_formation_is_kept_again():
    found = [outcome(seed, 12) for seed in range(1, 21)]
    assert min(each.clearance_m for each in found) > 0.0
    assert sum(each.ending == Ending.KEPT for each in found) >= 19
    # Most worlds have something in the way, or this says nothing.
    assert sum(each.avoided for each in found) >= 12


def test_without_avoidance_the_same_law_runs_into_obstacles():
    found = [outcome(seed, 20, avoid=False) for seed in range(1, 9)]
    assert sum(each.ending == Ending.COLLIDED for each in found) >= 2


def still_track():
    """Of a run that did everything right: five seconds, an obstacle near until second 2."""
    track = play(replace_duration(world_spec(3, 0), 5.0))
    return replace(
        track,
        obstacle_m=np.where(track.time_s < 2.0, 0.2, 1.0),
        clearance_m=np.full(track.time_s.size, 0.2),
        distance_error_m=np.zeros(track.time_s.size),
        bearing_error_rad=np.zeros(track.time_s.size),
        status=["tracking"] * track.time_s.size,
        reason=["none"] * track.time_s.size,
    )


def replace_duration(spec, duration_s):
    spec.duration_s = duration_s
    return spec


def test_a_run_is_judged_by_the_worst_that_happened():
    good = still_track()
    late = np.where(good.time_s < 4.0, 0.1, 0.0)  # two seconds after the last obstacle
    never = np.full(good.time_s.size, 0.1)
    assert judge(1, good).ending == Ending.KEPT
    assert judge(1, replace(good, distance_error_m=late)).settled_s == pytest.approx(2.0, abs=0.1)
    assert judge(1, replace(good, distance_error_m=never)).ending == Ending.LATE
    assert judge(1, replace(good, distance_error_m=never)).settled_s == math.inf
    lost = replace(good, distance_error_m=never, status=["lost"] * good.time_s.size)
    assert judge(1, lost).ending == Ending.LOST
    blocked = replace(good, distance_error_m=never, reason=["obstacle_in_path"] * good.time_s.size)
    assert judge(1, blocked).ending == Ending.BLOCKED
    hit = replace(good, clearance_m=np.where(good.time_s == good.time_s[7], -0.001, 0.2))
    assert judge(1, hit).ending == Ending.COLLIDED


def test_the_benchmark_prints_its_table_and_leaves_every_world(tmp_path):
    command = [sys.executable, ROOT / "bench" / "obstacles", "--worlds", "2", "--count", "6", "--workers", "1"]
    done = subprocess.run([*command, "--out", tmp_path], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "2 worlds of each density" in done.stdout
    (row,) = json.loads((tmp_path / "obstacles.json").read_text())
    assert (row["obstacles"], row["avoidance"], [world["seed"] for world in row["worlds"]]) == (6, True, [1, 2])

"""The benchmark of following runs, and its figures are what they say."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests" / "python"))
sys.path.insert(0, str(ROOT / "bench" / "following"))

import figures  # noqa: E402
import rows  # noqa: E402
from synthetic_run import synthetic_run  # noqa: E402


def test_the_physical_limit_is_the_way_made_before_and_while_braking():
    # 0.2 m/s for 1/30 + 0.1 s, then 0.2^2 / 2: 26.7 + 20 mm.
    assert figures.physical_limit_m() == pytest.approx(0.0466667, abs=1e-6)


def test_closest_approach_and_reversal_are_read_off_after_the_stop():
    """47 mm too close at 11 s, then 5 mm too far, then right."""
    time_s = np.arange(540) / 30.0
    error_m = np.interp(time_s, [0, 10, 11, 12, 13, 18], [0, 0, 0.047, -0.005, 0, 0])
    found = figures.figures_of("stop_dead", synthetic_run(time_s, error_m))
    assert found["closest approach [mm]"] == pytest.approx(47.0)
    assert found["reversal [mm]"] == pytest.approx(5.0)


def test_a_leader_is_out_of_the_picture_when_its_disc_crosses_the_edge():
    """At 1 m the disc of 0.15 m takes atan(0.15) = 8.5 degrees, so the edge at atan(320/600) = 28.1 is reached at 19.5
    degrees of bearing; the setpoint is -10 degrees."""
    time_s = np.arange(300) / 30.0
    bearing_error_rad = np.radians(np.where(time_s < 5.0, 29.0, 30.0))  # 19 degrees, then 20
    run = synthetic_run(time_s, np.zeros(300), bearing_error_rad)
    assert figures.figures_of("square", run)["frames out of picture"] == 150


def test_a_row_is_met_only_if_the_worst_seed_meets_it():
    runs = {law: [{"steady-state error [mm]": 1.0}, {"steady-state error [mm]": 1.5}] for law in rows.LAWS}
    row = rows._row({"line": runs}, "line", "steady-state error [mm]", 2.0, "2")
    assert row.met and row.ours == 1.5 and row.ratio == pytest.approx(1.5 / 1.25)
    runs["anticipate"][1]["steady-state error [mm]"] = 2.5
    assert not rows._row({"line": runs}, "line", "steady-state error [mm]", 2.0, "2").met


def test_a_quick_run_of_one_scenario_prints_its_table_and_leaves_its_files(tmp_path):
    command = [sys.executable, ROOT / "bench" / "following", "--quick", "--scenario", "circle", "--out", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "steady-state error" in done.stdout
    report = json.loads((tmp_path / "following.json").read_text())
    assert set(report["figures"]["circle"]) == set(rows.LAWS)
    standing = next(row for row in report["rows"] if row["figure"] == "steady-state error [mm]")
    assert standing["met"] and standing["others"]["paper"] > 46.0
    assert (tmp_path / "following.png").is_file()

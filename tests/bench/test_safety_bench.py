"""The benchmark of the wheels' deadline runs, and its figures are what they say."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_a_few_repetitions_print_their_table_and_leave_their_figures(tmp_path):
    command = [sys.executable, ROOT / "bench" / "safety", "--repetitions", "3", "--load", "idle", "--out", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "SIGKILL" in done.stdout
    assert "SIGSTOP" in done.stdout
    rows = json.loads((tmp_path / "safety.json").read_text())["base-deadline"]
    assert [(row["kind"], row["load"]) for row in rows] == [("kill", "idle"), ("stop", "idle")]
    for row in rows:
        assert len(row["line_ms"]) == len(row["bus_ms"]) == 3
        # No zero before half of a command's life has passed, or it would not be the deadline that is measured: the last
        # command is at most a period (33 ms) old when the signal comes, and it is good for 95.
        assert min(row["line_ms"]) > 95 - 33 - 15
        assert row["moved_after"] == 0


def test_an_unknown_part_is_refused(tmp_path):
    command = [sys.executable, ROOT / "bench" / "safety", "--part", "everything", "--out", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert "base-deadline" in done.stderr

"""A flood of events is not a flood of lines."""

import subprocess
from pathlib import Path

import pytest

pytestmark = pytest.mark.not_sanitized("runs a program of build/release")
PERIOD_US = 1_000_000


def answers(events):
    """What the throttle says to each (kind, time_us): the number kept back if a line is due, else None."""
    probe = Path(__file__).parents[2] / "build" / "release" / "tests" / "probes" / "log_throttle_probe"
    events_text = "".join(f"{kind} {time_us}\n" for kind, time_us in events)
    said = subprocess.run(
        [probe, str(PERIOD_US / 1e6)], input=events_text, capture_output=True, text=True, check=True
    ).stdout
    return [None if word == "-" else int(word) for word in said.split()]


def test_the_first_of_each_kind_is_said_at_once():
    assert answers([("setpoint", 5), ("command", 5), ("setpoint", 6), ("command", 7)]) == [0, 0, None, None]


def test_a_flood_of_48000_events_in_ten_seconds_is_ten_lines_and_none_is_forgotten():
    # One event every 208 us; lines at the first and then at the first event at least a second after the last line.
    said = answers([("setpoint", k * 208) for k in range(48_000)])
    lines = [kept_back for kept_back in said if kept_back is not None]
    assert len(lines) == 10  # 48 000 * 208 us = 9.98 s
    tail = said[::-1].index(lines[-1])  # behind the last line: not yet reported
    assert sum(lines) + len(lines) + tail == 48_000


def test_what_comes_once_a_period_is_always_said():
    assert answers([("late", k * PERIOD_US) for k in range(20)]) == [0] * 20


def test_a_line_is_due_exactly_one_period_after_the_last_and_not_before():
    assert answers([("x", 0), ("x", PERIOD_US - 1), ("x", PERIOD_US)]) == [0, None, 1]

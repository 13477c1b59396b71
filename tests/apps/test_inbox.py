"""From the receiving threads to the vision thread: the newest frame, and the setpoints, in order."""

import pytest
from coordinator_parts import only, play

TIMEOUT_US = 10_000_000  # never waited for: what wakes the vision thread comes after some 20 ms


def taken(*lines):
    """For each `take`: the frame's arrival or None, the counters of the setpoints, how long it took."""
    return [
        (None if frame == "none" else int(frame), [int(counter) for counter in counters], int(elapsed_us))
        for frame, elapsed_us, *counters in only(play(*lines), "taken")
    ]


def test_a_newer_frame_takes_the_place_of_one_that_nobody_looked_at_and_is_counted():
    lines = ["frame 1", "frame 2", "frame 3", f"take {TIMEOUT_US}", "take 0", "frame 4", f"take {TIMEOUT_US}"]
    assert [frame for frame, _, _ in taken(*lines)] == [3, None, 4]
    assert only(play(*lines, "inbox"), "inbox") == [["2", "0"]]


def test_what_it_is_told_is_kept_in_order_and_taken_once():
    lines = ["setpoint 5", "setpoint 3", "frame 1", "setpoint 4", f"take {TIMEOUT_US}", "take 0"]
    assert [(frame, counters) for frame, counters, _ in taken(*lines)] == [(1, [5, 3, 4]), (None, [])]


def test_of_a_flood_the_newest_256_are_kept_and_the_others_counted():
    lines = [*(f"setpoint {k}" for k in range(300)), "take 0", "inbox"]
    ((_, counters, _),) = taken(*lines)
    assert counters == list(range(44, 300))
    assert only(play(*lines), "inbox") == [["0", "44"]]
    assert only(play(*lines[:256], "inbox"), "inbox") == [["0", "0"]]


@pytest.mark.parametrize(
    ("what", "frame", "counters"), [("frame 7", 7, []), ("setpoint 8", None, [8]), ("wake -", None, [])]
)
def test_who_waits_is_woken_by_a_frame_by_a_message_and_by_the_end(what, frame, counters):
    ((got_frame, got_counters, elapsed_us),) = taken(f"later {what}", f"take {TIMEOUT_US}")
    assert (got_frame, got_counters) == (frame, counters)
    assert elapsed_us < TIMEOUT_US / 2


def test_a_wake_up_is_for_one_turn_and_patience_ends():
    first, second = taken("wake", f"take {TIMEOUT_US}", "take 30000")
    assert first[2] < TIMEOUT_US / 2
    assert second[2] >= 30_000

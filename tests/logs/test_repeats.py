"""Changes of status that repeat are told as one; what means something stands by itself."""

from __future__ import annotations

from pilotfish.logs.report.repeats import Repeats, with_repeats_joined
from pilotfish.logs.report.tables import event_table
from pilotfish.logs.run import RunEvent

COASTING, LOST = "coasting: no_frame", "lost: no_frame"


def statuses(*said):
    return [RunEvent(t_s, "status", text) for t_s, text in said]


def swinging(begin_s, times):
    """Every 0.1 s without a picture for 0.05 s."""
    return [
        event
        for k in range(times)
        for event in statuses((begin_s + 0.1 * k, COASTING), (begin_s + 0.1 * k + 0.05, "tracking"))
    ]


def test_what_repeats_is_one_row_with_how_often_and_when():
    start = RunEvent(0.0, "start", "session 1")
    events = [start, *swinging(3.0, 107), RunEvent(20.0, "setpoint", "1 m")]
    one, repeats, two = with_repeats_joined(events)
    assert (one, two) == (start, events[-1])
    assert repeats == Repeats(tuple(events[1:-1]))
    html = event_table(events)
    said = "214 changes between 3.00 and 13.65 s: coasting: no frame arrived in time 107 times, tracking 107 times"
    assert f"<details><summary>{said}</summary>" in html
    assert html.partition("<details>")[0].count("<tr>") == 3  # the head, the start, and this one
    assert html.count("<tr>") == 1 + 3 + 1 + 214  # and each by itself within


def test_what_lasts_or_was_wished_stands_by_itself():
    """Lost for 3 s, and a stop, in the middle of much else."""
    lost, stopped = statuses((2.0, LOST), (8.0, "stopped: stop_requested"))
    events = [*swinging(1.0, 10), lost, *swinging(5.0, 10), stopped, *swinging(9.0, 10)]
    joined = with_repeats_joined(events)
    assert [item for item in joined if isinstance(item, RunEvent)] == [lost, stopped]
    assert [len(item.events) for item in joined if isinstance(item, Repeats)] == [20, 20, 20]


def test_a_few_changes_are_told_one_by_one():
    events = swinging(1.0, 2)
    assert with_repeats_joined(events) == events


def test_no_event_is_lost_by_joining():
    events = [*swinging(1.0, 200), RunEvent(40.0, "resume", "1 m"), *swinging(41.0, 5)]
    again = [
        one for item in with_repeats_joined(events) for one in (item.events if isinstance(item, Repeats) else [item])
    ]
    assert again == events
    assert "… and 100 more" in event_table(events)  # of the 400, 300 are in the page


def test_whatever_stands_in_an_event_is_escaped():
    assert "<b>" not in event_table(
        [RunEvent(0.0, "configuration", "<b>"), *statuses(*[(0.1 * k, "<b>") for k in range(9)])]
    )

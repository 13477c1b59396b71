"""How a command says how far it is: a bar with the time that is left, or lines where there is no terminal."""

import io
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pilotfish.cli import console
from pilotfish.cli.progress_lines import clock_text, progress_line, progress_lines, remaining_s


class Clock:
    """A clock that a test sets."""

    time_s = 100.0

    def __call__(self):
        return self.time_s


def said_over(clock, steps, every_s=5.0):
    """What is said when (time since the start, done, total) come one after the other."""
    said = []
    step = progress_lines("reading", said.append, clock, every_s)
    begin = clock.time_s
    for at_s, done, total in steps:
        clock.time_s = begin + at_s
        step(done, total)
    return said


def test_in_a_pipe_a_line_comes_every_few_seconds_with_the_time_that_is_left():
    # 2 pictures a second, looked at every second for 12 s: lines at 5 s and 10 s, and the end at 12 s.
    said = said_over(Clock(), [(t, 2 * t, 24) for t in range(13)])
    # At 5 s 10 of 24 are done, 14 are left: 7 s. At 10 s 20 are done, 4 are left: 2 s.
    assert said == [
        "reading: 42% (10 of 24), 0:05 so far, 0:07 left",
        "reading: 83% (20 of 24), 0:10 so far, 0:02 left",
        "reading: 100% (24 of 24), 0:12 so far, 0:00 left",
    ]


def test_in_a_pipe_brief_work_says_nothing_and_work_of_seconds_its_end():
    assert said_over(Clock(), [(0.01 * k, k, 40) for k in range(41)]) == []
    assert said_over(Clock(), [(0.1 * k, k, 40) for k in range(41)]) == [
        "reading: 100% (40 of 40), 0:04 so far, 0:00 left"
    ]


def test_of_unknown_length_the_count_is_said():
    assert said_over(Clock(), [(6.0, 30, None)]) == ["reading: 30, 0:06 so far"]


def test_bytes_are_said_as_megabytes():
    assert progress_line("reading", 12_340_000, 24_680_000, 4.0, in_bytes=True) == (
        "reading: 50% (12.3 of 24.7 MB), 0:04 so far, 0:04 left"
    )


def test_the_end_is_said_once_even_if_it_is_reported_again():
    said = said_over(Clock(), [(6.0, 1, 2), (7.0, 2, 2), (7.1, 2, 2), (7.2, 2, 2)])
    assert [line.partition(",")[0] for line in said] == ["reading: 50% (1 of 2)", "reading: 100% (2 of 2)"]


def test_before_the_first_step_no_time_is_promised():
    assert progress_line("reading", 0, 10, 6.0) == "reading: 0% (0 of 10), 0:06 so far"


def test_a_count_beyond_the_estimated_total_leaves_nothing():
    assert remaining_s(12, 10, 6.0) == 0.0  # a video's own count of its frames may be too small


@given(st.integers(1, 10**6), st.integers(1, 10**6), st.floats(0.1, 1e5))
def test_at_a_steady_pace_elapsed_and_remaining_add_up_to_the_whole(done, more, pace_s):
    total = done + more
    whole_s = total * pace_s
    assert done * pace_s + remaining_s(done, total, done * pace_s) == pytest.approx(whole_s)


@given(st.integers(0, 360_000))
def test_a_clock_text_says_the_seconds_again(seconds):
    parts = [int(part) for part in clock_text(seconds).split(":")]
    assert sum(part * 60**place for place, part in enumerate(reversed(parts))) == seconds


@pytest.mark.parametrize(("shown", "count"), [(console.progress, "3/10"), (console.byte_progress, "3/10 bytes")])
def test_on_a_terminal_a_bar_has_its_label_count_and_eta(monkeypatch, shown, count):
    screen = io.StringIO()
    terminal = console._Console(file=screen, force_terminal=True, width=120, color_system=None)
    monkeypatch.setattr(console, "_errors", terminal)
    with shown("watching robot1 [s]") as step:
        step(3, 10)
    # The label is text: its brackets are no markup.
    assert re.search(rf"watching robot1 \[s\] .*{count} .*eta -?[\d-]+:", screen.getvalue())


def test_work_of_unknown_length_shows_the_time_on_a_terminal_and_nothing_in_a_pipe(monkeypatch):
    for is_terminal in (True, False):
        screen = io.StringIO()
        output = console._Console(file=screen, force_terminal=is_terminal, width=120, color_system=None)
        monkeypatch.setattr(console, "_errors", output)
        with console.working("fitting") as say:
            say("testing [x]")
        assert ("testing [x] 0:00" in screen.getvalue()) == is_terminal

"""What is known of a robot by its messages, and how it stands in the table: pure functions, no bus."""

import json
import math
from dataclasses import replace

import pytest
from robot_messages import base, command, observation, received, status

from pilotfish.watching import Kind, Message, parse
from pilotfish.watching.columns import COLUMNS, as_dict, ordered, style
from pilotfish.watching.robots import MOST_ROBOTS, Robots, RobotState, Row

BY_NAME = {column.name: column for column in COLUMNS}


def state_of(*messages):
    state = RobotState("robot1")
    for message in messages:
        state.receive(message)
    return state


def texts(state):
    return [event.text for event in state.events]


def test_a_row_has_what_the_newest_messages_say():
    state = state_of(
        received(status(wanted_m=1.1), 0.0),
        received(observation(1.25, -0.1), 0.0),
        received(command(linear_mps=0.3, angular_radps=-0.2), 0.0),
        received(base(1), 0.0),
    )
    row = state.row(0.1)
    assert (row.status, row.reason, row.wheels) == ("tracking", "", "driving")
    assert (row.distance_m, row.bearing_rad, row.linear_mps, row.angular_radps) == (1.25, -0.1, 0.3, -0.2)
    assert row.error_m == pytest.approx(1.1 - 1.25)  # too far: negative
    assert row.output == 0.25
    assert row.age_s == pytest.approx(0.1)


def test_a_distance_that_is_not_measured_is_not_shown():
    state = state_of(
        received(status(), 0.0), received(observation(1.25), 0.0), received(status("lost", "no_tag_found"), 0.1)
    )
    state.receive(received(observation(None), 0.1))
    row = state.row(0.1)
    assert row.distance_m is row.error_m is row.bearing_rad is row.output is None
    assert row.reason == "no tag in the picture"
    assert BY_NAME["distance_m"].text(row) == "-"


def test_the_largest_latency_is_that_of_a_frame_within_10_s():
    """Single frames: 1 ms, one of 9 ms at 1 s. The median of the status, 21 ms, counts from the exposure: 20 ms more
    than the frames' own median. So the largest is 29 ms, until the slow frame is older than 10 s."""
    state = state_of(received(status(latency_s=0.021), 0.0))
    for k in range(60):
        state.receive(received(observation(1.0, latency_s=0.009 if k == 2 else 0.001), 0.5 * k))
        if k == 20:
            assert state.row(10.0).latency_max_s == pytest.approx(0.029)
    row = state.row(29.5)
    assert (row.latency_s, row.latency_max_s) == (0.021, pytest.approx(0.021))
    assert BY_NAME["latency_ms"].text(row) == "21.0 / 21.0"


def test_counters_that_rise_are_shown_for_10_s_and_told_once():
    state = state_of(received(status(tag_margin=5), 0.0))
    for k in range(1, 4):
        state.receive(received(status(tag_margin=5 + k, pose=10 * k), float(k)))
    assert state.row(3.0).rising == {"pose": 30, "tag_margin": 3}
    assert BY_NAME["rising"].text(state.row(3.0)) == "pose +30 (+1)"
    assert [text for text in texts(state) if "rises" in text] == [
        "tag_margin rises (6 by now)",
        "pose rises (10 by now)",
    ]
    assert state.row(13.5).rising == {}


def test_what_had_risen_before_one_looked_is_not_rising():
    assert state_of(received(status(tag_margin=500), 0.0), received(status(tag_margin=500), 1.0)).row(1.0).rising == {}


def test_a_restarted_coordinator_counts_from_0():
    state = state_of(received(status(pose=9), 0.0), received(status(pose=2, session=8), 1.0))
    assert state.row(1.0).rising == {"pose": 2}


def test_two_coordinators_that_take_turns_each_count_for_themselves():
    """1000 and 7 commands of the other one before one looked; each counts 10 more, one with each of its messages."""
    state = RobotState("robot1")
    for k in range(11):
        state.receive(received(status(session=7, rival_commands=1000 + k), 0.2 * k))
        state.receive(received(status(session=8, rival_commands=7 + k), 0.2 * k + 0.1))
    assert state.row(2.2).rising == {"rival_commands": 20}


def test_changes_of_status_and_reason_are_events_and_repetitions_are_none():
    state = state_of(
        received(status(), 0.0),
        received(status(), 0.1),
        received(status("coasting", "no_frame"), 0.2),
        received(status("lost", "no_frame"), 0.3),
        received(base(1), 0.4),
        received(base(2), 0.5),
    )
    assert texts(state) == [
        "tracking",
        "coasting: no frame arrived in time",
        "lost: no frame arrived in time",
        "wheels: driving",
        "wheels: stopped",
    ]
    assert [event.arrival_s for event in state.events] == [0.0, 0.2, 0.3, 0.4, 0.5]


def test_commands_that_differ_from_a_fresh_status_are_no_events():
    """Between two frames the heartbeat coasts already; the status comes with the frames."""
    state = state_of(received(status(), 0.0), received(command("coasting", "no_frame"), 0.03), received(status(), 0.04))
    assert texts(state) == ["tracking"]


def test_a_coordinator_that_says_no_status_is_told_by_its_commands():
    state = state_of(received(command("invalid_input", "another_coordinator"), 5.0))
    assert state.row(5.0).status == "invalid_input"


def test_two_sessions_that_take_turns_are_two_coordinators_and_a_restart_is_one():
    both = state_of(*(received(command(session=7 + k % 2), 0.02 * k) for k in range(20)))
    assert both.row(0.4).status == "two coordinators"
    restarted = state_of(
        received(command(session=7), 0.0), *(received(command(session=8), 0.3 + 0.02 * k) for k in range(9))
    )
    assert restarted.row(0.5).status == "tracking"
    assert "another session of the coordinator: 0000000000000008" in texts(restarted)


def test_messages_of_another_version_are_told_once():
    state = state_of(*2 * [Message(0.0, "ROBOT1_STATUS", "robot1", Kind.unreadable, None)])
    assert texts(state) == ["ROBOT1_STATUS cannot be read: a program of another version"]


def test_pictures_and_robots_that_were_not_asked_for_are_left_out():
    robots = Robots(("Robot2",))
    robots.receive(received(status(), robot="robot1"))
    robots.receive(received(status(), robot="robot2"))
    robots.receive(Message(0.0, "ROBOT2_IMAGE", "ROBOT2_IMAGE", Kind.image, None))
    assert [row.robot for row in robots.rows(0.0)] == ["robot2"]


@pytest.mark.parametrize(("age_s", "freshness"), [(0.49, "fresh"), (0.5, "stale"), (1.99, "stale"), (2.0, "dead")])
def test_a_robot_that_falls_silent_turns_grey_and_then_red(age_s, freshness):
    row = state_of(received(status(), 100.0)).row(100.0 + age_s)
    assert row.freshness == freshness
    colours = {style(row, column) for column in COLUMNS}
    assert colours == {"fresh": {"green", ""}, "stale": {"bright_black"}, "dead": {"red"}}[freshness]


def row(robot, **values):
    return Row(robot, values.pop("status", "tracking"), "", **values)


def test_rows_are_sorted_by_any_column_and_by_name_within_it():
    rows = [row("c", error_m=-0.5), row("a", error_m=0.1), row("b", error_m=None), row("d", error_m=0.1)]
    assert [r.robot for r in ordered(rows, BY_NAME["error_m"], reverse=False)] == ["b", "a", "d", "c"]
    assert [r.robot for r in ordered(rows, BY_NAME["error_m"], reverse=True)] == ["c", "a", "d", "b"]
    assert [r.robot for r in ordered(rows, BY_NAME["robot"], reverse=False)] == ["a", "b", "c", "d"]


@pytest.mark.parametrize("column", COLUMNS, ids=lambda column: column.name)
def test_every_column_shows_and_sorts_a_robot_of_which_nothing_is_known(column):
    nothing, nan = row("a", status=""), row("b", distance_m=math.nan, error_m=math.nan, output=math.inf)
    assert "nan" not in column.text(nan) and "inf" not in column.text(nan)
    assert ordered([nothing, nan], column, reverse=False)
    assert column.help.endswith(".")


def test_json_has_no_numbers_that_json_does_not_have():
    said = json.loads(json.dumps(as_dict(row("a", distance_m=math.nan, rising={"pose": 1})), allow_nan=False))
    assert said["distance_m"] is None
    assert said["rising"] == {"pose": 1}
    assert said["freshness"] == "fresh"


def test_more_robots_than_the_screen_has_are_counted_and_the_silent_one_makes_room():
    robots = Robots()
    for k in range(MOST_ROBOTS + 3):
        robots.receive(received(status(), float(k) / 100.0, robot=f"r{k}"))
    assert len(robots.by_name) == MOST_ROBOTS
    assert robots.left_out() == "3 robots more"
    robots.receive(received(status(), 61.0, robot="r70"))  # r0 has been silent for more than a minute
    assert len(robots.by_name) == MOST_ROBOTS
    assert "r70" in robots.by_name and "r0" not in robots.by_name


def test_names_that_are_no_robots_are_counted_without_end_in_bounded_memory():
    robots = Robots()
    for k in range(1500):
        robots.receive(parse(f"a {k}_STATUS", b"", 0.0))
    assert robots.by_name == {}
    assert robots.left_out() == "1000 or more other channels"


def test_the_leader_is_named_as_on_the_page_of_view():
    row = Row("robot1", "tracking", "", leader_index=0)
    assert BY_NAME["leader"].text(row) == "first"
    assert BY_NAME["leader"].text(replace(row, leader_index=2, leader_changes=3)) == "other 2 (3 changes)"
    assert BY_NAME["leader"].text(replace(row, leader_index=None)) == "-"


def test_the_reason_stands_before_what_a_narrow_terminal_may_cut_off():
    names = [column.name for column in COLUMNS]
    assert names.index("reason") < min(names.index(name) for name in ("rising", "leader", "wheels"))

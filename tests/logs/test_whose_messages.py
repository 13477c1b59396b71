"""Recordings in which two coordinators of one name take turns, or a bit of a channel's name has changed."""

import pytest
from recordings import Writer

from pilotfish.logs import read_run


def said(run, kind):
    return [event.text for event in run.robots["robot1"].events if event.kind == kind]


def test_two_coordinators_that_take_turns_are_counted_each_for_itself(tmp_path):
    """1 to 5 and 101 to 105 commands of the other, alternately: 5 + 105 in all."""
    writer = Writer(tmp_path / "run.log")
    for k in range(1, 6):
        for writer.session, already in ((77, 0), (78, 100)):
            writer.counter = k - 1
            writer.frame(rejected={"rival_commands": already + k})
            writer.passes()
    run = read_run(writer.file)
    assert run.robots["robot1"].counters == {"rival_commands": 110}
    assert run.robots["robot1"].sessions == (77, 78)
    assert said(run, "start") == [
        "session 77 of the coordinator",
        "session 78 of the coordinator",
        "two coordinators take turns: session 77 speaks again",
    ]
    assert said(run, "gap") == []


@pytest.mark.parametrize("channel", ["ROBOT1_OBSERVATIGN", "ROBO\x141_STATUS", "ROBOt1_STATUS", "ROBOT3_STATUS"])
def test_one_message_on_a_channel_a_bit_away_from_another_is_damage_and_no_robot(tmp_path, channel):
    writer = Writer(tmp_path / "run.log")
    kind = writer.status() if channel.endswith("STATUS") else writer.observation(1.0)
    for k in range(20):
        writer.frame()
        writer.passes()
        if k == 10:
            writer.raw(channel, kind.encode())
    run = read_run(writer.file)
    assert list(run.robots) == ["robot1"]
    assert any("damaged channel's name" in text and repr(channel) in text for text in run.losses)


def test_a_second_robot_whose_name_is_a_bit_away_is_a_robot(tmp_path):
    """ROBOT1 and ROBOT3 differ in one bit; two messages are no coincidence."""
    writer = Writer(tmp_path / "run.log")
    for _ in range(20):
        writer.frame()
        writer.passes()
    for _ in range(2):
        writer.raw("ROBOT3_STATUS", writer.status().encode())
        writer.passes()
    run = read_run(writer.file)
    assert set(run.robots) == {"robot1", "robot3"}
    assert run.losses == ()

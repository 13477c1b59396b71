"""A first look at a recording: what cannot be in it is known without reading it, and nothing that may be is refused."""

import pytest
from typer.testing import CliRunner

from logs.recordings import Writer
from pilotfish.cli import app
from pilotfish.errors import RecordingError
from pilotfish.logs import messages
from pilotfish.logs.glance import COMMANDS, FRAMES, check_recorded, missing_kinds


def pictures_and_poses(file, count=50):
    """What a bus carries without a coordinator."""
    import numpy as np

    from pilotfish.lcmtypes.bot_core import pose_t

    writer = Writer(file)
    for _ in range(count):
        writer.write("POSE", pose_t())
        writer.image(np.zeros((48, 64), np.uint8))
        writer.passes()
    return writer


@pytest.mark.parametrize("words", [["identify"], ["plot"], ["report", "--out", "{tmp}/page.html"]], ids=lambda w: w[0])
def test_a_log_without_a_coordinator_is_refused_without_decoding_any_of_it(tmp_path, monkeypatch, words):
    def never(*_):
        raise AssertionError("decoded")

    log = pictures_and_poses(tmp_path / "run.lcmlog").file
    for kind in messages.TYPES.values():
        monkeypatch.setattr(kind, "decode", never)
    result = CliRunner().invoke(app, [word.format(tmp=tmp_path) for word in words] + [str(log)])
    assert result.exit_code == 65, result.output
    assert "no frame of a coordinator in it; channels in it: ROBOT1_IMAGE, ROBOT1_POSE" in result.output


def test_the_first_frame_and_the_first_command_end_the_look(tmp_path):
    """What lies behind them is not looked at: here it is damaged, which would leave everything open."""
    writer = pictures_and_poses(tmp_path / "run.lcmlog", 2)
    writer.frame()
    writer.file.write_bytes(writer.file.read_bytes() + b"no event of LCM at all, and long enough to be one" * 2)
    assert missing_kinds(writer.file, None, [FRAMES, COMMANDS]) == (set(), set())
    check_recorded(writer.file, "Robot1", commands=True)


def test_frames_of_another_robot_and_frames_without_commands_are_told_apart(tmp_path):
    writer = pictures_and_poses(tmp_path / "run.lcmlog", 2)
    writer.write("STATUS", writer.status())
    check_recorded(writer.file)
    with pytest.raises(RecordingError, match="no command of a coordinator is recorded: record NAME_COMMAND"):
        check_recorded(writer.file, commands=True)
    with pytest.raises(RecordingError, match=r"no frame of robot 'robot2' in it; channels in it: .*ROBOT1_STATUS"):
        check_recorded(writer.file, "robot2")


def test_nothing_is_refused_for_what_may_lie_behind_a_damaged_place(tmp_path):
    writer = pictures_and_poses(tmp_path / "run.lcmlog", 2)
    hole = writer.file.stat().st_size
    writer.file.write_bytes(writer.file.read_bytes() + b"\0" * 100)
    writer.frame()
    assert writer.file.stat().st_size > hole + 100
    check_recorded(writer.file, commands=True)


def test_an_event_that_is_cut_at_the_end_of_the_file_counts_for_nothing(tmp_path):
    writer = pictures_and_poses(tmp_path / "run.lcmlog", 2)
    writer.write("STATUS", writer.status())
    writer.file.write_bytes(writer.file.read_bytes()[:-1])
    with pytest.raises(RecordingError, match="no frame"):
        check_recorded(writer.file)

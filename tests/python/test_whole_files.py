"""Files are written whole or not at all, and never over what is read or was made by hand."""

import resource
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pilotfish import data
from pilotfish.cli import app
from pilotfish.errors import ExistsError
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.whole_files import check_not_among, check_same, write_whole, written_whole
from scenes import leader_pictures, save_pictures


def run(*words):
    result = CliRunner().invoke(app, [str(word) for word in words])
    return result.exit_code, " ".join(result.output.split())


def test_what_fails_half_way_leaves_what_was_there_and_nothing_beside_it(tmp_path):
    file = tmp_path / "kept"
    file.write_text("of old")

    def write_half():
        with written_whole(file) as partial:
            partial.write_text("half")
            raise OSError("the disk is full")

    with pytest.raises(OSError, match="full"):
        write_half()
    assert file.read_text() == "of old"
    assert list(tmp_path.iterdir()) == [file]


def test_a_folder_that_is_missing_is_made(tmp_path):
    write_whole(tmp_path / "a" / "b", "text")
    assert (tmp_path / "a" / "b").read_text() == "text"


def test_the_same_text_may_be_written_again_and_another_not(tmp_path):
    file = tmp_path / "a.yaml"
    check_same(file, "one", "--replace")
    write_whole(file, "one")
    check_same(file, "one", "--replace")
    with pytest.raises(ExistsError, match=r"a\.yaml is there already and says something else.*--replace"):
        check_same(file, "two", "--replace")


def test_an_input_is_known_under_any_name(tmp_path):
    (tmp_path / "a").write_text("")
    (tmp_path / "link").symlink_to("a")
    check_not_among(tmp_path / "new", [tmp_path / "a"])
    with pytest.raises(ExistsError, match="link is what is read"):
        check_not_among(tmp_path / "link", [tmp_path / "missing", tmp_path / "a"])


def test_printing_a_board_does_not_replace_a_configuration_of_that_name(tmp_path):
    config = tmp_path / "robot1.yaml"
    config.write_text("name: robot1\n")
    code, said = run("tags", "--board", "charuco", "--out", tmp_path / "robot1.pdf")
    assert code == 74 and "is there already and says something else" in said
    assert config.read_text() == "name: robot1\n"
    assert not (tmp_path / "robot1.pdf").exists()
    assert run("tags", "--board", "charuco", "--out", tmp_path / "robot1.pdf", "--replace")[0] == 0
    assert "board" in config.read_text()
    assert run("tags", "--board", "charuco", "--out", tmp_path / "robot1.pdf")[0] == 0  # the same again


def test_printing_a_leader_does_not_replace_one_that_was_measured(tmp_path):
    leader = tmp_path / "keep.yaml"
    leader.write_text("measured: by hand\n")
    code, said = run("tags", "--ids", "7", "--size", "0.16", "--leader", leader, "--out", tmp_path / "a.pdf")
    assert code == 74 and "--replace" in said
    assert leader.read_text() == "measured: by hand\n"


def test_a_calibration_does_not_replace_its_board(tmp_path):
    assert run("tags", "--board", "charuco", "--out", tmp_path / "board.pdf")[0] == 0
    board = tmp_path / "board.yaml"
    before = board.read_text()
    code, said = run("calibrate", "camera", tmp_path, "--board", board, "--out", board)
    assert code == 74 and "is what is read" in said
    assert board.read_text() == before


@pytest.mark.parametrize("command", [["report"], ["export", "--to", "csv"]])
def test_a_recording_is_not_replaced_by_what_is_made_of_it(tmp_path, command):
    log = tmp_path / "run.lcmlog"
    log.write_bytes(b"\xed\xa1\xda\x01" + bytes(40))
    for source in (log, tmp_path):
        code, said = run(command[0], source, *command[1:], "--out", log)
        assert code == 74 and "is what is read" in said
    assert log.stat().st_size == 44


def test_a_recording_on_a_disk_that_takes_nothing_is_said_at_once_and_at_the_end(tmp_path):
    """A limit on the size of files is to a writer what a full disk is; pipes have none."""
    save_pictures(leader_pictures(60), tmp_path / "run")
    command = [str(find_executable(COORDINATOR)), "--config", str(data.path("config/line.yaml"))]
    command += ["--source", f"images:{tmp_path / 'run'}", "--lcm-url", "memq://", "--record", str(tmp_path / "box")]
    limit = 1000
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=60,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
    )
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert "the recording loses events, the disk refuses them: File too large" in said
    assert "the recording is not whole: " in said


HOLD = """
import sys, time
from pathlib import Path
from pilotfish.whole_files import written_whole
with written_whole(Path(sys.argv[1])) as partial:
    partial.write_text("half")
    print(partial, flush=True)
    sys.stdin.read()
"""


def half_written(file):
    """A process that has begun to write, and the partial file that it writes to."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(file)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    return process, Path(process.stdout.readline().strip())


def test_what_a_killed_process_left_is_removed_by_the_next_that_writes_the_file(tmp_path):
    file = tmp_path / "run [1].mcap"
    process, partial = half_written(file)
    with process:
        process.kill()
    assert partial.read_text() == "half"
    write_whole(file, "whole")
    assert file.read_text() == "whole"
    assert list(tmp_path.iterdir()) == [file]


def test_what_another_process_is_still_writing_is_left_alone(tmp_path):
    file = tmp_path / "run.mcap"
    process, partial = half_written(file)
    with process:
        write_whole(file, "mine")
        assert partial.read_text() == "half"
        process.stdin.close()
        assert process.wait(30) == 0
    assert file.read_text() == "half"  # it ended last
    assert list(tmp_path.iterdir()) == [file]


def test_files_that_are_no_partial_ones_of_this_file_stay(tmp_path):
    others = [".run.mcap.part", ".run.mcap.x.part", ".other.mcap.12.part", "run.mcap.12.part", ".run.mcap.12.parts"]
    for name in others:
        (tmp_path / name).write_text("precious")
    write_whole(tmp_path / "run.mcap", "whole")
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted([*others, "run.mcap"])

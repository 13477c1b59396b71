"""What commands write: one rule for all of them, and a failure that names the file and leaves nothing behind."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from command_lines import LAW, LEADER
from typer.testing import CliRunner

from pilotfish.cli import app
from pilotfish.cli.outputs import OutputFolder, output_file, output_folder, output_picture
from pilotfish.errors import ExistsError
from pilotfish.whole_files import written_whole


def run(*words, code=0):
    result = CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "300"})
    assert result.exit_code == code, result.output
    return result.output


# Each writes one file, which is the last word. None takes longer than a second.
WRITING = {
    "tags": (["tags", "--ids", "0", "--out"], "a.pdf"),
    "tags of a leader": (["tags", "--body", LEADER, "--out"], "a.pdf"),
    "leader show": (["leader", "show", LEADER, "--out"], "a.png"),
    "formation show": (["formation", "show", "wedge", "--out"], "a.png"),
    "formation expand": (["formation", "expand", "wedge", "--out"], "a.yaml"),
    "fuzzy explain": (["fuzzy", "explain", LAW, "--e", "0.1", "--out"], "a.png"),
    "fuzzy convert": (["fuzzy", "convert", LAW], "a.fll"),
}


@pytest.mark.parametrize(("words", "name"), WRITING.values(), ids=WRITING)
def test_a_file_that_is_replaced_and_a_folder_that_is_made_are_both_said(tmp_path, words, name):
    file = tmp_path / "new" / name
    assert f"wrote {file} (in the new folder {tmp_path / 'new'})" in run(*words, file)
    assert f"wrote {file} (replaced)" in run(*words, file)
    assert f"wrote {file.with_stem('b')}" in (said := run(*words, file.with_stem("b")))
    assert "(replaced)" not in said and "(in the new folder" not in said


def test_pictures_that_are_replaced_in_a_folder_are_said_one_by_one(tmp_path):
    (tmp_path / "coordination_sets.png").write_text("of old")
    said = run("plot", LAW, "--out", tmp_path)
    assert f"wrote {tmp_path / 'coordination_sets.png'} (replaced)\n" in said
    assert f"wrote {tmp_path / 'coordination_surface.png'}\n" in said


@pytest.mark.parametrize("words", [words for words, name in WRITING.values() if name.endswith(".png")])
def test_the_ending_of_a_picture_is_checked_alike_everywhere(words):
    assert "--out: 'a.gif' ends in none of .png, .svg, .pdf" in run(*words, "a.gif", code=64)


def test_the_ending_may_be_in_capitals(tmp_path):
    assert output_picture(tmp_path / "a.PNG").file == tmp_path / "a.PNG"
    with pytest.raises(typer.BadParameter, match=r"--plot: 'a' ends in none of \.png, \.svg, \.pdf"):
        output_picture(tmp_path / "a", "--plot")


def test_trying_a_place_leaves_nothing_and_changes_nothing(tmp_path):
    (tmp_path / "old").write_text("of old")
    output_file(tmp_path / "a" / "b" / "new")
    output_folder(tmp_path / "c" / "d")
    output_file(tmp_path / "old")
    assert (tmp_path / "old").read_text() == "of old"
    assert list(tmp_path.iterdir()) == [tmp_path / "old"]


@pytest.mark.parametrize(
    ("file", "says"),
    [
        ("/proc/x.yaml", "nothing can be written in /proc: No such file or directory"),
        ("/proc/no/such/x.yaml", "nothing can be written in /proc: No such file or directory"),
        ("{tmp}/file/x.yaml", "nothing can be written in {tmp}/file: Not a directory"),
        ("{tmp}", "Is a directory"),
        ("{tmp}/nowhere", "No such file or directory"),
    ],
)
def test_a_place_that_cannot_be_written_is_known_before_the_work(tmp_path, file, says):
    (tmp_path / "file").write_text("")
    (tmp_path / "nowhere").symlink_to(tmp_path / "gone" / "away")
    with pytest.raises(OSError, match=r".*") as refused:
        output_file(Path(file.format(tmp=tmp_path)))
    assert refused.value.filename == file.format(tmp=tmp_path)
    assert refused.value.strerror == says.format(tmp=tmp_path)


def test_what_is_read_is_not_written_over(tmp_path):
    (tmp_path / "a").write_text("")
    with pytest.raises(ExistsError, match="a is what is read"):
        output_file(tmp_path / "a", [tmp_path / "a"])


def test_a_pipe_and_a_device_are_written_where_they_are(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for place in (tmp_path / "pipe", Path("/dev/null")):
        assert output_file(place).note == ""


def test_a_search_of_minutes_does_not_begin_if_its_result_cannot_be_written(monkeypatch):
    monkeypatch.setattr("pilotfish.tuning.searching", lambda *_: pytest.fail("it began"))
    said = run("tune", "pid", "--out", "/proc/x.yaml", code=74)
    assert said == "pilotfish: /proc/x.yaml: nothing can be written in /proc: No such file or directory\n"


def test_a_failure_of_the_system_names_the_file_that_was_asked_for(tmp_path):
    """The file beside it, which nobody knows, is not named; another file's name is kept."""
    file = tmp_path / "new" / "a"
    for filename, named in ((None, file), ("{partial}", file), ("/other", "/other")):
        with pytest.raises(OSError, match="No space left") as failed, written_whole(file) as partial:
            raise OSError(28, "No space left on device", filename and filename.format(partial=partial))
        assert failed.value.filename == str(named)
    assert list(tmp_path.iterdir()) == []


def test_folders_that_are_not_empty_stay_when_something_fails(tmp_path):
    def write():
        with written_whole(tmp_path / "new" / "deep" / "a"):
            (tmp_path / "new" / "of another").write_text("")
            raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space left"):
        write()
    assert [path.name for path in tmp_path.rglob("*")] == ["new", "of another"]


LARGE = {
    "tags": WRITING["tags"],
    "leader show": WRITING["leader show"],
    "tune": (["tune", "pid", "--trials", "1", "--out"], "a.yaml"),
    "init": (["init", "robot1", "--dir"], ""),
}


@pytest.mark.parametrize(("words", "name"), LARGE.values(), ids=LARGE)
def test_a_disk_that_is_full_names_the_file_and_leaves_no_folder(tmp_path, words, name):
    """A disk with no byte left, as a limit to the size of files: what is written is larger than that."""
    file = tmp_path / "new" / "deep" / name if name else tmp_path / "new" / "deep"
    done = subprocess.run(
        [sys.executable, "-m", "pilotfish", *map(str, [*words, file])],
        capture_output=True,
        text=True,
        timeout=60,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)),
    )
    assert done.returncode == 74, done.stderr
    assert done.stderr.splitlines()[-1].startswith(f"pilotfish: {file}")
    assert done.stderr.splitlines()[-1].endswith(": File too large")
    assert "wrote" not in done.stdout
    assert list(tmp_path.iterdir()) == []


def test_a_folder_remembers_what_stood_in_it(tmp_path, capsys):
    (tmp_path / "old").write_text("")
    into = OutputFolder(tmp_path)
    (tmp_path / "new").write_text("")
    into.wrote(tmp_path / "old")
    into.wrote(tmp_path / "new")
    assert capsys.readouterr().out == f"wrote {tmp_path / 'old'} (replaced)\nwrote {tmp_path / 'new'}\n"


def test_a_new_folder_is_said_of_what_was_asked_for_and_not_of_what_stands_beside_it(tmp_path):
    out = tmp_path / "new" / "run.lcmlog"
    said = run("render", "mounting", "--out", out, "--fov-deg", "60", "--size", "160x120", "--rate-hz", "4")
    assert f"to {out} (in the new folder {out.parent})\n" in said
    assert f"wrote {out.parent / 'run_truth.yaml'}\n" in said
    pictures = tmp_path / "pictures"
    said = run("render", "board", "--out", pictures, "--views", "3", "--fov-deg", "60", "--size", "160x120")
    assert f"wrote 3 pictures to {pictures}\n" in said
    assert f"wrote {pictures / 'truth.yaml'}\n" in said  # which the folder of the pictures has been made for


@pytest.mark.parametrize("words", [words for words, name in WRITING.values() if name.endswith(".png")])
def test_a_picture_whose_ending_is_in_capitals_is_written(tmp_path, words):
    run(*words, tmp_path / "a.SVG")
    assert "<svg" in (tmp_path / "a.SVG").read_text()

"""``pilotfish plot``, ``report`` and ``export`` as somebody types them."""

from __future__ import annotations

import builtins
import re
import shutil
import sys

import numpy as np
import pytest
from recordings import WALL_US, Writer, event
from typer.testing import CliRunner

from pilotfish.cli import app
from pilotfish.logs import read_run

runner = CliRunner()
pytestmark = pytest.mark.usefixtures("small_pictures")


def run(*arguments):
    result = runner.invoke(app, [str(argument) for argument in arguments])
    said = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    return result.exit_code, re.sub(r"[\s│]+", " ", said)


@pytest.fixture
def log(tmp_path):
    writer = Writer(tmp_path / "run.lcmlog")
    for k in range(10):
        writer.image(np.full((48, 64), 90, np.uint8))
        writer.frame(1.0 + 0.01 * k)
        writer.passes()
    return writer.file


def test_a_black_box_is_plotted_from_its_folder(recorded, tmp_path):
    code, said = run("plot", recorded.box, "--out", tmp_path)
    assert code == 0, said
    assert {file.name for file in tmp_path.glob("*.png")} == {"box_run.png", "box_relative.png"}


@pytest.mark.parametrize(("name", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_a_file_of_lcm_logger_is_plotted_in_every_format_whatever_it_is_called(log, tmp_path, name, magic):
    (odd,) = [log.rename(log.with_name("lcmlog-2026-01-02.00"))]
    code, said = run("plot", odd, "--format", name, "--dark")
    assert code == 0, said
    files = sorted(tmp_path.glob(f"*.{name}"))
    assert len(files) == 2
    assert all(file.read_bytes().startswith(magic) for file in files)


def test_the_other_kinds_are_plotted_in_other_formats_too_but_not_in_the_dark(tmp_path):
    from pilotfish import data

    law = data.path("fuzzy/coordination.yaml")
    assert run("plot", law, "--out", tmp_path, "--format", "svg")[0] == 0
    assert len(list(tmp_path.glob("coordination_*.svg"))) == 2
    code, said = run("plot", law, "--out", tmp_path, "--dark")
    assert code == 64
    assert "--dark is for" in said


def test_every_robot_of_a_recording_is_plotted_or_the_one_that_is_named(tmp_path):
    for robot in ("robot1", "robot2"):
        Writer(tmp_path / f"{robot}-{WALL_US}-0.lcmlog", robot=robot.upper()).frame()
    assert run("plot", tmp_path, "--out", tmp_path / "all")[0] == 0
    assert len(list((tmp_path / "all").glob("*_robot?_*.png"))) == 4
    assert run("plot", tmp_path, "--robot", "robot2", "--out", tmp_path / "one")[0] == 0
    assert len(list((tmp_path / "one").iterdir())) == 2


def test_a_recording_without_a_coordinator_says_what_is_in_it(tmp_path):
    writer = Writer(tmp_path / "run.lcmlog")
    writer.command()
    for command in (["plot", writer.file], ["report", writer.file, "--out", tmp_path / "x.html"]):
        code, said = run(*command)
        assert code == 65
        assert "channels in it: ROBOT1_COMMAND" in said


def test_a_report_of_several_runs_names_them_by_what_tells_them_apart(recorded, log, tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    shutil.copy(log, tmp_path / "a" / "run.lcmlog")
    shutil.copy(log, tmp_path / "b" / "run.lcmlog")
    out = tmp_path / "report.html"
    code, said = run("report", tmp_path / "a" / "run.lcmlog", tmp_path / "b" / "run.lcmlog", "--out", out)
    assert code == 0, said
    assert ">a/run.lcmlog</th>" in out.read_text() and ">b/run.lcmlog</th>" in out.read_text()


@pytest.fixture
def cut(log):
    """Ten frames, 33 ms apart, of which the last event lacks its last 7 bytes: it began 0.30 s after the first."""
    log.write_bytes(log.read_bytes()[:-7])
    return log


@pytest.mark.parametrize("kind", ["csv", "parquet", "mcap"])
def test_an_export_of_a_recording_that_was_cut_off_says_where_it_ends_and_what_is_lost(cut, tmp_path, kind):
    code, said = run("export", cut, "--out", tmp_path / f"run.{kind}")
    assert code == 0, said
    (status_bytes,) = [one.size for one in read_run(cut).damage]
    assert "run.lcmlog ends in the middle of an event, 0.30 s after the recording began" in said
    assert f"its last {status_bytes} bytes cannot be read" in said


def test_a_plot_of_a_recording_that_was_cut_off_says_so(cut, tmp_path):
    code, said = run("plot", cut, "--out", tmp_path)
    assert code == 0, said
    assert "warning: run.lcmlog ends in the middle of an event, 0.30 s after the recording began" in said


def test_a_hole_in_a_recording_is_told_in_bytes_and_seconds(log, tmp_path):
    """Everything of the frames at 33 to 67 ms is overwritten: from the last event at 0 to the first one at 100 ms."""
    content = log.read_bytes()
    at = [offset for offset in range(len(content)) if content[offset : offset + 4] == event(0, "A", b"")[:4]]
    begin, end = at[4], at[12]  # four events a frame
    log.write_bytes(content[:begin] + bytes(end - begin) + content[end:])
    (said,) = read_run(log).losses
    assert said.startswith(f"run.lcmlog: {end - begin} bytes at byte {begin} are no events")
    assert said.endswith("up to 0.10 s are lost, between 0.00 and 0.10 s")


def test_a_report_of_a_damaged_recording_is_made_and_warned_about(log, tmp_path):
    log.write_bytes(log.read_bytes()[:-10])
    code, said = run("report", log, "--out", tmp_path / "x.html")
    assert code == 0
    assert "warning: run.lcmlog ends in the middle of an event" in said
    assert "ends in the middle of an event" in (tmp_path / "x.html").read_text()


@pytest.mark.parametrize("suffix", ["csv", "parquet", "mcap", "mp4"])
def test_the_suffix_says_the_format(log, tmp_path, suffix):
    code, said = run("export", log, "--out", tmp_path / "deep" / f"x.{suffix}")
    assert code == 0, said
    assert (tmp_path / "deep" / f"x.{suffix}").stat().st_size > 100


@pytest.mark.parametrize(
    ("options", "code", "word"),
    [
        (["--out", "x.txt"], 64, "mcap, csv, parquet, mp4"),
        (["--out", "x"], 64, "--to"),
        (["--to", "xls", "--out", "x"], 64, "xls"),
        (["--to", "csv"], 64, "--out"),
        (["--out", "x.csv", "--table", "secrets"], 64, "secrets"),
        (["--out", "x.csv", "--table", "wheels"], 65, "frames (10)"),
        (["--out", "x.csv", "--robot", "robot9"], 65, "robot 'robot9'"),
        (["--out", "x.mp4", "--robot", "robot9"], 65, "cameras in it: robot1"),
    ],
)
def test_a_wrong_option_is_named_with_what_is_allowed(log, tmp_path, monkeypatch, options, code, word):
    monkeypatch.chdir(tmp_path)
    result, said = run("export", log, *options)
    assert result == code, said
    assert word in said
    assert [file.name for file in tmp_path.iterdir()] == ["run.lcmlog"]


def test_a_recording_is_not_overwritten_by_its_own_export(log, tmp_path):
    before = log.read_bytes()
    (tmp_path / "link.csv").symlink_to(log)
    for out in (log, tmp_path / "link.csv"):
        code, said = run("export", log, "--to", "csv", "--out", out)
        assert code == 74
        assert "is what is read" in said
    assert log.read_bytes() == before


@pytest.mark.parametrize(("suffix", "package"), [("parquet", "pyarrow"), ("mcap", "mcap"), ("mp4", "av")])
def test_a_missing_package_ends_with_69_and_the_command_that_installs_it(log, tmp_path, monkeypatch, suffix, package):
    real = builtins.__import__

    def without(name, *rest):
        if name.split(".")[0] == package:
            raise ModuleNotFoundError(f"No module named '{name}'", name=name)
        return real(name, *rest)

    for name in [name for name in sys.modules if name.split(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr("importlib.import_module", lambda name: without(name))
    code, said = run("export", log, "--out", tmp_path / f"x.{suffix}")
    assert code == 69
    assert "pip install 'pilotfish[export]'" in said


def test_events_of_others_between_ours_are_no_trouble(log, tmp_path):
    log.write_bytes(event(WALL_US, "CHAT", b"hello") + log.read_bytes() + event(WALL_US, "X_STATUS", b""))
    assert run("export", log, "--out", tmp_path / "x.mcap")[0] == 0
    assert run("plot", log)[0] == 0

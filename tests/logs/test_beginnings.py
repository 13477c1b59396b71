"""Recordings that begin in the middle of a run: no start, no approach, and what is not in them is said."""

from __future__ import annotations

import math
import struct

import pytest
from recordings import WALL_US, Writer
from test_summary import PERIOD_S, approach, robot_of

from pilotfish.lcmtypes.pilotfish import box_start_t
from pilotfish.logs import read_run
from pilotfish.logs.beginning import approach_is_missing, late_beginnings
from pilotfish.logs.report import ReportedRun
from pilotfish.logs.report.page import summary_section
from pilotfish.logs.summary import summarize


def cut(writer, events):
    """The recording without its first events, as a ring is whose oldest file has been deleted."""
    data, at = writer.file.read_bytes(), 0
    for _ in range(events):
        letters, size = struct.unpack_from(">ii", data, at + 20)
        at += 28 + letters + size
    writer.file.write_bytes(data[at:])


@pytest.mark.parametrize("first", ["COMMAND", "OBSERVATION", "STATUS"])
def test_a_recording_that_begins_in_the_middle_of_a_run_has_no_start_and_no_approach(tmp_path, first):
    """400 frames of three messages each; the first 100 frames are cut away, with the approach in them."""
    writer = Writer(tmp_path / "run.log")
    approach(writer)
    cut(writer, 300 + ["COMMAND", "OBSERVATION", "STATUS"].index(first))
    robot = robot_of(writer)
    assert {event.kind for event in robot.events} == {"begin", "status"}
    assert late_beginnings(robot) == [
        "the recording begins after the start of the coordinator: "
        f"{100 + (first != 'COMMAND')} commands of session 77 came before"
    ]
    summary = summarize(robot)
    assert math.isnan(summary.settling_s) and math.isnan(summary.approach_from_mm)
    assert summary.rms_distance_error_mm == pytest.approx(2.0, abs=1e-6)  # the last quarter is in it


def test_a_setpoint_in_the_middle_of_such_a_recording_begins_an_approach(tmp_path):
    writer = Writer(tmp_path / "run.log")
    approach(writer)
    approach(writer, setpoint_m=1.3)
    cut(writer, 300)
    robot = robot_of(writer)
    assert not approach_is_missing(robot)
    assert summarize(robot).settling_s == pytest.approx(45 * PERIOD_S, abs=1.1 * PERIOD_S)
    assert [event.text for event in robot.events if event.kind == "setpoint"] == ["1.3 m at 0°"]


def test_a_recording_without_commands_begins_where_it_begins(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for _ in range(40):
        writer.write("OBSERVATION", writer.observation(1.0))
        writer.write("STATUS", writer.status(1.0))
        writer.passes()
    assert [event.kind for event in robot_of(writer).events] == ["start", "setpoint"]


@pytest.mark.parametrize("beside", [False, True])
def test_a_ring_without_its_oldest_file_says_how_long_after_the_start_it_begins(tmp_path, beside):
    """The file's name says when the program started: 16.7 s before its first event. 500 calls are in earlier files."""
    start_utime = WALL_US - 16_700_000
    writer = Writer(tmp_path / f"robot1-{start_utime}-3.lcmlog")
    if beside:
        (tmp_path / f"robot1-{start_utime}-2.lcmlog").write_bytes(b"")
    box = box_start_t()
    box.robot, box.session, box.sequence = "robot1", writer.session, 500
    writer.write("BOX", box)
    for _ in range(3):
        writer.frame()
        writer.passes()
    robot = read_run(writer.file).robots["robot1"]
    kinds = [event.kind for event in robot.events]
    assert "start" not in kinds and "setpoint" not in kinds
    why = f"earlier files (robot1-{start_utime}-2.lcmlog, ...) are beside it and were not read"
    what = why if beside else "earlier files were deleted"
    text = f"the recording begins 16.7 s after the start of the coordinator: {what}"
    assert [event.text for event in robot.events if event.kind == "begin"] == [text, "keeps 1.1 m at 0°, as before"]


def summary_of(robot, path):
    run = read_run(path)
    return summary_section([ReportedRun("run", run, robot)])


def test_the_page_of_a_run_whose_approach_is_not_recorded_has_no_figures_of_it(tmp_path):
    writer = Writer(tmp_path / "run.log")
    approach(writer)
    cut(writer, 300)
    page = summary_of(robot_of(writer), writer.file)
    assert "100 commands of session 77 came before; the approach is not in it, and has no figures." in page
    assert page.count("the approach is not recorded") == 1  # one tile: the other figures are of the end, which is there
    assert "not settled" not in page


def test_the_page_of_a_run_without_a_measurement_names_the_cause_and_does_not_speak_of_settling(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for _ in range(50):
        writer.frame(None)
        writer.passes()
    page = summary_of(robot_of(writer), writer.file)
    assert "run: the leader was never measured: no tag in the picture (all 50 frames)." in page
    assert "settled" not in page and "never followed" not in page

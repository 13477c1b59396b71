"""Status and command of a frame are those that left, whoever recorded them."""

from __future__ import annotations

import numpy as np
import pytest
from recordings import LOST, NO_FRAME, TRACKING, Writer

from pilotfish import core
from pilotfish.errors import RecordingError
from pilotfish.lcmtypes.pilotfish import step_t
from pilotfish.logs import read_run

FRAME_STALE = int(core.Reason.frame_stale)


def step_of(writer, sequence, linear_mps):
    """The core's call for the frame: it decides to drive."""
    step = step_t()
    step.sequence, step.kind, step.utime, step.now_us = sequence, step_t.KIND_FRAME, writer.stamp_us, writer.stamp_us
    step.status, step.command_linear_mps = TRACKING, linear_mps
    return step


def test_what_left_counts_and_not_what_the_core_had_decided(tmp_path):
    """A busy computer: the answer to the second frame comes too late, and a zero leaves in its place. The bus knows the
    zero only, the black box both; either recording tells the same."""
    runs = {}
    for kind in ("box", "bus"):
        (tmp_path / kind).mkdir()
        writer = Writer(tmp_path / kind / "run.log")
        for k in range(3):
            late = k == 1
            if kind == "box":
                writer.write("STEP", step_of(writer, k, 0.2))
            status, reason = (LOST, FRAME_STALE) if late else (TRACKING, 0)
            writer.command(status, reason, linear_mps=0.0 if late else 0.2)
            writer.write("OBSERVATION", writer.observation(1.0))
            message = writer.status(1.0, reason=reason)
            message.status = status
            writer.write("STATUS", message)
            writer.passes()
        runs[kind] = read_run(writer.file).robots["robot1"].frames
    for frames in runs.values():
        assert frames["command_linear_mps"].tolist() == [0.2, 0.0, 0.2]
        assert frames.words("status").tolist() == ["tracking", "lost", "tracking"]
        assert frames.words("reason").tolist() == ["none", "frame_stale", "none"]


def test_a_repeated_command_does_not_answer_a_frame_whose_own_was_not_heard(tmp_path):
    """UDP lost the answer; what is sent between frames has the stamp, too, and says that no frame came."""
    writer = Writer(tmp_path / "run.log")
    writer.write("OBSERVATION", writer.observation(1.0))
    writer.write("STATUS", writer.status(1.0))
    writer.wall_us += 50_000
    writer.command(LOST, NO_FRAME, linear_mps=0.0)
    frames = read_run(writer.file).robots["robot1"].frames
    assert np.isnan(frames["command_linear_mps"]).tolist() == [True]


def test_a_status_that_was_not_heard_is_that_of_the_answer(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.command(TRACKING, linear_mps=0.2)
    writer.write("OBSERVATION", writer.observation(1.0))
    frames = read_run(writer.file).robots["robot1"].frames
    assert frames.words("status").tolist() == ["tracking"]


def test_a_coordinator_that_never_had_a_picture_is_no_run_to_draw(tmp_path):
    """Without one it says nothing of frames but zeros, with a stamp of 0, and its status when it is stopped."""
    writer = Writer(tmp_path / "run.log")
    writer.stamp_us = 0
    for _ in range(3):
        writer.command(LOST, NO_FRAME, linear_mps=0.0)
    writer.write("OBSERVATION", writer.observation(None))
    writer.write("STATUS", writer.status(None))
    with pytest.raises(RecordingError, match="no frame of a coordinator in it"):
        read_run(writer.file).recorded_coordinators()

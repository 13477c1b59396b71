"""A recording as arrays: in them is what was recorded, whoever recorded it and whatever happened to the file."""

from __future__ import annotations

import random
import tracemalloc

import lcm
import numpy as np
import pytest
from recordings import LOST, NO_FRAME, PERIOD_US, TRACKING, WALL_US, Writer, event

from pilotfish.black_box.log import Damage, Event, events_in
from pilotfish.errors import MissingFileError, RecordingError
from pilotfish.lcmtypes.bot_core import pose_t
from pilotfish.lcmtypes.pilotfish import base_t, box_start_t, motion_t, observation_t, sent_t, status_t, step_t
from pilotfish.logs import read_run, rows_in

PERIOD_S = PERIOD_US * 1e-6


def said(run, kind):
    return [one.text for one in run.robots["robot1"].events if one.kind == kind]


def decoded(file, channel, kind):
    """By liblcm's own reader of logs."""
    log = lcm.EventLog(str(file), "r")
    try:
        return [kind.decode(one.data) for one in log if one.channel == channel]
    finally:
        log.close()


def test_every_number_of_a_black_box_is_the_recorded_one(recorded):
    (file,) = recorded.box.glob("*.lcmlog")
    frames = read_run(recorded.box).robots["robot1"].frames
    steps = [one for one in decoded(file, "ROBOT1_STEP", step_t) if one.kind == step_t.KIND_FRAME]
    assert len(frames) == len(steps) >= 90
    for name in ("distance_m", "bearing_rad", "heading_rad", "heading_ambiguity", "reprojection_error_px"):
        assert frames[name].tolist() == [getattr(one.measurement[0], name) for one in steps]
    assert frames["distance_sigma_m"].tolist() == [one.measurement[0].covariance[0][0] ** 0.5 for one in steps]
    assert frames["command_linear_mps"].tolist() == [one.command_linear_mps for one in steps]
    assert frames["utime_us"].tolist() == [one.utime for one in steps]
    tags = read_run(recorded.box).robots["robot1"].tags  # the bus has these as 32-bit numbers only
    corners = [tag.corners_px[0][0] for one in steps for tag in one.measurement[0].tags]
    assert tags["u0_px"].tolist() == corners
    # The very last report repeats the last frame's stamp: of each stamp the first report counts.
    statuses = {one.utime: one for one in reversed(decoded(file, "ROBOT1_STATUS", status_t))}
    for name in ("error_m", "error_change_m", "output", "drive_lag_s", "processing_ms", "frame_rate_hz"):
        assert frames[name].tolist() == [getattr(statuses[one.utime], name) for one in steps]


def test_lcm_logger_and_the_black_box_tell_the_same_run(recorded):
    box, bus = (read_run(path).robots["robot1"] for path in (recorded.box, recorded.bus))
    common, in_box, in_bus = np.intersect1d(box.frames["utime_us"], bus.frames["utime_us"], return_indices=True)
    # UDP may lose some: of the others the logger has heard observation, status and command.
    heard = [bus.frames["latency_s"], bus.frames["frame_rate_hz"], bus.frames["command_linear_mps"]]
    whole = np.isfinite(heard).all(axis=0)[in_bus]
    common, in_box, in_bus = common[whole], in_box[whole], in_bus[whole]
    assert len(common) >= 0.9 * len(box.frames) > 80
    only_in_a_box = {"arrival_us", "known_age_s", "found_by", "heading_ambiguity"}
    of_the_recorder = {"t_s", "log_utime_us"}
    for name in set(box.frames.arrays) - only_in_a_box - of_the_recorder:
        assert np.array_equal(
            box.frames[name][in_box], bus.frames[name][in_bus], equal_nan=box.frames[name].dtype == float
        ), name
    tags = [dict(zip(one.tags["utime_us"].tolist(), one.tags["u0_px"].tolist(), strict=True)) for one in (box, bus)]
    # The bus carries corners as 32-bit numbers, the black box as 64-bit ones.
    assert all(np.float32(tags[0][utime]) == np.float32(tags[1][utime]) for utime in common.tolist())


def test_the_settings_of_a_black_box_are_those_of_the_files(recorded):
    from pilotfish import data

    settings = read_run(recorded.box).robots["robot1"].last_settings
    texts = {file.role: file.text for file in settings.files}
    assert texts["config"] == data.path("config/line.yaml").read_text()
    assert settings.program.startswith("pilotfish ")
    assert "--black-box" in settings.command_line
    assert "profile=anticipate" in settings.overrides


def test_time_follows_the_stamps(recorded):
    frames = read_run(recorded.box).robots["robot1"].frames
    np.testing.assert_allclose(np.diff(frames["t_s"]), np.diff(frames["utime_us"]) * 1e-6, rtol=0, atol=1e-9)


def test_a_clock_that_is_set_does_not_bend_the_time(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for k in range(20):
        if k == 10:
            writer.stamp_us -= 3_600_000_000  # an hour back
        if k == 15:
            writer.stamp_us += 90_000_000_000  # more than a day ahead
        writer.frame()
        writer.passes()
    time_s = read_run(writer.file).robots["robot1"].frames["t_s"]
    np.testing.assert_allclose(time_s, PERIOD_S * np.arange(20), rtol=0, atol=1e-9)


def test_a_stamp_that_stands_still_does_not_stop_the_time(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for _ in range(3):
        writer.frame()
        writer.wall_us += 20_000
    time_s = read_run(writer.file).robots["robot1"].frames["t_s"]
    np.testing.assert_allclose(time_s, [0.0, 0.02, 0.04], rtol=0, atol=1e-9)


def test_the_first_command_that_names_a_frame_answers_it(tmp_path):
    """Between frames commands are repeated with the last frame's stamp, and end as zeros."""
    writer = Writer(tmp_path / "run.log")
    writer.command(linear_mps=0.4)
    writer.command(LOST, NO_FRAME, linear_mps=0.0)
    writer.write("OBSERVATION", writer.observation(1.0))
    writer.write("STATUS", writer.status(1.0))
    assert read_run(writer.file).robots["robot1"].frames["command_linear_mps"].tolist() == [0.4]


def test_reports_between_frames_are_no_frames(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame()
    for _ in range(3):
        writer.wall_us += 50_000
        writer.command(LOST, NO_FRAME)
        writer.write("OBSERVATION", writer.observation(None, reason=NO_FRAME))
        writer.write("STATUS", writer.status(None, reason=NO_FRAME))
    run = read_run(writer.file)
    assert len(run.robots["robot1"].frames) == 1
    assert len(run.robots["robot1"].commands) == 4
    assert said(run, "status") == ["tracking", "lost: no_frame"]


def test_what_was_not_measured_is_nan_and_not_zero(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for distance_m in (1.0, None, 1.2):
        writer.frame(distance_m)
        writer.passes()
    frames = read_run(writer.file).robots["robot1"].frames
    for name in ("distance_m", "distance_sigma_m", "error_m", "output"):
        assert np.isnan(frames[name]).tolist() == [False, True, False], name
    assert frames["measured"].tolist() == [True, False, True]
    assert frames.words("status").tolist() == ["tracking", "lost", "tracking"]
    assert frames.words("reason").tolist() == ["none", "no_tag_found", "none"]


def test_setpoints_count_when_they_are_taken_and_not_when_they_are_asked_for(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for setpoint_m, run in ((1.1, True), (1.1, True), (1.3, True), (1.3, False), (1.3, True)):
        writer.setpoint()
        writer.frame(setpoint_m=setpoint_m, run=run)
        writer.passes()
    run = read_run(writer.file)
    assert said(run, "setpoint") == ["1.1 m at 0°", "1.3 m at 0°"]
    assert len(said(run, "stop")) == len(said(run, "resume")) == 1


def test_gaps_are_events(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame()
    writer.passes(2_500_000)
    writer.frame()
    writer.command(skipped=7)
    assert (
        said(read_run(writer.file), "gap") == ["7 commands are missing in the recording", "no frame for 2.50 s"][::-1]
    )


def test_counters_and_stages_are_summed_over_starts_of_the_program(tmp_path):
    writer = Writer(tmp_path / "run.log")
    counts = [1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    writer.frame(rejected={"pose_jump": 2}, stages={"looked": [1, 0] + [0] * 9})
    writer.passes()
    writer.frame(rejected={"pose_jump": 5, "frame_stale": 1}, stages={"looked": counts})
    writer.session, writer.counter = 78, 0
    writer.passes()
    writer.frame(rejected={"pose_jump": 3}, stages={"looked": counts})
    robot = read_run(writer.file).robots["robot1"]
    # A counter says how often since the start: of each session the last one counts. 5 + 3; 3 + 3 stages' calls.
    assert robot.counters == {"frame_stale": 1, "pose_jump": 8}
    assert robot.stages["looked"].counts[:2] == [2, 4]
    assert robot.sessions == (77, 78)


def test_several_robots_are_told_apart(tmp_path):
    one, other = Writer(tmp_path / "one.log"), Writer(tmp_path / "other.log", robot="ROBOT2", session=5)
    one.frame(1.0)
    other.frame(2.0)
    both = tmp_path / "both.log"
    both.write_bytes(one.file.read_bytes() + other.file.read_bytes())
    run = read_run(both)
    assert {name: robot.frames["distance_m"].tolist() for name, robot in run.robots.items()} == {
        "robot1": [1.0],
        "robot2": [2.0],
    }
    assert set(read_run(both, "robot2").robots) == {"robot2"}
    with pytest.raises(RecordingError, match="robot 'robot3'"):
        read_run(both, "robot3")


def test_a_folder_with_the_rings_of_two_robots_is_one_run(tmp_path):
    for robot, number in (("robot1", 0), ("robot1", 1), ("robot2", 0)):
        writer = Writer(tmp_path / f"{robot}-{WALL_US}-{number}.lcmlog", robot=robot.upper())
        writer.passes(number * 100_000)
        writer.counter = number
        writer.frame(1.0 + number)
    run = read_run(tmp_path)
    assert run.robots["robot1"].frames["distance_m"].tolist() == [1.0, 2.0]
    assert run.robots["robot2"].frames["distance_m"].tolist() == [1.0]


def test_damage_costs_what_it_hits_and_is_named(tmp_path):
    writer = Writer(tmp_path / "run.log")
    ends = []
    for k in range(30):
        writer.frame(1.0 + k)
        writer.passes()
        ends.append(writer.file.stat().st_size)
    content = bytearray(writer.file.read_bytes())
    content[ends[9] + 40 : ends[10] - 40] = bytes(ends[10] - ends[9] - 80)  # frame 10
    writer.file.write_bytes(bytes(content))
    run = read_run(writer.file)
    assert set(range(30)) - {round(d - 1) for d in run.robots["robot1"].frames["distance_m"]} == {10}
    (damage,) = run.damage
    assert ends[9] <= damage.offset < ends[10] and not damage.at_end
    assert len(said(run, "damage")) == 1


def test_whatever_is_cut_or_flipped_nothing_worse_than_a_recording_error_comes_of_it(recorded, tmp_path):
    (file,) = recorded.box.glob("*.lcmlog")
    content, chance = file.read_bytes()[:300_000], random.Random(3)
    broken = tmp_path / "broken.lcmlog"
    whole = len(read_run(file).robots["robot1"].frames)
    for _ in range(20):
        piece = bytearray(content[: chance.randrange(len(content))])
        for _ in range(chance.randrange(20)):
            if piece:
                piece[chance.randrange(len(piece))] = chance.randrange(256)
        broken.write_bytes(bytes(piece))
        try:
            run = read_run(broken)
        except RecordingError:
            continue
        assert all(len(robot.frames) <= whole for robot in run.robots.values())


@pytest.mark.parametrize("content", [b"", b"what is this", bytes(1000), event(1, "OTHER", b"abc")])
def test_a_file_without_our_messages_is_refused_and_said_what_is_in_it(tmp_path, content):
    (tmp_path / "x.log").write_bytes(content)
    with pytest.raises(RecordingError, match="OTHER" if b"OTHER" in content else "no event of LCM"):
        read_run(tmp_path / "x.log")


def test_a_file_that_is_not_there_and_a_folder_without_a_ring_are_refused(tmp_path):
    with pytest.raises(MissingFileError):
        read_run(tmp_path / "nowhere.log")
    with pytest.raises(MissingFileError):
        read_run(tmp_path)


def test_messages_of_another_version_are_counted(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame()
    writer.raw("ROBOT1_STATUS", bytes(100))  # another fingerprint
    writer.raw("ROBOT1_STATUS", status_t._get_packed_fingerprint() + b"\0\1")  # cut off
    assert read_run(writer.file).unreadable == 2


def test_memory_does_not_grow_with_the_images(tmp_path):
    """60 MB of images and 200 frames: the numbers of those are some 100 kB, an event with an image 300 kB."""
    writer = Writer(tmp_path / "run.log")
    picture = np.zeros((480, 640), np.uint8)
    for _ in range(200):
        writer.image(picture)
        writer.frame()
        writer.passes()
    assert writer.file.stat().st_size > 60e6
    tracemalloc.start()
    run = read_run(writer.file)
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(run.robots["robot1"].frames) == 200
    assert peak_bytes < 5e6


def test_rows_come_while_the_file_is_read(tmp_path):
    """After n frames, all but the last few have come: what streams row by row holds only what is not complete."""
    writer = Writer(tmp_path / "run.log")
    for _ in range(300):
        writer.frame()
        writer.passes()
    seen, read = 0, []
    progress = {}
    for row in rows_in(writer.file, on_progress=lambda done, total: progress.update(done=done, total=total)):
        seen += row.table == "frames"
        read.append(progress["done"])
    assert seen == 300
    assert 0 < read[len(read) // 2] < progress["total"] == progress["done"]


def test_a_command_that_a_black_box_has_twice_is_one_command(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for k in range(3):
        writer.frame()
        sent = sent_t()
        sent.session, sent.counter, sent.status = writer.session, writer.counter + (k == 2), TRACKING
        sent.held.utime = writer.stamp_us
        writer.write("SENT", sent)  # the last one did not get onto the bus
        writer.passes()
    robot = read_run(writer.file).robots["robot1"]
    assert robot.commands["counter"].tolist() == [1, 2, 3, 4]


def test_wheels_poses_and_announcements_have_tables_of_their_own(tmp_path):
    writer = Writer(tmp_path / "run.log")
    base, pose, motion = base_t(), pose_t(), motion_t()
    base.linear_mps, base.measured, base.measured_linear_mps, base.state = 0.3, True, 0.29, base_t.STATE_DRIVING
    base.mac = bytes(32)
    writer.write("BASE", base)
    # A quarter turn to the left about z: the quaternion (cos 45°, 0, 0, sin 45°).
    pose.pos, pose.orientation, pose.utime = [1.0, 2.0, 0.0], [2**-0.5, 0.0, 0.0, 2**-0.5], 7
    writer.write("POSE", pose)
    motion.linear_mps, motion.utime = 0.2, 8
    writer.write("MOTION", motion)
    robot = read_run(writer.file).robots["robot1"]
    assert robot.wheels.words("state").tolist() == ["driving"]
    assert robot.wheels["measured_linear_mps"].tolist() == [0.29]
    assert (robot.poses["x_m"][0], robot.poses["y_m"][0]) == (1.0, 2.0)
    assert robot.poses["heading_rad"][0] == pytest.approx(np.pi / 2)
    assert robot.intents["linear_mps"].tolist() == [0.2]


def test_odometry_and_announcements_that_a_coordinator_was_given_are_in_its_black_box(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for sequence, kind in enumerate((step_t.KIND_OWN_MOTION, step_t.KIND_LEADER_INTENT)):
        step = step_t()
        step.sequence, step.kind, step.utime, step.linear_mps = sequence, kind, 9, 0.1 + sequence
        writer.write("STEP", step)
    robot = read_run(writer.file).robots["robot1"]
    assert robot.odometry["linear_mps"].tolist() == [0.1]
    assert robot.intents["linear_mps"].tolist() == [1.1]


def test_calls_that_are_missing_in_a_black_box_are_a_gap(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for sequence in (4, 5, 9):
        step = step_t()
        step.sequence, step.kind, step.utime = sequence, step_t.KIND_FRAME, writer.stamp_us
        writer.write("STEP", step)
        writer.passes()
    assert said(read_run(writer.file), "gap") == ["3 calls are missing"]


def test_damage_is_found_wherever_the_pieces_end_in_which_a_file_is_searched(tmp_path, monkeypatch):
    writer = Writer(tmp_path / "run.log")
    for _ in range(4):
        writer.frame()
    content = bytearray(writer.file.read_bytes())
    content[0] ^= 1
    content[500:900] = b"\xed\xa1\xda" * 133 + b"\xed"  # sync words that are none
    writer.file.write_bytes(bytes(content))
    whole = [(one.offset, type(one)) for one in events_in(writer.file)]
    assert {kind for _, kind in whole} == {Damage, Event}
    for size in (5, 7, 64):
        monkeypatch.setattr("pilotfish.black_box.log._SCANNED_BYTES", size)
        assert [(one.offset, type(one)) for one in events_in(writer.file)] == whole


def test_a_file_that_a_ring_deletes_while_it_is_read_costs_that_file_only(tmp_path):
    files = []
    for number in range(3):
        writer = Writer(tmp_path / f"robot1-{WALL_US}-{number}.lcmlog")
        writer.passes(number * 100_000)
        writer.counter = number
        writer.frame(1.0 + number)
        files.append(writer.file)
    rows = rows_in(tmp_path)
    next(rows)
    files[1].unlink()
    seen = [row.values["distance_m"] for row in rows if row.table == "frames"]
    assert seen == [1.0, 3.0]


def test_the_black_box_start_and_the_observation_type_are_still_what_the_reader_expects():
    """Fields that the reader takes by name: a renamed one shows here and not as NaN in somebody's evaluation."""
    assert {"program", "command_line", "overrides", "files", "sequence", "session"} <= set(box_start_t.__slots__)
    assert {"detected", "reason", "covariance", "tags", "latency_s"} <= set(observation_t.__slots__)
    assert TRACKING == 1

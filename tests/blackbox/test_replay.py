"""What was recorded is computed again, bit for bit; and a bit that was changed is found."""

import itertools
import math
import random
import shutil

import lcm
import pytest
import yaml
from recorded_runs import CONFIG_PATH, LAWS, PERIOD_US, RecordedRun, drive_at_random, observation_at, wait_until
from typer.testing import CliRunner

from bench.common import wire
from pilotfish import blackbox, bus, coordinator, core
from pilotfish import data as shipped
from pilotfish.black_box import events_in, replay
from pilotfish.black_box.log import files_in
from pilotfish.cli import app
from pilotfish.core import Reason
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.lcmtypes.pilotfish import step_t
from scenes import leader_pictures


def recorded_steps(folder):
    for event in events_in(folder):
        if event.channel.endswith("_STEP"):
            yield event, step_t.decode(event.data)


def rewrite(event, message):
    """The same event with another message of the same size."""
    data = message.encode()
    assert len(data) == len(event.data)
    content = bytearray(event.file.read_bytes())
    at = content.index(event.data, event.offset)
    content[at : at + len(data)] = data
    event.file.write_bytes(content)


@pytest.mark.parametrize(("law", "profile"), LAWS)
def test_a_random_run_is_computed_again_bit_for_bit(tmp_path, law, profile):
    run = RecordedRun(tmp_path, law=law, profile=profile)
    drive_at_random(run, 600, seed=hash_of(law, profile))
    driven = sum(result.command != core.Twist() for result in run.results)
    assert driven > 100, "a run that stands still proves nothing"
    run.close()
    report = replay(events_in(tmp_path))
    assert report.first_difference is None
    assert (report.frames, report.commands, report.gaps, report.skipped) == (600, 600, 0, 0)
    assert report.starts == 1 and report.sent > 200 and report.calls > 800
    assert report.damage == [] and report.unreadable == 0


def test_a_change_of_leader_is_computed_again_from_what_was_recorded_without_pictures(tmp_path):
    # The leader is seen for 1 s, and an alternative for the rest; the leader again from 4 s on, and 0.5 s later it is
    # followed again, although the alternative is in view. What was seen of the one that is not followed is in the
    # recording as one bit: whether it could be followed.
    original = yaml.safe_load(shipped.path("config/line.yaml").read_text())
    folder = shipped.path("config/line.yaml").parent
    config = original | {key: str((folder / original[key]).resolve()) for key in ("fuzzy", "leader")}
    config["camera"]["calibration"] = str((folder / config["camera"]["calibration"]).resolve())
    other = {"leader": str(shipped.path("leaders/three_faces_second.yaml")), "distance_m": 1.0}
    config["alternatives"] = {"after_lost_s": 0.5, "back_after_s": 0.5, "leaders": [other]}
    (tmp_path / "robot1.yaml").write_text(yaml.safe_dump(config))
    run = RecordedRun(tmp_path / "box", config=tmp_path / "robot1.yaml")
    start_us, followed = 1_000_000, []
    for k in range(180):
        utime = start_us + k * PERIOD_US
        leader = observation_at(utime, 1.5) if k < 30 or k >= 120 else None
        alternative = observation_at(utime, 1.3, 0.1) if k >= 20 else None
        run.see_each(utime, [leader, alternative], utime)
        followed.append(run.core.leader_index)
    assert [leader for leader, _ in itertools.groupby(followed)] == [0, 1, 0]
    run.close()
    report = replay(events_in(tmp_path / "box"))
    assert report.first_difference is None
    assert (report.frames, report.skipped) == (180, 0)


def hash_of(*words):
    return sum(ord(letter) * (i + 1) for i, letter in enumerate("".join(words)))


@pytest.mark.parametrize(("law", "profile"), LAWS)
def test_another_coordinator_with_its_memory_goes_on_as_the_first_would(law, profile):
    overrides = coordinator.ConfigOverrides(law=law, profile=profile)
    config = coordinator.load_bundle(coordinator.bundle_config(CONFIG_PATH, overrides)).coordinator
    frames = leader_pictures(40, hidden_from=30)
    first, second = coordinator.Coordinator(config), coordinator.Coordinator(config)
    for k, frame in enumerate(frames):
        now_us = 7_000_000 + k * PERIOD_US
        if k in (1, 5, 17, 31):
            second = coordinator.Coordinator(config)
            second.memory = first.memory
        a, b = first.step(frame, now_us), second.step(frame, now_us)
        assert (a.status, a.reason, a.command) == (b.status, b.reason, b.command)
        if k >= 1:
            assert first.memory == second.memory


def test_bytes_that_are_no_memory_are_refused_and_change_nothing():
    robot = coordinator.Coordinator(coordinator.load_coordinator(CONFIG_PATH).coordinator)
    robot.step_observation(1_000_000, observation_at(1_000_000, 2.0), 5_000_000)
    decisions, vision = before = robot.memory
    for wrong in [(decisions[:-1], vision), (decisions + b"\0", vision), (b"", b""), (decisions, vision[:-8])]:
        with pytest.raises(ValueError, match="no memory"):
            robot.memory = wrong
        assert robot.memory == before


@pytest.mark.parametrize("where", range(4))
def test_one_bit_of_one_command_is_found_with_its_frame(tmp_path, where):
    run = RecordedRun(tmp_path)
    drive_at_random(run, 200, seed=11)
    run.close()
    steps = [(e, m) for e, m in recorded_steps(tmp_path) if m.kind == step_t.KIND_FRAME and m.command_linear_mps != 0]
    event, message = random.Random(where).choice(steps)
    # The last bit of the mantissa: the next number there is.

    message.command_linear_mps = math.nextafter(message.command_linear_mps, 10.0)
    rewrite(event, message)
    report = replay(events_in(tmp_path))
    assert report.differences == 1
    assert (report.first_difference.event.offset, report.first_difference.what) == (event.offset, "the command")
    assert f"call {message.sequence}, frame of {message.utime} us" in report.first_difference.inputs


def test_a_changed_measurement_is_found_by_the_command_it_should_have_led_to(tmp_path):
    run = RecordedRun(tmp_path)
    for k in range(30):
        run.see(1_000_000 + k * PERIOD_US, observation_at(1_000_000 + k * PERIOD_US, 2.0), 9_000_000 + k * PERIOD_US)
    run.close()
    event, message = list(recorded_steps(tmp_path))[20]
    message.measurement[0].distance_m += 0.01
    rewrite(event, message)
    report = replay(events_in(tmp_path))
    assert report.differences >= 1 and report.first_difference.event.offset == event.offset


def test_a_command_sent_that_was_not_held_is_found(tmp_path):
    run = RecordedRun(tmp_path)
    for k in range(100):
        utime, now_us = 1_000_000 + k * PERIOD_US, 9_000_000 + k * PERIOD_US
        run.see(utime, observation_at(utime, 2.0), now_us)
    old = run.core.held
    forged = coordinator.HeldCommand(
        utime=old.utime,
        command=old.command,
        from_us=old.from_us,
        until_us=old.until_us + 1,
        holding=True,
        run=True,
        ever_measured=True,
    )
    status, reason, command = forged.at(now_us, Reason.no_frame)
    run.box.sent(forged, now_us=now_us, missing=Reason.no_frame, status=status, reason=reason, command=command)
    for k in range(100, 110):
        run.see(1_000_000 + k * PERIOD_US, None, 9_000_000 + k * PERIOD_US)
    run.close()
    report = replay(events_in(tmp_path))
    assert (report.differences, report.first_difference.what) == (1, "what the sender held")


def test_any_file_of_the_ring_can_be_replayed_by_itself(tmp_path):
    run = RecordedRun(tmp_path, segment_mb=1, total_mb=100)
    while run.box.files < 4:
        drive_at_random(run, 100, seed=run.box.files)
        run.flush()
    run.close()
    files = files_in(tmp_path)
    assert len(files) >= 4
    for file in files:
        report = replay(events_in(file))
        assert report.first_difference is None and report.starts == 1 and report.skipped == 0
    whole = replay(events_in(tmp_path))
    assert whole.first_difference is None
    assert (whole.starts, whole.memories, whole.frames) == (1, len(files) - 1, len(run.results))


def test_jpegs_as_they_came_are_seen_again_bit_for_bit(tmp_path):
    run = RecordedRun(tmp_path)
    for k, frame in enumerate(leader_pictures(25, hidden_from=20)):
        message = wire.encode_image(frame.image, utime=frame.utime, jpeg=True)
        run.box.message("ROBOT1_IMAGE", message)
        received = image_t.decode(message)
        decoded = blackbox.decode_jpeg(bytes(received.data), width=640, height=480, utime=frame.utime)
        run.look(decoded, 9_000_000 + k * PERIOD_US)
    run.close()
    report = replay(events_in(tmp_path), from_pixels=True)
    assert report.first_difference is None
    assert (report.frames, report.observations, report.observations_unchecked) == (25, 25, 0)
    assert 0 < report.measured <= 20


def test_a_picture_that_was_searched_coarsely_is_searched_coarsely_again(tmp_path):
    run = RecordedRun(tmp_path)
    for k, frame in enumerate(leader_pictures(6)):
        message = wire.encode_image(frame.image, utime=frame.utime, jpeg=True)
        run.box.message("ROBOT1_IMAGE", message)
        received = image_t.decode(message)
        decoded = blackbox.decode_jpeg(bytes(received.data), width=640, height=480, utime=frame.utime)
        decoded.coarse_search = k < 3
        run.look(decoded, 9_000_000 + k * PERIOD_US)
    run.close()
    steps = [step_t.decode(event.data) for event in events_in(tmp_path) if event.channel.endswith("_STEP")]
    assert [bool(step.coarse_search) for step in steps] == [True] * 3 + [False] * 3
    report = replay(events_in(tmp_path), from_pixels=True)
    assert report.first_difference is None and report.observations == 6


def test_copies_for_people_are_not_taken_for_what_was_seen(tmp_path):
    run = RecordedRun(tmp_path, picture_rate_hz=1000.0)
    for k, frame in enumerate(leader_pictures(5)):
        run.box.picture(frame)
        run.look(frame, 9_000_000 + k * PERIOD_US)
    run.close()
    assert sum(event.channel == "ROBOT1_IMAGE" for event in events_in(tmp_path)) >= 1
    report = replay(events_in(tmp_path), from_pixels=True)
    assert report.first_difference is None and report.observations == 0 and report.commands == 5


def test_pixels_that_were_not_recorded_are_not_said_to_agree(tmp_path):
    run = RecordedRun(tmp_path)
    drive_at_random(run, 30, seed=4)
    run.close()
    result = CliRunner().invoke(app, ["replay", str(tmp_path), "--assert"])
    assert result.exit_code == 0, result.output
    result = CliRunner().invoke(app, ["replay", str(tmp_path), "--assert", "--from-pixels"])
    assert result.exit_code == 1
    assert "no picture could be looked at again" in " ".join(result.output.split())


def test_a_frozen_camera_rests_the_law_in_the_replay_too(tmp_path):
    run = RecordedRun(tmp_path)
    frames = leader_pictures(8)
    for k in range(20):
        frame = core.Frame(frames[min(k, 7)].image, utime=1_000_000 + k * PERIOD_US)
        result = run.look(frame, 9_000_000 + k * PERIOD_US)
    assert result.reason == Reason.camera_frozen
    run.close()
    assert replay(events_in(tmp_path)).first_difference is None


def test_a_log_that_ends_in_the_middle_of_an_event_is_replayed_up_to_there(tmp_path):
    run = RecordedRun(tmp_path)
    drive_at_random(run, 100, seed=3)
    run.close()
    (file,) = files_in(tmp_path)
    content = file.read_bytes()
    file.write_bytes(content[:-5])
    report = replay(events_in(tmp_path))
    assert report.first_difference is None and len(report.damage) == 1 and report.damage[0].at_end
    assert report.frames >= 99


def test_behind_a_lost_call_nothing_is_compared_until_the_next_start(tmp_path):
    run = RecordedRun(tmp_path)
    drive_at_random(run, 100, seed=4)
    run.close()
    (file,) = files_in(tmp_path)
    content = bytearray(file.read_bytes())
    victim, _ = list(recorded_steps(tmp_path))[50]
    content[victim.offset] ^= 0xFF
    file.write_bytes(content)
    report = replay(events_in(tmp_path))
    assert report.first_difference is None
    assert (report.gaps, len(report.damage)) == (1, 1) and report.calls == 50 and report.skipped > 0


def test_the_command_line_says_what_was_compared_and_ends_with_one_if_a_bit_differs(tmp_path):
    run = RecordedRun(tmp_path)
    drive_at_random(run, 60, seed=5)
    run.close()
    good = CliRunner().invoke(app, ["replay", str(tmp_path), "--assert"])
    assert good.exit_code == 0 and "every bit agrees" in good.output
    steps = [(e, m) for e, m in recorded_steps(tmp_path) if m.command_angular_radps != 0]
    event, message = steps[0]
    message.command_angular_radps *= 1.5
    rewrite(event, message)
    bad = CliRunner().invoke(app, ["replay", str(tmp_path), "--assert"])
    assert bad.exit_code == 1 and "first difference: the command" in bad.output
    assert CliRunner().invoke(app, ["replay", str(tmp_path)]).exit_code == 0


def test_nothing_to_compare_is_no_agreement(tmp_path):
    log = lcm.EventLog(str(tmp_path / "robot1-1-0.lcmlog"), "w", overwrite=True)
    log.write_event(1, "SOMEBODY_ELSE", b"")
    log.close()
    result = CliRunner().invoke(app, ["replay", str(tmp_path), "--assert"])
    assert result.exit_code == 1 and "nothing to compare" in result.output


def test_what_is_no_recording_is_refused(tmp_path):
    (tmp_path / "robot1-1-0.lcmlog").write_bytes(b"nothing of the kind")
    result = CliRunner().invoke(app, ["replay", str(tmp_path), "--assert"])
    assert result.exit_code == 65 and "no event of LCM in it" in result.output


def test_the_configuration_comes_out_of_the_log_alone(tmp_path):

    elsewhere = tmp_path / "data"
    shutil.copytree(shipped.root(), elsewhere)
    bundle = coordinator.bundle_config(str(elsewhere / "config/line.yaml"))
    before = coordinator.Coordinator(coordinator.load_coordinator(str(elsewhere / "config/line.yaml")).coordinator)
    shutil.rmtree(elsewhere)
    assert {file.role for file in bundle.files} == {"config", "camera.calibration", "leader", "fuzzy"}
    after = coordinator.Coordinator(coordinator.load_bundle(bundle).coordinator)
    for k in range(20):
        utime, now_us = 1_000_000 + k * PERIOD_US, 9_000_000 + k * PERIOD_US
        a, b = (c.step_observation(utime, observation_at(utime, 2.0 - 0.01 * k), now_us) for c in (before, after))
        assert a.command == b.command


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (b"name: coordination", b"n\xffme: coordination", "not a text in UTF-8"),
        (b"error_scale_m:", b"error_scale_n:", "error_scale_n: is not a known key"),
    ],
)
def test_a_recorded_configuration_with_a_changed_bit_is_a_damaged_recording(tmp_path, before, after, said):
    """The same program has accepted it: it is no wrong configuration, and no file of the program's own is to blame."""
    run = RecordedRun(tmp_path)
    drive_at_random(run, 10, seed=2)
    run.close()
    (file,) = files_in(tmp_path)
    content = file.read_bytes()
    assert before in content
    file.write_bytes(content.replace(before, after))
    result = CliRunner().invoke(app, ["replay", str(file), "--assert"])
    output = " ".join(result.output.split())
    assert result.exit_code == 65, output
    assert "the recording is damaged at byte 0" in output and said in output
    assert "/pilotfish-" not in output.replace(str(tmp_path), "")


def test_a_recording_that_lacks_a_file_does_not_look_for_it_here(tmp_path):
    bundle = coordinator.bundle_config(CONFIG_PATH)
    less = coordinator.ConfigBundle([f for f in bundle.files if f.role != "leader"], bundle.overrides)
    with pytest.raises(ValueError, match=r"leader.*lacks"):
        coordinator.load_bundle(less)


def test_events_wait_for_nobody(tmp_path):
    run = RecordedRun(tmp_path)
    drive_at_random(run, 20, seed=9)
    wait_until(lambda: run.box.written >= 21)
    assert (run.box.dropped, run.box.lost, run.box.trouble) == (0, 0, "")


def test_a_log_with_random_damage_is_replayed_without_a_traceback(tmp_path):
    run = RecordedRun(tmp_path / "whole")
    drive_at_random(run, 40, seed=21)
    run.close()
    (file,) = files_in(tmp_path / "whole")
    whole = file.read_bytes()
    chance = random.Random(5)
    damaged = tmp_path / "damaged.lcmlog"
    compared = 0
    for _ in range(60):
        content = bytearray(whole)
        for _ in range(chance.choice([1, 1, 3, 30])):
            # Behind the start, whose configuration would rightly be refused.
            at = chance.randrange(len(content) // 2, len(content))
            content[at] = chance.randrange(256)
        damaged.write_bytes(content[: chance.choice([len(content), chance.randrange(len(content))])])
        compared += replay(events_in(damaged)).frames
    assert compared > 300


def test_what_the_box_writes_is_an_lcm_log(tmp_path):
    run = RecordedRun(tmp_path, picture_rate_hz=1000.0)
    frames = leader_pictures(2)
    run.message("ROBOT1_IMAGE", wire.encode_image(frames[0].image, utime=5, jpeg=True))
    run.box.picture(frames[1])
    run.look(frames[1], 9_000_000)
    run.close()
    (file,) = files_in(tmp_path)
    log = lcm.EventLog(str(file), "r")
    channels = []
    while (event := log.read_next_event()) is not None:
        channels.append(event.channel)
    log.close()
    assert channels == ["ROBOT1_BOX", "ROBOT1_IMAGE", "ROBOT1_IMAGE", "ROBOT1_STEP"]
    pictures = list(bus.LogReader(str(file), channel="ROBOT1_IMAGE"))
    assert [picture.utime for picture in pictures] == [5, frames[1].utime]
    assert abs(pictures[1].image.astype(int) - frames[1].image).mean() < 2.0  # quality 95

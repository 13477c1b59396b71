"""pilotfish-coordinator as its users run it: images over LCM or from a folder, signals, setpoints, bad input."""

import itertools
import json
import math
import re
import shutil
import signal
import subprocess
import time

import lcm
import numpy as np
import pytest
from onboard import LINE_CONFIG, Onboard, same_in_process

from pilotfish import core
from pilotfish import data as shipped
from pilotfish.coordinator import telemetry_fields
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.harness.frame_report import parse_reports
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t
from scenes import leader_pictures, save_pictures


def run(*arguments, timeout_s=60):
    command = [str(find_executable(COORDINATOR)), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout_s)


def test_images_from_a_folder_give_what_the_heart_gives(tmp_path):
    frames = leader_pictures(8)
    save_pictures(frames, tmp_path / "run")
    done = run("--config", LINE_CONFIG, "--source", f"images:{tmp_path / 'run'}", "--lcm-url", "memq://", "--json")
    assert done.returncode == 0, done.stderr
    reports = parse_reports(done.stdout.splitlines())
    expected = same_in_process(frames)
    assert [r.utime for r in reports] == [f.utime for f in frames]
    assert all(r.status == "tracking" for r in reports)
    for report, result in zip(reports, expected, strict=True):
        assert report.distance_m == result.observation.distance_m  # JSON carries doubles exactly
        assert report.linear_mps == result.command.linear_mps
        assert report.angular_radps == result.command.angular_radps


def test_json_lines_hold_the_described_fields_with_finite_numbers_and_null(tmp_path):
    save_pictures(leader_pictures(4, hidden_from=2), tmp_path / "run")
    done = run("--config", LINE_CONFIG, "--source", f"images:{tmp_path / 'run'}", "--lcm-url", "memq://", "--json")

    def refuse(word):
        raise AssertionError(f"{word} in the JSON")

    lines = [json.loads(line, parse_constant=refuse) for line in done.stdout.splitlines()]
    assert [line["detected"] for line in lines] == [True, True, False, False]
    assert lines[3]["distance_m"] is None
    assert all(list(line) == [field.name for field in telemetry_fields()] for line in lines)


def test_images_over_lcm_are_answered_with_the_commands_of_the_heart(tmp_path):
    frames = leader_pictures(6)
    with Onboard(tmp_path) as onboard:
        answers = [onboard.answer_to(frame) for frame in frames]
    for answer, result in zip(answers, same_in_process(frames), strict=True):
        assert answer.status == command_t.STATUS_TRACKING
        assert (answer.linear_mps, answer.angular_radps) == (
            result.command.linear_mps,
            result.command.angular_radps,
        )


@pytest.mark.fault("leader_hidden")
def test_a_leader_that_vanishes_stops_the_robot_within_100_ms_of_image_time(tmp_path):
    frames = leader_pictures(16, hidden_from=10)
    with Onboard(tmp_path) as onboard:
        answers = [onboard.answer_to(frame) for frame in frames]
    last_seen_utime = frames[9].utime
    assert answers[9].linear_mps > 0, "it must be moving, or the test tests nothing"
    for answer in answers[10:]:
        if answer.utime - last_seen_utime <= 100_000:
            assert answer.status == command_t.STATUS_COASTING
            assert answer.linear_mps == answers[9].linear_mps
        else:
            assert answer.status == command_t.STATUS_LOST
            assert (answer.linear_mps, answer.angular_radps) == (0.0, 0.0)
    assert answers[-1].status == command_t.STATUS_LOST


def test_when_images_stop_coming_zeros_go_out_and_keep_going_out(tmp_path):
    with Onboard(tmp_path) as onboard:
        for frame in leader_pictures(6):
            answer = onboard.answer_to(frame)
        assert answer.linear_mps > 0
        first = len(onboard.commands)

        def lost():
            return [c for c in onboard.commands[first:] if c.status == command_t.STATUS_LOST]

        onboard.listen_until(lambda: len(lost()) >= 20, "20 zero commands")
        assert all((c.linear_mps, c.angular_radps) == (0.0, 0.0) for c in lost())
        counters = [c.counter for c in onboard.commands]
        assert counters == sorted(set(counters)), "every command has a number of its own, rising"
        # Not moving on a stale measurement: before the zeros come at most the coasting ones.
        kinds = [c.status for c in onboard.commands[first:]]
        assert set(kinds) <= {command_t.STATUS_TRACKING, command_t.STATUS_COASTING, command_t.STATUS_LOST}
        assert kinds.index(command_t.STATUS_LOST) <= 6


def test_an_image_that_was_already_old_when_it_arrived_moves_nothing(tmp_path):
    """Stamped by this host's wall clock, an image's age is known: taken 1 ms after the first, sent 100 ms later."""
    frames = leader_pictures(2)
    with Onboard(tmp_path, simulated=False) as onboard:
        now_utime = time.time_ns() // 1000
        assert onboard.answer_to(core.Frame(frames[0].image, utime=now_utime)).status == command_t.STATUS_TRACKING
        # The first zero comes a little before the 100 ms are over; three more of 50 ms each are beyond any doubt.
        lost = command_t.STATUS_LOST
        onboard.listen_until(lambda: [c.status for c in onboard.commands[-4:]] == [lost] * 4, "being lost")
        late = onboard.answer_to(core.Frame(frames[1].image, utime=now_utime + 1_000))
    assert late.status == command_t.STATUS_INVALID_INPUT
    assert "too old" in late.text
    assert (late.linear_mps, late.angular_radps) == (0.0, 0.0)


def test_before_any_image_the_robot_is_told_to_stand_still(tmp_path):
    with Onboard(tmp_path) as onboard:
        onboard.listen_until(lambda: len(onboard.commands) >= 10, "10 commands")
        assert all(c.status == command_t.STATUS_SEARCHING for c in onboard.commands)
        assert all((c.linear_mps, c.angular_radps) == (0.0, 0.0) for c in onboard.commands)


@pytest.mark.parametrize("stop", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_with_0_after_zero_commands(tmp_path, stop):
    with Onboard(tmp_path) as onboard:
        for frame in leader_pictures(5):
            answer = onboard.answer_to(frame)
        assert answer.linear_mps > 0
        onboard.child.process.send_signal(stop)
        assert onboard.child.process.wait(10) == 0
        onboard.listen_until(lambda: onboard.commands[-1].status == command_t.STATUS_STOPPED, "the last command")
        assert (onboard.commands[-1].linear_mps, onboard.commands[-1].angular_radps) == (0.0, 0.0)


def test_a_setpoint_over_lcm_stops_the_robot_and_lets_it_go_on(tmp_path):
    frames = iter(leader_pictures(60))
    with Onboard(tmp_path) as onboard:
        assert onboard.answer_to(next(frames)).status == command_t.STATUS_TRACKING

        def answers_until(status):
            return any(onboard.answer_to(next(frames)).status == status for _ in range(25))

        onboard.send_setpoint(1.1, 0.0, False)
        assert answers_until(command_t.STATUS_STOPPED)
        assert onboard.commands[-1].linear_mps == 0.0
        onboard.send_setpoint(math.nan, 0.0, True)  # refused: it stays stopped
        assert onboard.answer_to(next(frames)).status == command_t.STATUS_STOPPED
        onboard.send_setpoint(1.1, 0.0, True)
        assert answers_until(command_t.STATUS_TRACKING)


def test_a_flood_of_setpoints_is_no_flood_of_lines_and_the_lines_count_what_they_leave_out(tmp_path):
    # Every 20 ms another centimetre: a line in half a second, which says how many centimetres it passed over.
    with Onboard(tmp_path) as onboard:
        onboard.listen_until(lambda: onboard.commands, "a command, which names the session")
        lines = []

        def three_lines():
            onboard.send_setpoint(1.0 + 0.01 * next(centimetres), 0.0, True)
            lines[:] = re.findall(r"setpoint: (\d\.\d\d) m at 0\.0 deg, run(?: \((\d+) others not shown\))?\n", log())
            return len(lines) >= 3

        centimetres, log = itertools.count(), onboard.child.stderr
        onboard.listen_until(three_lines, "three lines about setpoints")
    at = [round(100 * float(distance)) for distance, _ in lines]
    assert lines[0][1] == ""
    assert [int(left_out) for _, left_out in lines[1:3]] == [at[1] - at[0] - 1, at[2] - at[1] - 1]


def test_the_status_counts_every_stage_of_every_frame(tmp_path):
    # A frame that comes again is answered with the old answer and is none. What is answered was waited for and looked
    # at before: no frame takes less than its longest part.
    frames, received = leader_pictures(5), []
    with Onboard(tmp_path) as onboard:
        onboard.bus.subscribe("ROBOT1_STATUS", lambda _, data: received.append(status_t.decode(data)))
        for frame in frames:
            onboard.answer_to(frame)
        onboard.listen_until(lambda: received and received[-1].utime >= frames[-1].utime, "the last frame's status")
        first = len(received)
        onboard.listen_until(lambda: len(received) > first, "another status")
    stages = {stage.name: stage for stage in received[-1].stages}
    assert [sum(stages[name].counts) for name in ("waited", "looked", "answered")] == [len(frames)] * 3
    assert stages["answered"].max_ms >= max(stages[name].max_ms for name in ("waited", "looked")) > 0.0


def test_images_that_lie_about_themselves_are_survived(tmp_path):
    good = leader_pictures(3)
    with Onboard(tmp_path) as onboard:
        onboard.answer_to(good[0])
        lie = image_t()
        lie.utime, lie.width, lie.height, lie.row_stride = 1_010_000, 40000, 40000, 40000
        lie.pixelformat, lie.size, lie.data = 1497715271, 10, bytes(10)
        channel = "ROBOT1_IMAGE"
        onboard.bus.publish(channel, lie.encode())
        onboard.bus.publish(channel, lie.encode()[:20])
        onboard.bus.publish(channel, b"")
        small = core.Frame(np.zeros((240, 320), np.uint8), utime=1_020_000)
        refused = onboard.answer_to(small)
        assert refused.status == command_t.STATUS_INVALID_INPUT
        assert "size is not the calibration's" in refused.text
        assert onboard.answer_to(good[1]).status == command_t.STATUS_TRACKING


def test_a_log_of_lcm_logger_is_a_source(tmp_path):
    frames = leader_pictures(5)
    log = lcm.EventLog(str(tmp_path / "run.log"), "w")
    for frame in frames:
        message = image_t()
        message.utime, message.width, message.height, message.row_stride = frame.utime, 640, 480, 640
        message.pixelformat, message.data = 1497715271, frame.image.tobytes()
        message.size = len(message.data)
        log.write_event(frame.utime, "ROBOT1_IMAGE", message.encode())
    log.close()
    done = run("--config", LINE_CONFIG, "--source", f"log:{tmp_path / 'run.log'}", "--lcm-url", "memq://", "--json")
    assert done.returncode == 0, done.stderr
    assert [r.status for r in parse_reports(done.stdout.splitlines())] == ["tracking"] * 5


def test_without_json_it_says_what_it_uses_and_one_line_per_change(tmp_path):
    save_pictures(leader_pictures(12, hidden_from=4), tmp_path / "run")
    done = run("--config", LINE_CONFIG, "--source", f"images:{tmp_path / 'run'}", "--lcm-url", "memq://")
    assert done.returncode == 0
    for used in ("law fuzzy", "profile anticipate", "1.10 m at -10.0 deg", "640 x 480", "tag36h11", "56 rules"):
        assert used in done.stdout, used
    after_ready = done.stdout.split("ready:")[1]
    changes = re.findall(r"info (tracking|coasting|lost|stopped)", after_ready)
    assert changes == ["tracking", "coasting", "lost", "stopped"]


@pytest.mark.parametrize(
    ("pattern", "replacement", "key"),
    [
        ("distance_m: 1.10", "distance_m: -1", "setpoint.distance_m"),
        ("distance_m: 1.10", "distnace_m: 1", "setpoint.distnace_m"),
        ("gain_per_s: 2.0", "gain_per_s: much", "control.heading.gain_per_s"),
        ("profile: anticipate", "profile: clairvoyant", "profile"),
        ("source: lcm", "source: telescope", "source"),
        ("leader: ../leaders/three_faces.yaml", "leader: none.yaml", "none.yaml"),
        ("name: robot1", "nmae: robot1", "name"),
        ("setpoint:\n", "setpoint: 3\nspare:\n", "setpoint"),
    ],
)
def test_a_bad_configuration_ends_with_78_and_the_key(tmp_path, pattern, replacement, key):
    for folder in ("config", "fuzzy", "calibrations", "leaders"):
        shutil.copytree(shipped.path(folder), tmp_path / folder)
    config = tmp_path / "config" / "line.yaml"
    text = config.read_text()
    assert pattern in text, "the test would test nothing"
    config.write_text(text.replace(pattern, replacement, 1))
    # A source that does not exist either: the configuration is looked at before anything is opened.
    options = [] if key == "source" else ["--source", "images:nowhere"]
    done = run("--config", config, "--lcm-url", "memq://", *options)
    assert done.returncode == 78, done.stderr
    assert key in done.stderr
    assert done.stdout == ""


def test_a_rule_that_is_missing_ends_with_78_and_names_the_row(tmp_path):
    for folder in ("config", "fuzzy", "calibrations", "leaders"):
        shutil.copytree(shipped.path(folder), tmp_path / folder)
    rules = tmp_path / "fuzzy" / "coordination.yaml"
    broken, count = re.subn(r"(NM: *\[PB, *PB, *PM, *PM, *PM, *PM), *PM\]", r"\1]", rules.read_text())
    assert count == 1
    rules.write_text(broken)
    done = run("--config", tmp_path / "config" / "line.yaml", "--lcm-url", "memq://")
    assert done.returncode == 78
    assert "NM" in done.stderr


@pytest.mark.parametrize("source", ["images:/nowhere", "video:/nowhere.avi", "camera:99", "log:/nowhere.log"])
def test_a_source_that_cannot_be_opened_ends_with_69(source):
    done = run("--config", LINE_CONFIG, "--source", source, "--lcm-url", "memq://")
    assert done.returncode == 69, done.stderr
    assert source.split(":")[1] in done.stderr


def test_a_bus_that_cannot_be_opened_ends_with_69():
    done = run("--config", LINE_CONFIG, "--lcm-url", "udpm://no-such-host:7667")
    assert done.returncode == 69, done.stderr


@pytest.mark.parametrize("arguments", [[], ["--config"], ["--nonsense"], ["--config", "x", "--source", "tv:1"]])
def test_a_wrong_command_line_ends_with_64(arguments):
    done = run(*arguments)
    assert done.returncode == 64
    assert done.stderr


def test_help_teaches():
    done = run("--help")
    assert done.returncode == 0
    for word in ("--config", "--source", "camera:N", "images:DIR", "--json", "Examples", "78"):
        assert word in done.stdout, word

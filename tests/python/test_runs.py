"""The same scenario, run in this process and over LCM with the real programs."""

import csv
import shutil

import numpy as np
import pytest
from PIL import Image

from pilotfish import data
from pilotfish.errors import ConfigError, HarnessError, MissingFileError
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.over_lcm import run_over_lcm
from pilotfish.harness.replay import replay_camera
from pilotfish.harness.scenario import Scenario
from pilotfish.harness.sequences import look_at_images, render_sequence
from pilotfish.recording import COLUMNS

SECONDS = 1.5
FRAMES = 45


@pytest.fixture(scope="module")
def line() -> Scenario:
    return Scenario.load(data.path("scenarios/line.yaml"))


@pytest.fixture(scope="module")
def in_process(line):
    return run_in_process(line, profile="paper", duration_s=SECONDS)


@pytest.fixture(scope="module")
def over_lcm(line):
    return run_over_lcm(line, profile="paper", duration_s=SECONDS)


def test_a_scenario_knows_its_robots_and_what_they_are_to_keep(line):
    robot = line.robot()
    assert (robot.name, robot.leader) == ("robot1", "leader")
    assert robot.setpoint.distance_m == 1.10
    assert robot.setpoint.bearing_rad == pytest.approx(np.radians(-10.0))
    assert line.robot("robot1") == robot
    with pytest.raises(ConfigError, match="no coordinator drives a robot 'leader'; there are: robot1"):
        line.robot("leader")


def test_frames_are_counted_as_the_simulator_counts_them(line):
    # Exposures at k / 30 s before the end: 1.5 s has k = 0 .. 44; a whole number of periods is not rounded
    # up.
    assert line.frame_count(SECONDS) == FRAMES
    assert line.frame_count(0.1) == 3
    assert line.frame_count(0.101) == 4


def test_a_scenario_that_is_not_there_or_cannot_be_used_is_named(tmp_path):
    with pytest.raises(MissingFileError, match=r"nowhere\.yaml"):
        Scenario.load(tmp_path / "nowhere.yaml")
    broken = tmp_path / "broken.yaml"
    broken.write_text("name: broken\nfoo: 1\nrobots: []\n")
    with pytest.raises(ConfigError, match=r"broken\.yaml"):
        Scenario.load(broken)


def test_a_run_starts_where_the_paper_says_and_sees_every_frame(in_process):
    recording = in_process.recordings["robot1"]
    assert len(recording) == FRAMES
    assert recording.true_distance_m[0] == pytest.approx(2.44, abs=1e-4)
    assert np.degrees(recording.true_bearing_rad[0]) == pytest.approx(-10.0, abs=0.01)
    assert (recording.status == "tracking").all()
    assert recording.meta.transport == "in-process"
    # Measured and true agree: 15 mm at 2.4 m is five times what ViSP's peers reach there in the median.
    assert np.abs(recording.measured_distance_m - recording.true_distance_m).max() < 0.015


def test_the_robot_drives_towards_its_leader(in_process):
    # 1.34 m too far is NB, and all cells of its row say PM (0.6 of 0.6 m/s) or PB (0.917 of it). The limit
    # of 1 m/s^2 and the lag of 0.1 s are overcome long before the end.
    recording = in_process.recordings["robot1"]
    assert recording.linear_mps[0] == 0.0
    assert 0.36 <= recording.linear_mps[-1] <= 0.55
    assert recording.distance_error_m[-1] > recording.distance_error_m[0]


def test_over_lcm_everything_is_the_same_to_the_last_bit(in_process, over_lcm):
    """The bus, the programs and the images' way through them change nothing at all."""
    ours, theirs = in_process.recordings["robot1"], over_lcm.recordings["robot1"]
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), err_msg=name)
    assert [r.utime for r in over_lcm.reports["robot1"]] == [r.utime for r in in_process.reports["robot1"]]
    for mine, other in zip(in_process.reports["robot1"], over_lcm.reports["robot1"], strict=True):
        assert mine.reason == other.reason
        assert mine.output == other.output
        np.testing.assert_array_equal(mine.corners_px, other.corners_px)


def test_a_robot_that_follows_a_follower_has_a_coordinator_of_its_own():
    chain = Scenario.load(data.path("scenarios/chain.yaml"))
    steps = []
    run = run_over_lcm(
        chain, profile="paper", duration_s=0.5, on_progress=lambda done, total: steps.append((done, total))
    )
    assert {robot.name: robot.leader for robot in chain.robots} == {"robot1": "leader", "robot2": "robot1"}
    for name in ("robot1", "robot2"):
        assert len(run.recordings[name]) == len(run.reports[name]) == 15
        assert run.recordings[name].meta.distance_setpoint_m == 1.0
    assert steps[-1] == (15, 15)
    assert [done for done, _ in steps] == sorted(done for done, _ in steps)


def test_a_coordinator_that_does_not_come_up_is_quoted(line):
    with pytest.raises(HarnessError) as caught:
        run_over_lcm(line, profile="paper", duration_s=0.1, coordinator_options=["--black-box", "/proc/nowhere"])
    assert "robot1: ended with 78 before being ready" in str(caught.value)
    assert "black_box.directory" in str(caught.value)


def test_a_tuning_with_an_unknown_key_is_refused_before_anything_starts(line, tmp_path):
    nonsense = tmp_path / "nonsense.yaml"
    nonsense.write_text("pid: {distance_kq: 1.0}\n")
    with pytest.raises(ConfigError, match="distance_kq"):
        run_over_lcm(line, profile="pid", tuning=nonsense, duration_s=0.1)


def test_who_cannot_drive_is_refused_with_those_who_can(line):
    with pytest.raises(ConfigError, match="choose paper, anticipate, pbvs, pid"):
        run_in_process(line, profile="nonsense", duration_s=0.1)


@pytest.mark.parametrize("law", ["anticipate", "pbvs", "pid"])
def test_every_law_drives_alike_over_lcm_and_in_process(line, law):
    inside = run_in_process(line, profile=law, duration_s=SECONDS).recordings["robot1"]
    outside = run_over_lcm(line, profile=law, duration_s=SECONDS).recordings["robot1"]
    assert np.array_equal(inside.command_linear_mps, outside.command_linear_mps)
    assert np.array_equal(inside.command_angular_radps, outside.command_angular_radps)


def test_the_replay_shows_what_the_camera_saw(line, in_process):
    views = list(replay_camera(line, in_process, "robot1", every=20))
    assert [round(view.time_s * 30) for view in views] == [0, 20, 40]
    seen = []
    run_in_process(line, profile="paper", duration_s=SECONDS, on_frame=lambda event: seen.append(event.frame.image))
    for view in views:
        np.testing.assert_array_equal(view.image, seen[round(view.time_s * 30)])
        report = in_process.reports["robot1"][round(view.time_s * 30)]
        assert [tag_id for tag_id, _ in view.tags] == list(report.tag_ids)


def test_a_replay_of_another_run_is_refused(line, in_process):
    other = Scenario.load(data.path("scenarios/circle.yaml"))
    with pytest.raises(HarnessError, match="is not where the recorded one was"):
        list(replay_camera(other, in_process, "robot1"))


@pytest.fixture(scope="module")
def sequence(line, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sequence")
    assert render_sequence(line, folder, frames=6, profile="paper") == 6
    return folder


def test_a_rendered_sequence_is_pictures_and_the_truth(sequence):
    with (sequence / "frames.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [row["file"] for row in rows] == sorted(file.name for file in sequence.glob("*.png"))
    assert len(rows) == 6
    assert np.diff([int(row["utime_us"]) for row in rows]).tolist() == pytest.approx([33333] * 5, abs=1)
    assert float(rows[0]["true_distance_m"]) == pytest.approx(2.44, abs=1e-4)
    with Image.open(sequence / rows[0]["file"]) as picture:
        assert (picture.mode, picture.size) == ("L", (640, 480))


def test_the_program_says_the_same_about_pictures_on_disk(sequence, line, in_process):
    # PNG keeps every pixel and frames.csv every time, so the law too gives the same, number by number.
    reports = look_at_images(sequence, line.robot().coordinator_file, profile="paper")
    assert len(reports) == 6
    for report, direct in zip(reports, in_process.reports["robot1"], strict=False):
        assert report.utime == direct.utime
        assert report.distance_m == direct.distance_m
        assert report.linear_mps == direct.linear_mps


def test_a_picture_that_cannot_be_decoded_is_reported_and_does_not_end_the_run(sequence, line, tmp_path):
    broken = tmp_path / "broken"
    shutil.copytree(sequence, broken)
    (broken / "000002.png").write_bytes(b"not a picture")
    reports = look_at_images(broken, line.robot().coordinator_file)
    assert [report.detected for report in reports] == [True, True, False, True, True, True]


def test_an_empty_folder_is_an_error(tmp_path, line):
    with pytest.raises(HarnessError, match="no pictures"):
        look_at_images(tmp_path, line.robot().coordinator_file)

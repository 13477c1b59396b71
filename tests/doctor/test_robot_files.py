"""What of a new robot's folder is still an example, and whether its camera sees the place where the leader is kept."""

import dataclasses
import math

import pytest

from pilotfish import core, data, robot_folder
from pilotfish.doctor import Verdict
from pilotfish.doctor.following.setup import load_setup
from pilotfish.doctor.robot_files import CALIBRATION, LEADER, VIEW, check_robot_files


@pytest.fixture
def robot(tmp_path):
    robot_folder.create("robot1", tmp_path / "robot1")
    return tmp_path / "robot1"


def found(robot, check, **changed):
    setup = dataclasses.replace(load_setup(robot / "robot1.yaml"), **changed)
    (finding,) = [finding for finding in check_robot_files(setup) if finding.check == check]
    return finding


def test_the_simulated_cameras_calibration_is_wrong_for_a_real_camera_and_a_note_for_a_simulated_one(robot):
    real = found(robot, CALIBRATION)
    assert real.verdict is Verdict.wrong
    assert "calibration.yaml is still the simulated camera's" in real.seen and "calibrate camera" in real.advice
    assert found(robot, CALIBRATION, source="lcm").verdict is Verdict.note


def test_a_calibration_of_ones_own_is_ok(robot):
    (robot / "calibration.yaml").write_text(data.path("calibrations/sim_640x480.yaml").read_text())
    assert found(robot, CALIBRATION).verdict is Verdict.ok


def test_the_examples_leader_is_a_note_until_it_is_replaced(robot):
    assert found(robot, LEADER).verdict is Verdict.note
    (robot / "leader.yaml").write_text(data.path("leaders/three_faces_second.yaml").read_text())
    assert found(robot, LEADER).verdict is Verdict.ok


@pytest.mark.parametrize(
    ("pan_deg", "verdict"), [(0.0, "ok"), (25.0, "ok"), (-25.0, "ok"), (35.0, "wrong"), (90.0, "wrong")]
)
def test_a_camera_that_does_not_see_the_bearing_to_keep_is_wrong(robot, pan_deg, verdict):
    """The picture reaches atan(320 / 600) = 28 degrees to either side of where the camera looks; 0 is to be kept."""
    mounting = core.CameraMounting()
    mounting.pan_rad = math.radians(pan_deg)
    assert found(robot, VIEW, mounting=mounting).verdict.value == verdict


def test_a_tilt_is_no_matter_of_the_bearing(robot):
    mounting = core.CameraMounting()
    mounting.tilt_rad = math.radians(-40.0)
    assert found(robot, VIEW, mounting=mounting).verdict is Verdict.ok

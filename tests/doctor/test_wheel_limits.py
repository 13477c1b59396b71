"""What the coordinator commands has to pass pilotfish-base as it is, above all braking."""

import pytest
import yaml

from pilotfish.doctor import Verdict
from pilotfish.doctor.wheel_limits import check_wheel_limits
from pilotfish.robot_folder import create


@pytest.fixture
def robot(tmp_path):
    create("robot1", tmp_path / "robot1")
    return tmp_path / "robot1"


def set_limit(robot, key, value):
    content = yaml.safe_load((robot / "base.yaml").read_text())
    content["limits"][key] = value
    (robot / "base.yaml").write_text(yaml.safe_dump(content))


def test_a_new_robots_wheels_let_everything_through(robot):
    assert check_wheel_limits(robot / "robot1.yaml").verdict is Verdict.ok


def test_wheels_that_brake_less_than_the_guard_counts_on_are_wrong(robot):
    set_limit(robot, "brake_mps2", 0.5)  # control.limits.max_linear_acceleration_mps2 is 1
    found = check_wheel_limits(robot / "robot1.yaml")
    assert found.verdict is Verdict.wrong
    assert "limits.brake_mps2 0.5 < control.limits.max_linear_acceleration_mps2 1" in found.seen
    assert "collision guard" in found.advice


@pytest.mark.parametrize(
    ("key", "value"), [("max_linear_mps", 0.3), ("max_linear_acceleration_mps2", 0.4), ("max_angular_radps", 1.0)]
)
def test_wheels_that_are_slower_than_what_is_commanded_are_named(robot, key, value):
    set_limit(robot, key, value)
    found = check_wheel_limits(robot / "robot1.yaml")
    assert found.verdict is Verdict.wrong and f"limits.{key} {value:g}" in found.seen
    assert "collision guard" not in found.advice


def test_without_a_base_file_or_with_another_robots_nothing_is_said_to_be_wrong(robot):
    content = yaml.safe_load((robot / "base.yaml").read_text())
    (robot / "base.yaml").write_text(yaml.safe_dump(content | {"name": "other"}))
    assert check_wheel_limits(robot / "robot1.yaml").verdict is Verdict.note
    (robot / "base.yaml").unlink()
    assert check_wheel_limits(robot / "robot1.yaml").verdict is Verdict.note

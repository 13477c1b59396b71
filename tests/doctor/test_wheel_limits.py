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


def test_a_base_file_of_another_robot_is_wrong_and_says_of_which(robot):
    content = yaml.safe_load((robot / "base.yaml").read_text())
    (robot / "base.yaml").write_text(yaml.safe_dump(content | {"name": "robot2"}))
    found = check_wheel_limits(robot / "robot1.yaml")
    assert found.verdict is Verdict.wrong
    assert "base.yaml is of robot2, robot1.yaml of robot1" in found.seen
    assert "name: robot1" in found.advice


def test_a_base_file_that_is_not_there_is_wrong_and_says_how_to_get_one(robot):
    (robot / "base.yaml").unlink()
    found = check_wheel_limits(robot / "robot1.yaml")
    assert found.verdict is Verdict.wrong
    assert "no base.yaml beside robot1.yaml" in found.seen and "pilotfish init robot1" in found.advice


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda text: "", "base.yaml is not a YAML mapping"),
        (lambda text: text.replace("wheel_radius_m: 0.05", "wheel_radius_m: .nan"), "wheels.wheel_radius_m: nan"),
        (lambda text: text.replace("wheel_radius_m:", "wheelradius_m:"), "wheels.wheelradius_m: is not a known key"),
        (lambda text: text + "\n\t{", "base.yaml"),
    ],
    ids=["empty", "nan", "misspelt", "no YAML"],
)
def test_a_base_file_that_cannot_be_used_is_wrong_with_its_key(robot, damage, said):
    (robot / "base.yaml").write_text(damage((robot / "base.yaml").read_text()))
    found = check_wheel_limits(robot / "robot1.yaml")
    assert found.verdict is Verdict.wrong
    assert said in found.seen and "Error" not in found.seen
    assert found.seen.count("base.yaml") <= 2 and "--describe-config" in found.advice


def test_the_file_of_the_robot_itself_is_found_among_those_of_several(robot):
    """The Debian package has /etc/pilotfish/NAME.yaml and NAME-base.yaml, of several robots."""
    (robot / "base.yaml").rename(robot / "robot1-base.yaml")
    (robot / "robot2-base.yaml").write_text((robot / "robot1-base.yaml").read_text().replace("robot1", "robot2"))
    found = check_wheel_limits(robot / "robot1.yaml")
    assert found.verdict is Verdict.ok and found.seen.startswith("robot1-base.yaml")

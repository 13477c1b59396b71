"""Scenario files: the shipped ones load, and whatever is wrong in one is refused by the name of its key."""

import pytest
import yaml

from pilotfish import coordinator, sim
from pilotfish import data as shipped

FILES = sorted(shipped.path("scenarios").glob("*.yaml"))


@pytest.mark.parametrize("file", FILES, ids=[file.stem for file in FILES])
def test_a_shipped_scenario_loads_and_can_be_played(file):
    scenario = sim.load_scenario(file)
    assert scenario.name == file.stem
    assert scenario.description
    assert scenario.frame_count == round(scenario.duration_s * scenario.frame_rate_hz)
    world = sim.World(scenario)
    followers = [robot for robot in scenario.robots if robot.follows]
    assert followers
    for robot in followers:
        assert robot.coordinator_file.is_file()
        assert robot.setpoint is not None
        assert world.capture(robot.name) is not None


@pytest.fixture
def edited(tmp_path):
    """load(change): the line scenario after `change(mapping)`, from a folder of its own."""

    def load(change):
        content = yaml.safe_load(shipped.path("scenarios/line.yaml").read_text())
        for robot in content["robots"]:
            for section, key in (("body", "leader"), ("camera", "calibration"), (None, "coordinator")):
                place = robot.get(section, {}) if section else robot
                if key in place:
                    place[key] = str((shipped.path("scenarios") / place[key]).resolve())
        change(content)
        file = tmp_path / "scenario.yaml"
        file.write_text(yaml.safe_dump(content))
        return sim.load_scenario(file)

    return load


def leader(content):
    return content["robots"][0]


def robot1(content):
    return content["robots"][1]


def test_an_unchanged_copy_loads(edited):
    assert edited(lambda content: None).name == "line"


UNKNOWN = {
    "colour": lambda c: c.update(colour="red"),
    r"robots\[0\].colour": lambda c: leader(c).update(colour="red"),
    r"robots\[1\].start.z_m": lambda c: robot1(c)["start"].update(z_m=1.0),
    r"robots\[0\].trajectory.radius_m": lambda c: leader(c)["trajectory"].update(radius_m=1.0),
    r"robots\[1\].drive.max_speed": lambda c: robot1(c)["drive"].update(max_speed=1.0),
    r"robots\[0\].body.visible": lambda c: leader(c)["body"].update(visible=False),
    r"robots\[1\].camera.gain": lambda c: robot1(c)["camera"].update(gain=1.0),
    r"robots\[1\].camera.mounting.yaw_deg": lambda c: robot1(c)["camera"]["mounting"].update(yaw_deg=1.0),
    r"robots\[1\].setpoint.angle_deg": lambda c: robot1(c)["setpoint"].update(angle_deg=1.0),
}


@pytest.mark.parametrize("key", UNKNOWN)
def test_an_unknown_key_is_refused_by_name_wherever_it_stands(edited, key):
    with pytest.raises(ValueError, match=f"^{key}: is not a known key"):
        edited(UNKNOWN[key])


WRONG = {
    "name: is missing": lambda c: c.pop("name"),
    "name: 'a line' is not a name": lambda c: c.update(name="a line"),
    "duration_s: 0 is outside": lambda c: c.update(duration_s=0),
    "seed: 'one' is not a whole number": lambda c: c.update(seed="one"),
    "robots: is missing": lambda c: c.pop("robots"),
    "robots: a world needs at least one robot": lambda c: c.update(robots=[]),
    r"robots\[1\].name: 'Leader' is used twice": lambda c: robot1(c).update(name="Leader"),
    r"robots\[1\].follows: there is no robot 'nobody'": lambda c: robot1(c).update(follows="nobody"),
    r"robots\[1\].follows: a robot cannot follow itself": lambda c: robot1(c).update(follows="robot1"),
    r"robots\[1\].follows: 'leader' wears no tags": lambda c: leader(c)["body"].pop("leader"),
    r"robots\[1\].trajectory: a robot that follows": lambda c: robot1(c).update(trajectory={"kind": "still"}),
    r"robots\[1\].camera: a robot that follows another needs one": lambda c: robot1(c).pop("camera"),
    r"robots\[0\].trajectory.kind: 'spiral'": lambda c: leader(c)["trajectory"].update(kind="spiral"),
    r"robots\[0\].trajectory.speed_mps: 99 is outside": lambda c: leader(c)["trajectory"].update(speed_mps=99),
    r"robots\[0\].trajectory.points: needs at least": lambda c: leader(c).update(
        trajectory={"kind": "waypoints", "points": []}
    ),
    r"robots\[0\].trajectory.points\[0\].y_m: is missing": lambda c: leader(c).update(
        trajectory={"kind": "waypoints", "points": [{"x_m": 1.0}]}
    ),
    r"robots\[1\].camera.drop_probability: 1.5 is outside": lambda c: robot1(c)["camera"].update(drop_probability=1.5),
    r"robots\[1\].camera.noise_sigma: nan is outside": lambda c: robot1(c)["camera"].update(noise_sigma=float("nan")),
    r"robots\[0\].body.hidden_until_s: is before": lambda c: leader(c)["body"].update(
        hidden_from_s=5.0, hidden_until_s=4.0
    ),
}


@pytest.mark.parametrize("problem", WRONG)
def test_what_is_wrong_is_refused_by_name(edited, problem):
    with pytest.raises(ValueError, match=f"^{problem}"):
        edited(WRONG[problem])


def test_a_calibration_that_is_not_there_is_refused(edited):
    with pytest.raises(ValueError, match="calibration: cannot read"):
        edited(lambda c: robot1(c)["camera"].update(calibration="nowhere.yaml"))


def test_angles_may_be_given_in_degrees_or_radians(edited):
    def in_radians(content):
        robot1(content)["setpoint"] = {"distance_m": 1.1, "bearing_rad": -0.17453292519943295}

    assert edited(in_radians).robot("robot1").setpoint.bearing_rad == pytest.approx(
        edited(lambda content: None).robot("robot1").setpoint.bearing_rad
    )


def test_the_files_that_are_not_scenarios_but_belong_to_one_load_too():
    for file in sorted(shipped.path("calibrations").iterdir()):
        camera = coordinator.load_calibration(file)
        assert (camera.width, camera.height, camera.fx) == (640, 480, 600.0)


def written(folder, name, text):
    (folder / f"{name}.yaml").write_text(text)
    return folder / f"{name}.yaml"


def test_a_scenario_like_another_says_what_differs(tmp_path):
    line = shipped.path("scenarios/line.yaml")
    scenario = sim.load_scenario(written(tmp_path, "long", f"name: long\nlike: {line}\nduration_s: 60\n"))
    assert (scenario.name, scenario.duration_s, len(scenario.robots)) == ("long", 60.0, 2)
    assert scenario.robot("robot1").follows == "leader"


def test_hardware_counts_in_place_of_what_the_scenario_says_of_the_robot_that_follows(tmp_path):
    line = shipped.path("scenarios/line.yaml")
    written(tmp_path, "worn", "drive: {actuator_lag_s: 0.3, slip: 0.1}\ncamera: {pan_error_deg: 1.0, gamma: 2.2}\n")
    leader, robot = sim.load_scenario(
        written(tmp_path, "old", f"name: old\nlike: {line}\nhardware: worn.yaml\n")
    ).robots
    assert (robot.drive.actuator_lag_s, robot.drive.slip, robot.drive.max_linear_mps) == (0.3, 0.1, 0.6)
    assert robot.camera.pan_error_rad == pytest.approx(0.0174533, abs=1e-6)
    assert (robot.camera.imperfections.gamma, robot.camera.imperfections.blur_sigma_px) == (2.2, 0.7)
    assert (leader.drive.actuator_lag_s, leader.drive.slip) == (0.1, 0.0)


def test_a_wrong_key_of_the_hardware_is_named_with_its_file(tmp_path):
    line = shipped.path("scenarios/line.yaml")
    written(tmp_path, "worn", "drive: {slipp: 0.1}\n")
    with pytest.raises(ValueError, match=r"drive\.slipp") as refused:
        sim.load_scenario(written(tmp_path, "old", f"name: old\nlike: {line}\nhardware: worn.yaml\n"))
    assert "slip_sigma" in str(refused.value)  # what there is


def test_a_wrong_key_of_the_hardware_is_found_though_nobody_follows(tmp_path):
    written(tmp_path, "worn", "camera: {gama: 2.2}\n")
    with pytest.raises(ValueError, match=r"camera\.gama"):
        sim.load_scenario(written(tmp_path, "alone", "name: alone\nhardware: worn.yaml\nrobots:\n  - name: leader\n"))


def test_a_scenario_like_itself_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"like: is one too many: .* 4 times in all"):
        sim.load_scenario(written(tmp_path, "ouroboros", "name: ouroboros\nlike: ouroboros.yaml\n"))

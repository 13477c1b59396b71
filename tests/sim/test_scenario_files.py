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

"""A formation as scenario, configurations and tags."""

import shutil

import pytest
import yaml
from formation_files import formation

from pilotfish import coordinator, data, sim
from pilotfish.errors import ConfigError
from pilotfish.formation import formations, load_formation
from pilotfish.formation.expand import expand, load_expanded, scenario_of, tag_offsets
from pilotfish.harness.scenario import Scenario


@pytest.mark.parametrize("name", sorted(formations()))
def test_every_robot_starts_where_its_setpoint_is_already_kept(name, tmp_path):
    """The simulator's own relative pose is the oracle of the geometry."""
    shape = load_formation(formations()[name])
    scenario = load_expanded(shape, tmp_path)
    world = sim.World(sim.load_scenario(scenario.file))
    assert {robot.name: robot.leader for robot in scenario.robots} == shape.leaders
    for robot in scenario.robots:
        distance_m, bearing_rad, heading_rad = world.true_relative_pose(robot.name)
        assert distance_m == pytest.approx(robot.setpoint.distance_m, abs=1e-9)
        assert bearing_rad == pytest.approx(robot.setpoint.bearing_rad, abs=1e-9)
        assert heading_rad == 0.0


def test_every_robot_wears_ids_of_its_own_and_looks_for_those_of_its_leader(tmp_path):
    shape = formation("wedge", robots=5, angle_deg=18.0)
    scenario = load_expanded(shape, tmp_path)
    worn = {spec.name: {tag.id for tag in spec.body.leader.tags} for spec in sim.load_scenario(scenario.file).robots}
    assert sum(map(len, worn.values())) == len(set().union(*worn.values())) == 15
    for robot in scenario.robots:
        sought = coordinator.load_coordinator(robot.coordinator_file).coordinator.leader
        assert {tag.id for tag in sought.tags} == worn[robot.leader]


def test_scenario_and_folder_can_be_moved_together(tmp_path):
    first, then = tmp_path / "first", tmp_path / "then"
    expand(formation("chain"), first / "mine.yaml")
    shutil.move(first, then)
    assert [robot.name for robot in Scenario.load(then / "mine.yaml").robots] == ["robot1", "robot2"]
    for file in then.rglob("*.yaml"):
        assert str(tmp_path) not in file.read_text() and str(data.root()) not in file.read_text(), file


def test_what_the_coordinators_file_says_holds_for_every_robot(tmp_path):
    config = yaml.safe_load(data.path("config/coordinator.yaml").read_text())
    for section, key in (("camera", "calibration"), (None, "leader"), (None, "fuzzy")):
        place = config[section] if section else config
        place[key] = str((data.path("config") / place[key]).resolve())
    config["control"]["heading"]["gain_per_s"] = 1.25
    own = tmp_path / "own.yaml"
    own.write_text(yaml.safe_dump(config))
    scenario = load_expanded(formation("chain", coordinator=str(own)), tmp_path)
    gains = {
        coordinator.load_coordinator(r.coordinator_file).coordinator.control.heading.gain_per_s for r in scenario.robots
    }
    assert gains == {1.25}


def test_a_headway_becomes_a_key_of_every_robots_control_section(tmp_path):
    expand(formation("chain", headway_s=0.5), tmp_path / "mine.yaml")
    for robot in ("robot1", "robot2"):
        config = yaml.safe_load((tmp_path / "mine_files" / f"{robot}.yaml").read_text())
        assert config["control"]["spacing"] == {"headway_s": 0.5}
        assert "velocity" in config["control"], "what stood there stays"


def test_more_robots_than_a_family_has_ids_for_are_refused(tmp_path):
    """tag25h9 has 35 ids. The highest one worn is 2, so each robot needs a step of 10: 0-2, 10-12, 20-22, 30-32."""
    body = yaml.safe_load(data.path("leaders/three_faces.yaml").read_text()) | {"family": "tag25h9"}
    (tmp_path / "body.yaml").write_text(yaml.safe_dump(body))
    text = (
        data.path("config/coordinator.yaml")
        .read_text()
        .replace("../leaders/three_faces.yaml", str(tmp_path / "body.yaml"))
    )
    own = tmp_path / "own.yaml"
    own.write_text(text.replace("../", f"{data.root()}/"))
    assert list(tag_offsets(formation("chain", robots=4, coordinator=str(own))).values()) == [0, 10, 20, 30]
    with pytest.raises(ConfigError, match="35 ids of tag25h9; allowed: 2 to 4"):
        tag_offsets(formation("chain", robots=5, coordinator=str(own)))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"trajectory": {"kind": "lin"}}, r"robots\[0\].trajectory.kind: 'lin' is not one of"),
        ({"drive": {"max_linear": 1.0}}, r"robots\[1\].drive.max_linear: is not a known key"),
        ({"camera": {"drop_probability": 2.0}}, "drop_probability"),
    ],
)
def test_what_only_a_scenario_can_judge_is_refused_with_its_key_and_without_a_temporary_path(content, words, tmp_path):
    with pytest.raises(ConfigError, match=words) as refused:
        load_expanded(formation("chain", **content), tmp_path)
    assert str(refused.value).startswith("my_formation.yaml: as a scenario: ")
    assert str(tmp_path) not in str(refused.value)


def test_a_formation_file_stands_for_its_scenario_and_any_other_name_for_itself(tmp_path):
    with scenario_of(str(formations()["tree"])) as name:
        assert len(Scenario.load(name).robots) == 4
    with scenario_of("line") as name:
        assert name == "line"
    with (
        pytest.raises(ConfigError, match=r"changes: .*pilotfish formation run"),
        scenario_of(str(formations()["wedge"])),
    ):
        pass

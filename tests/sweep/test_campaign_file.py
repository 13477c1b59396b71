"""A campaign's file: what is wrong in it is named, with what is allowed; what it means is what the programs read."""

import math
import re
from pathlib import Path

import pytest

from pilotfish import data, sim
from pilotfish.coordinator import load_coordinator
from pilotfish.errors import ConfigError
from pilotfish.harness.scenario import Scenario
from pilotfish.sweep.campaign import NUMBERS, TEXTS, load_campaign
from pilotfish.sweep.describe import describe
from pilotfish.sweep.documents import to_yaml
from pilotfish.sweep.metrics import METRICS, OUTCOMES
from pilotfish.sweep.play import prepared
from sweep.campaigns import SPEED, loaded, written

LAG = "robots.robot1.drive.actuator_lag_s"
ONE = {"law": ["paper"]}

WRONG = {
    "unknown key": ({"factor": {}}, r"no key 'factor' \(did you mean factors\?\)"),
    "no scenario": ({"scenario": None}, "scenario: is missing"),
    "scenario's name": ({"scenario": "lin"}, r"scenario: no shipped scenario 'lin' \(did you mean line\?\)"),
    "no factors": ({"factors": {}}, "nothing is varied"),
    "runs": ({"runs": 0}, "runs: 0 is not a whole number from 1 to 100000"),
    "runs, half": ({"runs": 1.5}, "runs: 1.5 is not a whole number"),
    "duration": ({"duration_s": math.nan}, r"duration_s: nan is not a number from 0.5 to 100000"),
    "observations": ({"observations": "rendred"}, r"'rendred' is not one of drawn, rendered \(did you mean rendered"),
    "robot": ({"robot": "leader"}, "robot: .*no coordinator drives a robot 'leader'; there are: robot1"),
    "metric": ({"metrics": ["rms_distance"]}, r"metrics: there is no 'rms_distance' \(did you mean rms_distance_mm"),
    "law": ({"factors": {"law": ["fuzzy"]}}, r"factors.law: fuzzy: 'fuzzy' does not drive; choose paper, anticipate"),
    "value out of range": ({"factors": {LAG: [-0.1]}}, rf"{LAG}: -0.1: .*actuator_lag_s: -0.1 is outside \[0, 5\]"),
    "end of a range": ({"factors": {LAG: {"uniform": [0.1, 1e6]}}, "sampling": {"points": 4}}, f"{LAG}: 1000000.0: "),
    "key of a robot": ({"factors": {"robots.robot1.drive.lag_s": [0.1]}}, "lag_s.*there are|lag_s.*known"),
    "robot's name": ({"factors": {"robots.robt1.drive.slip": [0.1]}}, r"no robot 'robt1' \(did you mean robot1\?\)"),
    "first word": ({"factors": {"robot.robot1.x": [1]}}, r"a key begins with law, scenario.*did you mean robots"),
    "config of a leader": ({"factors": {"robots.leader.config.profile": [1]}}, "no coordinator drives 'leader'"),
    "the config's setpoint": (
        {"factors": {"config.setpoint.distance_m": [1.0]}},
        "no effect: the scenario has its own",
    ),
    "pictures' keys": ({"factors": {"robots.robot1.camera.noise_sigma": [1.0]}}, "no effect on drawn measurements"),
    "no program": ({"set": {"config.odometry": "pose"}}, "set.config.odometry: no effect"),
    "measurements": ({"set": {"measurements.scal": 2.0}}, r"no key 'scal' \(did you mean scale\?\)"),
    "measurement's range": ({"set": {"measurements.scale": -1.0}}, r"measurements.scale: -1.0 is not a number from 0"),
    "file": ({"set": {"scenario.hardware": "none.yaml"}}, "set.scenario.hardware: .*none.yaml"),
    "empty list": ({"factors": {SPEED: []}}, "an empty list"),
    "one value": ({"factors": {SPEED: 0.1}}, "a single value belongs below `set:`"),
    "twice": ({"factors": {SPEED: [0.1, 0.1]}}, "0.1 stands there twice"),
    "texts": ({"factors": {SPEED: ["1e-1"]}}, "'1e-1' is a text to YAML"),
    "steps": ({"factors": {SPEED: {"from": 0.1, "to": 0.2}}}, "steps: None is not a whole number from 2"),
    "uniform": ({"factors": {SPEED: {"uniform": [0.2, 0.1]}}}, "the lower end comes first"),
    "kind": ({"factors": {SPEED: {"unifrm": [0.1, 0.2]}}}, r"'unifrm' says no values \(did you mean uniform\?\)"),
    "no points": ({"factors": {SPEED: {"uniform": [0.1, 0.2]}}}, "sampling.points: is missing"),
    "points for nothing": ({"sampling": {"points": 4}}, "no factor is distributed"),
    "no power": (
        {"factors": {SPEED: {"uniform": [0.1, 0.2]}}, "sampling": {"method": "sobol", "points": 100}},
        "100 is not a power of 2.*64, 128",
    ),
    "varied twice": ({"factors": {**ONE, "who": {"levels": {"a": {"law": "pid"}}}}}, "law is varied by factors.law as"),
    "a column's name": ({"factors": {"reason": {"levels": {"a": {}}}}}, "reason: this is a column of the results"),
    "too many": ({"runs": 100_000, "factors": {LAG: {"from": 0.1, "to": 0.2, "steps": 1000}}}, "at most 10000000"),
}


@pytest.mark.parametrize(("changes", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_named_with_what_is_allowed(tmp_path, changes, said):
    file = written(tmp_path, **changes)
    with pytest.raises(ConfigError) as error:
        load_campaign(file)
    assert re.search(said, str(error.value).replace("\n", " "))
    assert str(error.value).startswith(f"{file}: ")
    assert "/pilotfish-sweep-" not in str(error.value), "the name of a folder that is gone"


@pytest.mark.parametrize("name", data.scenarios())
def test_a_scenario_s_documents_are_read_as_the_scenario_itself(tmp_path, name):
    """`like`, hardware files, calibrations, leaders and fuzzy sets: all that the programs read is the same."""
    campaign = loaded(tmp_path, scenario=name, duration_s=None, factors={"law": ["anticipate"]})
    campaign.documents.write_files(tmp_path)
    scenario, world, _ = prepared(campaign.job, {}, tmp_path)
    shipped, own = Scenario.load(data.scenario(name)), sim.load_scenario(data.scenario(name))
    assert (world.duration_s, world.frame_rate_hz, world.seed) == (own.duration_s, own.frame_rate_hz, own.seed)
    for copied, robot in zip(world.robots, own.robots, strict=True):
        for part in ("name", "follows", "drive", "camera", "body", "visibility", "start", "setpoint"):
            assert getattr(copied, part) == getattr(robot, part), part
        if robot.trajectory:
            at = [repr(sim.state_at(each.trajectory, each.start, 7.3)) for each in (copied, robot)]
            assert at[0] == at[1]
    for copied, robot in zip(scenario.robots, shipped.robots, strict=True):
        ours, theirs = (load_coordinator(each.coordinator_file).coordinator for each in (copied, robot))
        assert ours == theirs


def test_degrees_and_radians_replace_each_other(tmp_path):
    """nonideal.yaml has pan_error_deg: 0.5; a campaign that says it in radians replaces it, and is not refused."""
    key = "robots.robot1.camera.pan_error_rad"
    campaign = loaded(tmp_path, scenario="line_nonideal", observations="rendered", factors={key: [0.01]})
    campaign.documents.write_files(tmp_path)
    _, world, _ = prepared(campaign.job, campaign.run(0).settings, tmp_path)
    assert world.robot("robot1").camera.pan_error_rad == 0.01


def test_hardware_counts_before_single_keys_whatever_their_order(tmp_path):
    levels = {"bad": {"scenario.hardware": "hardware/nonideal.yaml"}}
    changes = {"set": {LAG: 0.2}, "factors": {"robot": {"levels": levels}}}
    campaign = loaded(tmp_path, **changes)
    campaign.documents.write_files(tmp_path)
    _, world, _ = prepared(campaign.job, campaign.run(0).settings, tmp_path)
    drive = world.robot("robot1").drive
    assert (drive.actuator_lag_s, drive.slip) == (0.2, 0.02)  # nonideal.yaml: 0.12 and 0.02


def test_files_beside_the_campaign_go_with_it_as_contents(tmp_path):
    own = tmp_path / "mine.yaml"
    own.write_text("drive: {slip: 0.03}\n")
    campaign = loaded(tmp_path, set={"scenario.hardware": "mine.yaml"})
    own.unlink()
    (tmp_path / "elsewhere").mkdir()
    campaign.documents.write_files(tmp_path / "elsewhere")
    _, world, _ = prepared(campaign.job, campaign.run(0).settings, tmp_path / "elsewhere")
    assert world.robot("robot1").drive.slip == 0.03


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ({"a": "1.10", "b": "010", "c": "yes: no"}, '{"a": 1.10, "b": 010, "c": "yes: no"}'),
        ([0.1, True, "true", 1e-05, math.inf], "[0.1, true, true, 1e-05, .inf]"),
        ("-", '"-"'),
        ("", '""'),
    ],
)
def test_scalars_keep_their_text_and_only_what_is_a_number_stands_without_quotes(value, text):
    assert to_yaml(value) == text


def test_the_description_names_every_key_figure_and_outcome():
    said = describe()
    for name in (*TEXTS, *NUMBERS, *METRICS, *OUTCOMES):
        assert f"| `{name}` |" in said


@pytest.mark.parametrize("file", sorted(data.path("sweeps").glob("*.yaml")), ids=lambda file: Path(file).stem)
def test_a_shipped_campaign_can_be_simulated(file):
    campaign = load_campaign(file)
    assert campaign.count > 100

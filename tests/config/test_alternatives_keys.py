"""Other leaders in a coordinator's file: read, refused by the key at fault, recorded with everything else."""

import subprocess

import pytest
import yaml

from bench.common.configuration import shipped_coordinator
from pilotfish import data
from pilotfish.coordinator import Coordinator, bundle_config, load_bundle, load_coordinator
from pilotfish.harness.executables import COORDINATOR, find_executable

SECOND, THIRD = (str(data.path(f"leaders/three_faces_{name}.yaml")) for name in ("second", "third"))


def written(folder, alternatives):
    file = folder / "robot.yaml"
    file.write_text(yaml.safe_dump({**shipped_coordinator(), "alternatives": alternatives}))
    return file


def one(**entry):
    return {"leaders": [{"leader": SECOND, **entry}]}


def test_a_list_is_read_in_its_order_with_angles_in_degrees(tmp_path):
    leaders = [{"leader": THIRD, "distance_m": 1.5, "bearing_deg": 90.0 / 4}, {"leader": SECOND, "distance_m": 0.9}]
    file = written(tmp_path, {"after_lost_s": 2.0, "back_after_s": 3.0, "leaders": leaders})
    config = load_coordinator(file).coordinator
    assert (config.alternatives.after_lost_s, config.alternatives.back_after_s) == (2.0, 3.0)
    assert [other.leader.name for other in config.other_leaders] == ["three_faces_third", "three_faces_second"]
    assert [other.distance_m for other in config.other_leaders] == [1.5, 0.9]
    assert [other.bearing_rad for other in config.other_leaders] == pytest.approx([0.39269908, 0.0])


def test_a_recording_holds_the_other_leaders_files(tmp_path):
    file = written(tmp_path, {"leaders": [{"leader": SECOND, "distance_m": 1.5}, {"leader": THIRD, "distance_m": 1.6}]})
    bundle = bundle_config(file)
    roles = [text.role for text in bundle.files]
    assert [role for role in roles if "alternatives" in role] == [f"alternatives.leaders[{k}].leader" for k in (0, 1)]
    assert load_bundle(bundle).coordinator == load_coordinator(file).coordinator


@pytest.mark.parametrize(
    ("alternatives", "said"),
    [
        ({"leaders": [{"leader": SECOND}]}, "alternatives.leaders[0].distance_m: is missing"),
        ({"leaders": [{"distance_m": 1.0}]}, "alternatives.leaders[0].leader: is missing"),
        (one(distance_m=25.0), "leaders[0].distance_m: 25 is outside [0.05, 20]"),
        (one(distance_m=0.3), "leaders[0].distance_m: 0.3 is below safety.stop_distance_m (0.4)"),
        (one(distance_m=1.0, speed=1), "alternatives.leaders[0].speed: is not a known key"),
        ({"leaders": {"leader": SECOND}}, "alternatives.leaders: a mapping is not a list"),
        ({"leaders": [{"leader": SECOND, "distance_m": 1.0}] * 2}, "alternatives.leaders[1].leader: wears tag 10, as"),
        ({"after_lost_s": 0.1}, "alternatives.after_lost_s: 0.1 is outside [0.3, 3600]"),
        ({"back_after_s": 0.5}, "alternatives.back_after_s: 0.5 is shorter than alternatives.after_lost_s (1)"),
        ({"lost_after_s": 1.0}, "alternatives.lost_after_s: is not a known key here; known: after_lost_s"),
    ],
)
def test_what_is_wrong_is_named_and_the_program_ends_with_78(tmp_path, alternatives, said):
    file = written(tmp_path, alternatives)
    done = subprocess.run(
        [find_executable(COORDINATOR), "--config", file, "--source", "images:nowhere", "--lcm-url", "memq://"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 78 and said in done.stderr + done.stdout


def test_an_empty_list_is_none(tmp_path):
    assert Coordinator(load_coordinator(written(tmp_path, {"leaders": []})).coordinator).leader_index == 0

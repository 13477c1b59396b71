"""What docs/formations.md shows is what there is."""

import re

import pytest
import yaml
from formation_files import HERE, formation

from page_commands import ROOT, blocks
from pilotfish import coordinator, data
from pilotfish.errors import ConfigError
from pilotfish.formation.file import read_formation
from pilotfish.formation.shapes import SHAPES

PAGE = "docs/formations.md"


def test_the_formation_of_the_page_can_be_loaded():
    text, _ = blocks(PAGE, "yaml")
    shown = read_formation(yaml.safe_load(text), HERE)
    assert len(shown.stages) == 3 and shown.stages[2].over_s == 2.0


def test_the_keys_with_which_robots_announce_what_they_drive_are_read(tmp_path):
    _, text = blocks(PAGE, "yaml")
    file = tmp_path / "robot2.yaml"
    own = yaml.safe_load(data.path("config/coordinator.yaml").read_text())
    for key in ("leader", "fuzzy"):
        own[key] = str(data.path(f"config/{own[key]}").resolve())
    own["camera"]["calibration"] = str(data.path(f"config/{own['camera']['calibration']}").resolve())
    asked = yaml.safe_load(text)
    own["control"] = {**own.get("control", {}), **asked.pop("control")}
    file.write_text(yaml.safe_dump(own | asked))
    read = coordinator.load_coordinator(str(file))
    assert read.publish_intent and read.leader_intent_from == "robot1"
    assert read.coordinator.control.leader_intent.feed_forward


def test_the_refusal_that_the_page_quotes_is_the_one_that_is_said():
    with pytest.raises(ConfigError) as refused:
        formation("wedge", angle_deg=35.0)
    said = str(refused.value).removeprefix("my_formation.yaml: ")
    assert said in " ".join((ROOT / PAGE).read_text().split())


def test_the_page_names_every_shape():
    assert set(SHAPES) <= set(re.findall(r"^\| `(\w+)` \|", (ROOT / PAGE).read_text(), flags=re.MULTILINE))


def test_the_python_of_the_page_compiles():
    (text,) = blocks(PAGE, "python")
    compile(text, PAGE, "exec")

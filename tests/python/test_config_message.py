"""What is wrong with a configuration, in a command's words."""

import pytest
from typer.testing import CliRunner

from pilotfish.cli import app
from pilotfish.cli.console import _or_a_link
from pilotfish.config_message import in_file, with_meant_key
from pilotfish.robot_folder import create


def test_the_file_is_named_once():
    assert in_file("a.b: is missing (in x/r.yaml)", "x/r.yaml") == "x/r.yaml: a.b: is missing"
    assert in_file("file: x/r.yaml is not a YAML mapping", "x/r.yaml") == "x/r.yaml is not a YAML mapping"
    assert in_file("leader: x/l.yaml is empty", "x/r.yaml") == "x/r.yaml: leader: x/l.yaml is empty"


@pytest.mark.parametrize(
    ("message", "meant"),
    [
        ("setpoint.distanc_m: is not a known key here; known: bearing_deg, distance_m, run", "distance_m"),
        ("r.yaml: runn: is not a known key here; known: bearing_deg, distance_m, run (in r.yaml)", "run"),
        ("tags[0].szie_m: is not a known key here; known: id, size_m", "size_m"),
    ],
)
def test_a_misspelt_key_is_answered_with_the_nearest_one(message, meant):
    assert f"is not a known key here (did you mean {meant}?); known: " in with_meant_key(message)


def test_what_is_near_no_key_and_other_messages_stay_as_they_are():
    for message in ("colour: is not a known key here; known: run, id", "a.b: nan is outside [0, 1]"):
        assert with_meant_key(message) == message


def test_a_command_says_both(tmp_path):
    create("r", tmp_path / "r")
    config = tmp_path / "r" / "r.yaml"
    config.write_text(config.read_text().replace("distance_m: 1.10", "distanc_m: 1.10"))
    done = CliRunner().invoke(app, ["doctor", "--config", str(config)])
    said = " ".join(done.stderr.split())
    assert done.exit_code == 78
    assert "did you mean distance_m?" in said
    assert said.count(str(config)) == 1


def test_a_link_that_leads_nowhere_is_there(tmp_path):
    circle, nowhere = tmp_path / "circle", tmp_path / "nowhere"
    circle.symlink_to(circle)
    nowhere.symlink_to("gone.yaml")
    assert _or_a_link(f"file '{circle}' does not exist.").endswith("is a symbolic link that leads in a circle.")
    assert "leads to gone.yaml, which is not there" in _or_a_link(f"file '{nowhere}' does not exist.")
    assert _or_a_link("file 'other' does not exist.") == "file 'other' does not exist."
    done = CliRunner().invoke(app, ["doctor", "--config", str(circle)])
    assert done.exit_code == 66
    assert "in a circle" in " ".join(done.stderr.split())

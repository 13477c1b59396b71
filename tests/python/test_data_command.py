"""``pilotfish data``: every shipped file with one line, its path, a copy."""

import re

import pytest
from typer.testing import CliRunner

from pilotfish import data
from pilotfish.cli import app
from pilotfish.errors import MissingFileError


def run(*arguments):
    result = CliRunner().invoke(app, ["data", *(str(argument) for argument in arguments)])
    return result.exit_code, result.output


def flat(text):
    return re.sub(r"\s+", " ", text)


def test_every_shipped_file_is_listed_with_what_it_says_of_itself():
    code, said = run()
    assert code == 0
    for file in data.files():
        (line,) = [line for line in said.splitlines() if line.split()[0] == str(file.relative_to(data.root()))]
        assert data.describe(file) and data.describe(file) in line
    listed = {str(file.relative_to(data.root())) for file in data.files()}
    assert {"scenarios/line.yaml", "calibrations/visp_640x480.xml", "robot/wheel_driver.py"} <= listed
    assert not any(name.endswith(".pyc") for name in listed)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("# One. Two.\nname: x\n", "One."),
        ("# Keep it (Fig. 6): go\n# on. Then more.\n", "Keep it (Fig. 6): go on."),
        ("%YAML:1.0\n---\n# A camera.\n", "A camera."),
        ("#!/bin/sh\n# A script\n", "A script"),
        ("name: x\n", ""),
    ],
)
def test_a_file_is_described_by_the_first_sentence_of_its_first_comment(tmp_path, name, text):
    (tmp_path / "f.yaml").write_text(name)
    assert data.describe(tmp_path / "f.yaml") == text


@pytest.mark.parametrize(
    "name", ["scenarios/chain.yaml", "scenarios/chain", "chain", "chain.yaml", "data/scenarios/chain.yaml"]
)
def test_a_file_is_found_by_path_and_by_name(name):
    code, said = run(name)
    assert code == 0
    assert said.strip() == str(data.path("scenarios/chain.yaml"))


def test_a_folder_lists_its_files():
    code, said = run("leaders")
    assert code == 0
    assert [line.split()[0] for line in said.splitlines()] == [
        "leaders/single_tag.yaml",
        "leaders/three_faces.yaml",
        "leaders/three_faces_second.yaml",
        "leaders/three_faces_third.yaml",
    ]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("line", "config/line.yaml, scenarios/line.yaml"),
        ("scenarios/lime.yaml", "did you mean scenarios/line.yaml?"),
        ("/etc/passwd", "no shipped file"),
        ("../data/config/line.yaml", "no shipped file"),
        ("", "no shipped file"),
    ],
)
def test_what_is_not_shipped_is_not_found(name, words):
    code, said = run(name)
    assert code == 66
    assert words in flat(said)


def test_a_copy_is_the_file_and_nothing_is_overwritten(tmp_path):
    code, said = run("leaders/single_tag.yaml", "--copy", tmp_path / "my.yaml")
    assert code == 0, said
    assert (tmp_path / "my.yaml").read_bytes() == data.path("leaders/single_tag.yaml").read_bytes()
    assert run("leaders/single_tag.yaml", "--copy", tmp_path)[0] == 0  # into the folder
    assert (tmp_path / "single_tag.yaml").is_file()
    for target in (tmp_path / "my.yaml", tmp_path):
        code, said = run("leaders/single_tag.yaml", "--copy", target)
        assert code == 74
        assert "nothing is overwritten" in flat(said)


def test_a_copy_that_names_files_that_are_not_beside_it_says_so(tmp_path):
    code, said = run("scenarios/line.yaml", "--copy", tmp_path / "folder/line.yaml")
    assert code == 0
    assert "../leaders/three_faces.yaml" in said and "../config/line.yaml" in said


def test_a_copy_of_everything_can_be_used(tmp_path):
    from pilotfish.harness.scenario import Scenario

    code, said = run("--copy", tmp_path / "all")
    assert code == 0, said
    assert "warning" not in said
    copied = {file.relative_to(tmp_path / "all") for file in (tmp_path / "all").rglob("*") if file.is_file()}
    assert copied == {file.relative_to(data.root()) for file in data.files()}
    for file in (tmp_path / "all/scenarios").glob("*.yaml"):
        assert Scenario.load(file).robots
    assert run("--copy", tmp_path / "all")[0] == 74


def test_a_place_that_cannot_be_written_is_told():
    code, said = run("leaders/single_tag.yaml", "--copy", "/proc/nothing/here.yaml")
    assert code == 74
    assert "Traceback" not in said


def test_a_scenario_is_found_by_its_name():
    assert data.scenario("line") == data.scenario("line.yaml") == data.path("scenarios/line.yaml")
    with pytest.raises(MissingFileError, match="did you mean figure_eight"):
        data.scenario("figure_8")

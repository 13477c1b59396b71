"""``pilotfish formation``: what it shows, writes and refuses."""

import json
import re

import pytest
from PIL import Image
from typer.testing import CliRunner

from pilotfish.cli import app
from pilotfish.formation import formations
from pilotfish.harness.scenario import Scenario

COMMANDS = ("show", "expand", "run", "stability", "gaps")


def run(*words):
    result = CliRunner().invoke(app, ["formation", *map(str, words)])
    said = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    return result.exit_code, re.sub(r"[\s│]+", " ", said)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_help_has_examples_to_copy(command):
    code, said = run(command, "--help")
    assert code == 0 and re.search(rf"Examples pilotfish formation {command}\b", said)


@pytest.mark.parametrize("name", ["column", "tree"])
def test_a_shipped_formation_is_shown_with_a_drawing(name, tmp_path):
    code, said = run("show", name, "--out", tmp_path / "shape.png")
    assert code == 0, said
    assert "robot1 leader" in said and "10, 11, 12" in said
    with Image.open(tmp_path / "shape.png") as picture:
        assert len(set(picture.convert("L").resize((40, 40)).tobytes())) > 5, "something is drawn"


def test_a_formation_is_expanded_to_a_scenario_and_its_changes_are_said_to_be_missing(tmp_path):
    code, said = run("expand", "wedge", "--out", tmp_path / "mine.yaml")
    assert code == 0 and "2 changes of shape are not in the scenario" in said
    assert [robot.name for robot in Scenario.load(tmp_path / "mine.yaml").robots] == [f"robot{k}" for k in range(1, 5)]


def test_a_run_tells_how_robots_keep_their_places_and_how_long_forming_takes(tmp_path):
    code, said = run("run", "column", "--duration-s", 4, "--out", tmp_path)
    assert code == 0, said
    assert re.search(r"robot3 robot2 1\.00 [+-]?0\.\d\d 0\.\d\d", said), "within a millimetre"
    assert re.search(r"0 column \d\.\d 0\.99\d", said), "formed, and a metre apart"
    expected = {f"column_anticipate_robot{k}.csv" for k in (1, 2, 3)} | {"column_anticipate_paths.png"}
    assert {file.name for file in tmp_path.iterdir()} == expected


def test_stability_prints_tables_and_writes_picture_and_json(tmp_path):
    few = ("--robots", 2, "--frequency-hz", 1, "--law", "paper", "--law", "pid", "--jobs", 1)
    code, said = run("stability", *few, "--out", tmp_path, "--json", tmp_path / "s.json")
    assert code == 0, said
    assert "peak gain" in said and "PID" in said
    figures = json.loads((tmp_path / "s.json").read_text())
    assert [result["law"] for result in figures["results"]] == ["paper", "pid"]
    assert (tmp_path / "string_stability.png").stat().st_size > 10_000


def test_gaps_prints_every_robot_on_every_path(tmp_path):
    code, said = run("gaps", "--robots", 2, "--speed-mps", 0.5, "--json", tmp_path / "g.json")
    assert code == 0, said
    assert "line reached, circle reached, figure eight reached" in said
    assert [path["path"] for path in json.loads((tmp_path / "g.json").read_text())] == [
        "line",
        "circle",
        "figure_eight",
    ]


def test_an_experiment_takes_a_formation_file(tmp_path):
    words = ("experiment", formations()["line_abreast"], "--in-process", "--duration-s", 0.5, "--profile", "paper")
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    assert "robot3" in result.output


WRONG = [
    (("show", "wegde"), 66, r"did you mean wedge\?.*shipped are: column"),
    (("show", "wedge", "--out", "x.gif"), 64, "ends in none of .png"),
    (("expand", "wedge", "--out", "x.txt"), 64, "ends in neither .yaml nor .yml"),
    (("run", "wedge", "--rendered", "--lcm"), 64, "exclude each other"),
    (("run", "BAD"), 78, "bad.yaml: spacing_m: is missing"),
    (("expand", "BAD", "--out", "BAD"), 74, "is what is read"),
    (("stability", "--frequency-hz", "nan"), 64, "--frequency-hz: nan is not a number from 0.005 to 5 Hz"),
    (("stability", "--headway-s", "-1"), 64, "--headway-s: -1.0 is not a number from 0 to 3 s"),
    (("stability", "--amplitude-mps", "0.5"), 64, "less than the speed"),
    (("stability", "--law", "bogus"), 64, "bogus"),
    (("stability", "--spacing-m", "0.3"), 64, "spacing_m: .* allowed: 0.61 m"),
    (("gaps", "--robots", "1"), 64, "--robots"),
]


@pytest.mark.parametrize(("words", "code", "says"), WRONG, ids=[" ".join(words) for words, _, _ in WRONG])
def test_what_is_wrong_ends_with_its_code_and_says_what_is_allowed(words, code, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.yaml").write_text("name: bad\nshape: wedge\nrobots: 3\n")
    ended, said = run(*("bad.yaml" if word == "BAD" else word for word in words))
    assert ended == code, said
    assert re.search(says, said)
    assert "Traceback" not in said
    assert {file.name for file in tmp_path.iterdir()} == {"bad.yaml"}, "nothing is left behind"


@pytest.mark.parametrize(
    "text", ["", "- 1\n", "name: [1\n", "name: a\nname: b\n", "3\n", "&a [*a]\n", "name: a\nshape: [wedge]\n", "\x00"]
)
def test_a_file_that_is_no_formation_is_refused_without_a_traceback(text, tmp_path):
    (tmp_path / "odd.yaml").write_text(text)
    code, said = run("show", tmp_path / "odd.yaml", "--out", tmp_path / "x.png")
    assert code == 78, said
    assert "odd.yaml: " in said

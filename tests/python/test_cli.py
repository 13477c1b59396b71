"""The command line: what it teaches, what it says when something is wrong, what it leaves behind."""

import itertools
import json
import re

import pytest
from synthetic_run import exponential_run
from test_picture_page import check_page
from typer.testing import CliRunner

from pilotfish import data, sim
from pilotfish.cli import app
from pilotfish.plots.style import DARK

runner = CliRunner()
pytestmark = pytest.mark.usefixtures("small_pictures")


def run(*arguments):
    result = runner.invoke(app, [str(argument) for argument in arguments])
    # Colours and line breaks depend on the terminal; the words do not.
    said = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    return result, re.sub(r"[\s│]+", " ", said)


def test_without_a_command_the_help_is_shown():
    _, said = run()
    for command in ("stop", "resume", "go", "setpoint", "key", "experiment", "render", "plot", "learn-body", "tune"):
        assert f" {command} " in said
    for command in ("demo", "doctor", "top", "init", "data"):
        assert f" {command} " in said


@pytest.mark.parametrize(
    "command",
    [
        *("stop", "resume", "go", "setpoint", "key new", "experiment", "render", "plot", "replay", "report", "export"),
        *("learn-body", "tune", "demo", "doctor", "top", "init", "data", "view", "leader show", "leader check"),
        *("calibrate camera", "calibrate mounting"),
    ],
)
def test_every_help_has_an_example_to_copy(command):
    result, said = run(*command.split(), "--help")
    assert result.exit_code == 0
    assert re.search(rf"Examples?\b.*pilotfish {command} ", said)


def test_the_version_is_the_package_s():
    result, said = run("--version")
    assert (result.exit_code, said.strip()) == (0, "pilotfish 0.1.0")


@pytest.mark.parametrize(
    ("arguments", "wrong"),
    [
        (["experiment", "line", "--profile", "clairvoyant"], "clairvoyant"),
        (["experiment", "line", "--duration-s", "-1"], "--duration-s"),
        (["render", "line"], "--out"),
        (["plot", __file__], ".py"),
    ],
)
def test_a_wrong_command_line_ends_with_64_and_says_which_word_is_wrong(arguments, wrong):
    result, said = run(*arguments)
    assert result.exit_code == 64
    assert wrong in said


def test_missing_programs_end_with_69_and_say_how_to_get_them(tmp_path, monkeypatch):
    monkeypatch.setenv("PILOTFISH_BIN", str(tmp_path))
    result, said = run("experiment", "line")
    assert result.exit_code == 69
    assert "cmake --build" in said
    assert "PILOTFISH_BIN" in said


def test_a_scenario_that_cannot_be_used_ends_with_78_and_names_the_key(tmp_path):
    scenario = tmp_path / "odd.yaml"
    scenario.write_text("name: odd\nrobots:\n  - {name: leader, colour: red}\n")
    result, said = run("render", scenario, "--out", tmp_path / "out")
    assert result.exit_code == 78
    assert "colour" in said
    assert not (tmp_path / "out").exists()


def test_a_shipped_scenario_that_does_not_exist_ends_with_66_and_lists_those_that_do(tmp_path):
    result, said = run("render", "lime", "--out", tmp_path)
    assert result.exit_code == 66
    assert "did you mean line?" in said
    assert "figure_eight" in said


def test_a_broken_recording_ends_with_65(tmp_path):
    (tmp_path / "broken.csv").write_text("a,b\n1,2\n")
    result, said = run("plot", tmp_path / "broken.csv")
    assert result.exit_code == 65
    assert "not a recording" in said


def test_a_broken_fuzzy_controller_ends_with_78_and_is_named(tmp_path):
    text = data.path("fuzzy/coordination.yaml").read_text()
    (tmp_path / "broken.yaml").write_text(text.replace("NB:      [PB, PB,", "NB:      [PB, XX,"))
    result, said = run("plot", tmp_path / "broken.yaml")
    assert result.exit_code == 78
    assert "XX" in said


def test_a_recording_is_plotted_beside_itself(tmp_path):
    exponential_run().to_csv(tmp_path / "run.csv")
    result, said = run("plot", tmp_path / "run.csv")
    assert result.exit_code == 0, said
    assert {file.name for file in tmp_path.glob("*.png")} == {"run_paths.png", "run_distance_error.png"}


@pytest.mark.parametrize(
    ("file", "what"),
    [
        ("scenarios/line.yaml", "a scenario"),
        ("config/line.yaml", "a coordinator's configuration"),
        ("leaders/three_faces.yaml", "a leader's body"),
    ],
)
def test_a_yaml_file_of_another_kind_is_called_by_its_kind(file, what):
    result, said = run("plot", data.path(file))
    assert result.exit_code == 78
    assert f"no fuzzy controller: E: is missing; this file looks like {what}" in said


def test_a_recording_without_a_setpoint_is_plotted_once_the_setpoint_is_given(tmp_path):
    exponential_run().with_meta(distance_setpoint_m=float("nan")).to_csv(tmp_path / "run.csv")
    result, said = run("plot", tmp_path / "run.csv")
    assert result.exit_code == 64
    assert "--distance-setpoint-m" in said
    assert run("plot", tmp_path / "run.csv", "--distance-setpoint-m", "1.0")[0].exit_code == 0


def test_a_fuzzy_controller_is_plotted(tmp_path):
    result, said = run("plot", data.path("fuzzy/coordination.yaml"), "--out", tmp_path)
    assert result.exit_code == 0, said
    assert {file.name for file in tmp_path.glob("*.png")} == {
        "coordination_sets.png",
        "coordination_surface.png",
    }


@pytest.mark.parametrize("words", [["experiment", "squar"], ["render", "squar", "--out", "OUT"]])
def test_a_misspelt_scenario_is_answered_with_what_may_be_meant_and_all_there_are(tmp_path, words):
    result, said = run(*(tmp_path / "out" if word == "OUT" else word for word in words))
    assert result.exit_code == 66
    assert "did you mean square?" in said
    for file in data.path("scenarios").glob("*.yaml"):
        assert file.stem in said


@pytest.mark.parametrize("name", sorted(file.stem for file in data.path("scenarios").glob("*.yaml")))
def test_every_shipped_scenario_can_be_played_by_its_name(name):
    result, said = run("experiment", name, "--in-process", "--duration-s", "0.5", "--profile", "anticipate")
    assert result.exit_code == 0, said
    assert "steady-state distance error" in said


def test_an_experiment_with_two_followers_shows_and_writes_both(tmp_path):
    words = ["experiment", "star", "--in-process", "--duration-s", "0.5", "--profile", "anticipate", "--out", tmp_path]
    result, said = run(*words)
    assert result.exit_code == 0, said
    robots = [robot.name for robot in sim.load_scenario(data.path("scenarios/star.yaml")).robots if robot.follows]
    assert f"star star {' '.join(robots)} anticipate anticipate" in said  # the heads of two columns, line by line
    assert len(list(tmp_path.glob("*.csv"))) == 2


def test_a_scenario_of_one_s_own_can_be_played(tmp_path):
    text = data.path("scenarios/line.yaml").read_text().replace("../", f"{data.root()}/")
    (tmp_path / "my_line.yaml").write_text(text)
    words = ["experiment", tmp_path / "my_line.yaml", "--in-process", "--duration-s", "0.5", "--profile", "paper"]
    result, said = run(*words)
    assert result.exit_code == 0, said
    assert "my_line paper" in said


def test_a_scenario_without_a_nonideal_robot_names_those_that_have_one():
    result, said = run("experiment", "chain", "--robot", "nonideal", "--in-process")
    assert result.exit_code == 66
    assert "circle, line" in said


def test_a_short_sequence_is_rendered(tmp_path):
    result, said = run("render", "line", "--out", tmp_path, "--frames", "2")
    assert result.exit_code == 0, said
    assert "wrote 2 pictures" in said
    assert {file.name for file in tmp_path.iterdir()} == {"000000.png", "000001.png", "frames.csv"}


def test_an_experiment_prints_its_table_and_leaves_its_files(tmp_path):
    result, said = run("experiment", "circle", "--in-process", "--duration-s", "1", "--out", tmp_path)
    assert result.exit_code == 0, said
    assert "steady-state distance error" in said
    each = ("circle_{}.csv", "circle_{}_distance_error.png", "circle_{}_paths.png")
    names = {name.format(profile) for profile in ("paper", "anticipate") for name in each}
    assert {file.name for file in tmp_path.iterdir()} == names | {"comparison.png"}


def test_an_experiment_can_be_played_with_a_nonideal_robot():
    result, said = run("experiment", "line", "--robot", "nonideal", "--in-process", "--duration-s", "1")
    assert result.exit_code == 0, said
    assert "non-ideal" in said


@pytest.mark.parametrize("law", ["pbvs", "pid"])
def test_an_experiment_can_be_driven_by_a_peer(tmp_path, law):
    result, said = run("experiment", "line", "--law", law, "--in-process", "--duration-s", "1", "--out", tmp_path)
    assert result.exit_code == 0, said
    assert {file.suffix for file in tmp_path.iterdir()} == {".csv", ".png"}
    assert (tmp_path / f"line_{law}.csv").is_file()


def test_the_demo_leaves_every_picture_of_its_experiments(tmp_path):
    result, said = run("demo", "--duration-s", "1", "--out", tmp_path)
    assert result.exit_code == 0, said
    each = ("{}_{}.csv", "{}_{}_distance_error.png", "{}_{}_paths.png")
    runs = [(which, profile) for which in ("line", "circle") for profile in ("paper", "anticipate")]
    runs += [("line_nonideal", "anticipate"), ("circle_nonideal", "anticipate")]
    wedge = [f"wedge_obstacles_robot{k}_anticipate" for k in (1, 2, 3, 4)]
    expected = {name.format(*names) for names in runs for name in each} | {f"{name}.csv" for name in wedge}
    assert {file.name for file in tmp_path.iterdir()} == expected | {
        "index.html",
        "line_anticipate_camera.gif",
        "circle_anticipate_camera.gif",
        "wedge_obstacles.png",
        "wedge_obstacles_camera.gif",
        "overview.png",
        "comparison.png",
        "fuzzy_sets.png",
        "control_surface.png",
        "metrics.json",
    }
    figures = json.loads((tmp_path / "metrics.json").read_text())
    assert set(figures) == {f"{which}_{profile}" for which, profile in runs} | set(wedge)
    assert figures["line_paper"]["initial_distance_m"] == pytest.approx(2.44, abs=1e-3)
    # The last line leads to the page, and the page to everything else.
    last = result.output.strip().splitlines()[-1]
    assert last.split()[-1] == (tmp_path / "index.html").resolve().as_uri()
    page = check_page(tmp_path)
    assert {link for link in page.links if link[0] != "#"} == {file.name for file in tmp_path.iterdir()} - {
        "index.html"
    }
    assert "steady-state distance error" in page.text
    assert "clearance to obstacles" in page.text and "clearance to obstacles" in said


@pytest.mark.parametrize("kind", ["svg", "pdf"])
def test_pictures_are_written_in_the_format_that_is_asked_for(tmp_path, kind):
    words = ("experiment", "line", "--in-process", "--duration-s", "0.5", "--out", tmp_path, "--format", kind, "--dark")
    result, said = run(*words)
    assert result.exit_code == 0, said
    assert {file.suffix for file in tmp_path.iterdir()} == {".csv", f".{kind}"}
    if kind == "svg":
        assert DARK.ground.lower() in (tmp_path / "comparison.svg").read_text().lower()


def test_a_format_that_does_not_exist_is_refused_with_those_that_do():
    result, said = run("experiment", "line", "--format", "bmp")
    assert result.exit_code == 64
    assert "'png', 'svg', 'pdf'" in said


def test_all_laws_are_compared_under_their_names():
    result, said = run("experiment", "line", "--all-laws", "--in-process", "--duration-s", "0.5")
    assert result.exit_code == 0, said
    assert re.search(r"paper anticipate ViSP's PID servo", said)


@pytest.mark.parametrize("words", [("--law", "pid"), ("--tuning", data.path("tuned/pid.yaml"))])
def test_all_laws_and_one_law_contradict_each_other(words):
    result, said = run("experiment", "line", "--all-laws", "--in-process", *words)
    assert result.exit_code == 64
    assert "--all-laws" in said and words[0] in said


@pytest.mark.parametrize("words", [["experiment", "line"], ["demo"], ["render", "SCENARIO"]])
def test_a_folder_that_cannot_be_made_is_refused_before_the_work(words):
    words = [data.path("scenarios/line.yaml") if word == "SCENARIO" else word for word in words]
    result, said = run(*words, "--out", "/proc/self/nothing")
    assert result.exit_code == 74
    assert "/proc/self/nothing: nothing can be written in /proc/self" in said


@pytest.mark.parametrize("distance_m", ["-1", "nan", "20.5"])
def test_a_distance_out_of_bounds_is_refused_before_anybody_is_asked(distance_m):
    result, said = run("setpoint", "robot1", "--distance-m", distance_m)
    assert result.exit_code == 64
    assert f"--distance-m: {distance_m} is outside [0.05, 20]" in said


@pytest.mark.parametrize(
    ("arguments", "wrong"),
    [
        (["view", "--port", "99999"], "99999 is not allowed; from 0 to 65535 is"),
        (["tune", "pid", "--trials=0"], "0 is not allowed; from 1 to 1000000 is"),
        (["calibrate", "camera", "x", "--board", "y", "--every", "-3"], "-3 is not allowed; 1 or more is"),
        (["tune", "nope"], "'law': 'nope' is not one of 'paper', 'anticipate'"),
    ],
)
def test_a_number_out_of_range_is_said_with_the_number_and_its_range(arguments, wrong):
    result, said = run(*arguments)
    assert (result.exit_code, wrong in said) == (64, True), said


def test_a_file_without_any_event_is_no_recording_to_replay(tmp_path):
    (tmp_path / "notes.txt").write_text("hello")
    result, said = run("replay", tmp_path / "notes.txt")
    assert result.exit_code == 65
    assert "notes.txt: no event of LCM in it" in said


@pytest.mark.parametrize("columns", [70, 110])
@pytest.mark.parametrize("command", ["view", "doctor"])
def test_running_text_of_a_help_is_wrapped_at_the_terminal_s_width_alone(command, columns):
    """A line ends where its next word would not have fitted: never in the middle of the width."""
    shown = runner.invoke(app, [command, "--help"], env={"COLUMNS": str(columns)}, terminal_width=columns).output
    lines = [line.strip() for line in re.sub(r"\x1b\[[0-9;]*m", "", shown).splitlines()]
    text = lines[1 + next(at for at, line in enumerate(lines) if line.startswith("Usage")) : lines.index("Examples")]
    wrapped = [(line, after) for line, after in itertools.pairwise(text) if line and after]
    assert wrapped
    for line, after in wrapped:
        assert len(line) + 1 + len(after.split()[0]) > columns - 3, (line, after)

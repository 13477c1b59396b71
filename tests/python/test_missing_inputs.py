"""A file that is named and not there ends every command with 66 and one line that names it."""

import re

import pytest
import typer.main
from command_lines import CALIBRATION, LAW, LEADER
from typer.testing import CliRunner

from pilotfish.cli import app

GONE = "nowhere/gone.yaml"
BOARD = ["--board", "charuco:8x6:30mm:22mm"]
LEARNING = ["--tag-size", "0.16", "--output", "out.yaml"]
MOUNTING = ["--tag-size", "0.16", "--height-m", "0.3"]

# One line for every place of a file that is read; GONE stands in it.
LINES = [
    ["tags", "--body", GONE],
    ["learn-body", GONE, "--camera", CALIBRATION, *LEARNING],
    ["learn-body", "{tmp}", "--camera", GONE, *LEARNING],
    ["learn-body", "{tmp}", "--camera", CALIBRATION, "--reference-leader", GONE, *LEARNING],
    ["init", "robot1", "--calibration", GONE],
    ["init", "robot1", "--leader", GONE],
    ["doctor", "--config", GONE],
    ["doctor", "--following", "robot1", "--config", GONE],
    ["data", GONE],
    ["view", "--config", GONE],
    ["view", "--fuzzy", GONE],
    ["view", "--key", GONE],
    ["view", "--camera", "0", "--tag-size", "0.1", "--camera-file", GONE],
    ["view", "--camera", f"images:{GONE}", "--tag-size", "0.1"],
    ["view", "--camera", f"video:{GONE}", "--tag-size", "0.1"],
    ["top", "--once", "--key", GONE],
    *(["plot", file] for file in (GONE, "nowhere/gone.csv", "nowhere/gone.lcmlog", "nowhere/gone")),
    ["report", GONE],
    ["report", LAW, GONE],
    ["export", GONE, "--out", "run.csv"],
    ["replay", GONE],
    ["identify", GONE],
    ["experiment", GONE],
    ["experiment", "line", "--tuning", GONE],
    ["render", GONE, "--out", "out"],
    ["render", "scenario", GONE, "--out", "out"],
    *(
        ["render", what, "--out", "out", option, GONE]
        for what in ("board", "mounting", "body")
        for option in ("--camera", "--config")
    ),
    ["render", "body", "--out", "out", "--leader", GONE],
    ["calibrate", "camera", "{tmp}", *BOARD, "--truth", GONE],
    ["calibrate", "mounting", "{film}", "--camera", CALIBRATION, *MOUNTING, "--truth", GONE],
    ["learn-body", "{tmp}", "--camera", CALIBRATION, *LEARNING, "--truth", GONE],
    *(["go", "robot1", "--key", GONE], ["resume", "robot1", "--key", GONE]),
    ["setpoint", "robot1", "--distance-m", "1", "--key", GONE],
    ["calibrate", "camera", GONE, *BOARD],
    ["calibrate", "camera", "{tmp}", "--board", GONE],
    ["calibrate", "mounting", GONE, "--camera", CALIBRATION, *MOUNTING],
    ["calibrate", "mounting", "camera:0", "--camera", GONE, *MOUNTING],
    ["calibrate", "mounting", "{film}", "--straight", GONE, "--camera", CALIBRATION, *MOUNTING],
    *(["leader", command, GONE] for command in ("show", "check")),
    *(
        ["leader", command, LEADER, option, GONE]
        for command in ("show", "check")
        for option in ("--config", "--camera")
    ),
    ["sweep", GONE],
    ["sweep", "run", GONE],
    ["sweep", "rerun", GONE, "0"],
    ["sweep", "plot", GONE, "--over", "law"],
    ["sweep", "sensitivity", GONE],
    ["sweep", "report", GONE],
    *(["formation", command, GONE] for command in ("show", "run")),
    ["formation", "expand", GONE, "--out", "out.yaml"],
    *(["formation", command, "--config", GONE] for command in ("stability", "gaps")),
    *(["fuzzy", command, GONE] for command in ("show", "check", "prove", "plot")),
    ["fuzzy", "prove", LAW, "--config", GONE],
    ["fuzzy", "explain", GONE, "--e", "0.1"],
    ["fuzzy", "convert", GONE, "out.fll"],
]

# Parameters of the type of a path that say where to write.
WRITTEN = {"out", "output", "folder of init", "leader of tags", "copy", "plot of identify", "report", "json_file"}
WRITTEN |= {"key of stop"}  # is done without it
WRITTEN |= {"csv_file", "counterexample", "target", "file of key new"}


def name(line):
    return "_".join(str(word).rpartition("/")[2] for word in line)


@pytest.mark.parametrize("line", LINES, ids=name)
def test_what_is_not_there_ends_with_66_and_is_named(tmp_path, monkeypatch, line):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LCM_DEFAULT_URL", "memq://")
    (film := tmp_path / "film").mkdir()
    result = CliRunner().invoke(app, [str(word).format(tmp=tmp_path, film=film) for word in line])
    assert result.exit_code == 66, result.output
    assert len(ours := re.findall(r"^pilotfish: .*nowhere/gone", result.output, re.MULTILINE)) == 1, (
        ours,
        result.output,
    )
    assert sorted(tmp_path.iterdir()) == [film]


def commands(command, words=()):
    """(words, its parameters) of every command."""
    for name, each in getattr(command, "commands", {}).items():
        yield from commands(each, (*words, name))
    if not hasattr(command, "commands"):
        yield words, command.params


def test_every_place_of_a_file_that_is_read_has_a_line():
    missing = []
    for words, params in commands(typer.main.get_command(app)):
        for param in params:
            kind = getattr(param, "type_descriptor", None)
            if kind is None or "Path" not in str(kind.annotation):
                continue
            if {param.name, f"{param.name} of {' '.join(words)}", f"{param.name} of {words[-1]}"} & WRITTEN:
                continue
            option = next((each for each in param.opts if each.startswith("--")), None)
            lines = [
                line
                for line in LINES
                if tuple(line[: len(words)]) == words or (words == ("sweep", "run") and line[0] == "sweep")
            ]
            there = [
                line for line in lines if GONE in line and (option is None or line[line.index(GONE) - 1] == option)
            ]
            missing += [] if there else [(words, param.name)]
    assert missing == []


def test_an_argument_that_is_not_there_is_named_once_and_an_option_s_by_the_option():
    """Not "file: file 'gone.yaml' does not exist": an argument's name says nothing that its value does not."""
    said = [CliRunner().invoke(app, words).output for words in (["leader", "show", GONE], ["doctor", "--config", GONE])]
    assert said == [
        f"pilotfish: file '{GONE}' does not exist.\n",
        f"pilotfish: --config: file '{GONE}' does not exist.\n",
    ]

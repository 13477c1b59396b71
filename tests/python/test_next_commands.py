"""What a command prints as the next one can be pasted into a shell, whatever the folder is called."""

import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from pilotfish.cli import app

AWKWARD = "my robot's [files] $HOME; (old)"  # a space, a quote, a tag of rich's markup, what a shell replaces


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / AWKWARD
    folder.mkdir()
    return folder


def run(*arguments):
    result = CliRunner().invoke(app, list(map(str, arguments)))
    assert result.exit_code == 0, result.output
    return result.output


def next_words(said):
    """The words that a shell makes of the command that is proposed."""
    return shlex.split(re.search(r"^next, .*?: (pilotfish .*)$", said, re.MULTILINE)[1])


def test_a_printed_board_leads_to_the_calibration_with_its_file(folder):
    pytest.importorskip("reportlab")
    said = run("tags", "--board", "charuco", "--out", folder / "board.pdf")
    words = next_words(said)
    assert words[:3] == ["pilotfish", "calibrate", "camera"]
    assert words[words.index("--board") + 1] == str(folder / "board.yaml")
    assert f"wrote {folder / 'board.yaml'}" in said  # the name as it is, brackets and all


def test_a_printed_leader_leads_to_a_command_that_works(folder):
    pytest.importorskip("reportlab")
    leader = folder / "leader.yaml"
    said = run("tags", "--ids", "7", "--size", "0.16", "--leader", leader, "--out", folder / "tag.pdf")
    words = next_words(said)
    assert words == ["pilotfish", "leader", "show", str(leader)]
    run(*words[1:], "--out", folder / "leader.png")
    assert (folder / "leader.png").exists()


def test_a_new_robot_s_folder_leads_to_the_doctor_with_its_configuration(folder):
    said = run("init", "robot1", "--dir", folder / "robot1")
    config = folder / "robot1" / "robot1.yaml"
    assert next_words(said) == ["pilotfish", "doctor", "--config", str(config)]


def test_every_path_in_a_robot_s_readme_is_one_word_to_a_shell(folder):
    """Each block of commands is parsed as a POSIX shell would; what names the folder must be there."""
    run("init", "robot1", "--dir", folder / "robot1")
    text = (folder / "robot1" / "README.md").read_text()
    blocks = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
    lines = "".join(blocks).replace("\\\n", " ").splitlines()
    named = [word for line in lines for word in shlex.split(line, comments=True) if str(folder) in word]
    assert len(named) >= 6
    for word in named:
        place = word.removesuffix("/pilotfish-*.service")
        assert Path(place).exists(), word

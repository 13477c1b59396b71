"""Completion in the shell: what the shells themselves make of the scripts that are installed."""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pilotfish.harness.executables import COORDINATOR, find_executable

ROOT = Path(__file__).parents[2]
PROGRAMS = ROOT / "packaging" / "completion"
pytestmark = pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")


@pytest.fixture
def home(tmp_path):
    """A home of its own, and a folder on the PATH with a `pilotfish` in it."""
    folder = tmp_path / "bin"
    folder.mkdir()
    program = folder / "pilotfish"
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m pilotfish "$@"\n')
    program.chmod(0o755)
    return tmp_path


def bash(home, script):
    """What bash prints. Its own PATH begins with the folder of programs."""
    environment = {**os.environ, "HOME": str(home), "PATH": f"{home / 'bin'}:{os.environ['PATH']}"}
    done = subprocess.run(["bash", "-c", script], env=environment, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def completed(home, setup, function, words):
    """What a completion function proposes for the last of the words."""
    quoted = " ".join(map(shlex.quote, words))
    ask = f"COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; {function} {shlex.quote(words[0])}"
    return bash(home, f'{setup}\n{ask}\nfor each in "${{COMPREPLY[@]}}"; do echo "$each"; done').splitlines()


def test_install_completion_makes_a_new_bash_complete_commands_and_options(home):
    bash(home, "pilotfish --install-completion; true")  # `true`: else bash becomes the program, and is no parent of it
    installed = (home / ".bashrc").read_text()
    assert "pilotfish" in installed
    setup = f"source {shlex.quote(str(home / '.bashrc'))}; complete -p pilotfish >&2"
    assert completed(home, setup, "_pilotfish_completion", ["pilotfish", "cal"]) == ["calibrate"]
    assert completed(home, setup, "_pilotfish_completion", ["pilotfish", "calibrate", "m"]) == ["mounting"]
    proposed = completed(home, setup, "_pilotfish_completion", ["pilotfish", "calibrate", "camera", "--re"])
    assert proposed == ["--report"]


@pytest.mark.parametrize(
    ("words", "proposed"),
    [
        ("pilotfish experiment bo", {"both"}),
        ("pilotfish render circ", {"circle", "circle_nonideal"}),
        ("pilotfish data scenarios/occ", {"scenarios/occlusion.yaml"}),
        ("pilotfish export x.lcmlog --format rr", {"rrd"}),
    ],
)
def test_names_that_are_shipped_are_completed(words, proposed):
    """As the script of a bash asks for it: by environment."""
    environment = {"COMP_WORDS": words, "COMP_CWORD": str(len(words.split()) - 1)}
    environment |= {**os.environ, **environment, "_PILOTFISH_COMPLETE": "complete_bash"}
    done = subprocess.run(
        [sys.executable, "-m", "pilotfish"], env=environment, capture_output=True, text=True, timeout=60
    )
    assert set(done.stdout.split()) == proposed, done.stderr


def test_zsh_gets_commands_with_their_first_sentence(home):
    """What its script asks for; zsh itself evaluates the answer. Where zsh is installed it reads the script, too."""
    environment = {**os.environ, "_TYPER_COMPLETE_ARGS": "pilotfish cal", "_PILOTFISH_COMPLETE": "complete_zsh"}
    done = subprocess.run(
        [sys.executable, "-m", "pilotfish"], env=environment, capture_output=True, text=True, timeout=60
    )
    assert '"calibrate":"Calibrate a camera' in done.stdout, done.stdout + done.stderr
    if shutil.which("zsh"):
        script = bash(home, "SHELL=zsh pilotfish --show-completion zsh; true")
        subprocess.run(["zsh", "-n", "-c", script], check=True, timeout=60)


@pytest.mark.parametrize("program", ["pilotfish-coordinator", "pilotfish-base", "pilotfish-sim"])
def test_the_options_of_a_program_are_completed_from_its_help(home, program):
    file = find_executable(COORDINATOR).parent / program
    if not file.exists():
        pytest.skip(f"no {program}")
    setup = f"source {shlex.quote(str(PROGRAMS / 'pilotfish-programs.bash'))}"
    said = subprocess.run([file, "--help"], capture_output=True, text=True, timeout=60, check=True).stdout
    own = {line.split()[0] for line in said.splitlines() if line.startswith("  --")}
    proposed = completed(home, setup, "_pilotfish_program", [str(file), "--"])
    assert set(proposed) == own | {"--help"}
    assert len(proposed) == len(set(proposed))
    assert completed(home, setup, "_pilotfish_program", [str(file), "--lcm"]) == ["--lcm-url"]
    assert completed(home, setup, "_pilotfish_program", [str(file), "run"]) == []  # a file: bash's own way


def test_choices_of_a_program_are_completed(home):
    setup = f"source {shlex.quote(str(PROGRAMS / 'pilotfish-programs.bash'))}"
    words = [str(find_executable(COORDINATOR)), "--law", "p"]
    assert completed(home, setup, "_pilotfish_program", words) == ["pbvs", "pid"]

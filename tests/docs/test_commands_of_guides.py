"""Every command line that a guide shows is one that its program takes: subcommand, options, numbers, choices.

What the commands do is tested where they are (tests/printing, tests/logs, tests/robot_folder, ...); README and tutorial
are run from top to bottom by tests of their own.
"""

from __future__ import annotations

import functools
import re
import shlex
import subprocess
from pathlib import Path

import pytest
import typer
import typer.main

import page_commands
from pilotfish import data as shipped
from pilotfish.cli import app
from pilotfish.harness.executables import find_executable

ROOT = Path(__file__).parents[2]
PAGES = sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/*.md"))
COMMANDS = sorted({(page, command) for page in PAGES for command in page_commands.commands(page)})
UsageError = typer.BadParameter.__base__  # typer's own copy of click, or click's
WITH_HELP = ("pilotfish-coordinator", "pilotfish-base", "pilotfish-sim", "pilotfish-spy")
# Of the system, of LCM, of the repository; docs/library.md's and examples' builds run in tests/library.
OTHERS = {
    "sudo",
    "sudoedit",
    "systemctl",
    "journalctl",
    "pip",
    "cmake",
    "man",
    "lcm-logger",
    "lcm-logplayer",
    ".",
}
MISSING = re.compile(r"'([^']+)' does not exist")


@functools.cache
def help_of(program: str) -> str:
    done = subprocess.run([find_executable(program), "--help"], capture_output=True, text=True, check=True)
    return done.stdout


def parse(words: list[str], folder: Path) -> None:
    """As typer does it, without doing it. A file that a command wants to be there is made, empty, in the folder."""
    for _ in range(10):
        try:
            command, name = typer.main.get_command(app), "pilotfish"
            rest = words
            while hasattr(command, "commands"):
                name, *rest = rest
                if hasattr(command, "with_default"):  # `sweep FILE` is `sweep run FILE`
                    name, *rest = command.with_default([name, *rest])
                if name.startswith("-"):  # an option of the program itself
                    assert any(name in option.opts for option in command.params), name
                    return
                command = command.commands[name]
            command.make_context(name, list(rest))
            return
        except typer.Exit:  # an option that prints something and ends, as --describe
            return
        except UsageError as error:
            missing = MISSING.search(error.format_message())
            if not missing:
                raise
            file = folder / missing[1]
            file.parent.mkdir(parents=True, exist_ok=True)
            file.touch()
    raise AssertionError("more than ten files are missing")


@pytest.mark.parametrize(("page", "command"), COMMANDS)
def test_every_command_of_a_guide_is_one_that_its_program_takes(page, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").symlink_to(shipped.path("."))
    program, *words = shlex.split(command)
    if program == "pilotfish":
        parse(words, tmp_path)
    elif program in WITH_HELP:
        known = set(re.findall(r"--[a-z-]+", help_of(program)))
        assert {word for word in words if word.startswith("--")} <= known
    elif program == "python" and words[0] == "-m":
        assert (ROOT / "python" / words[1].replace(".", "/")).with_suffix(".py").is_file()
    elif program == "python":  # an example; tests/ros runs those of docs/ros.md
        assert words[0].startswith(("examples/", "bench/")) and (ROOT / words[0]).is_file()
    elif program.startswith(("scripts/", "apps/")):
        assert (ROOT / program).is_file()
    else:
        assert program in OTHERS, f"{page}: who tests {program}?"


@pytest.mark.parametrize(
    "line", ["--install-complete", "view --camra 0", "view --tag-size 9", "calibrate lens", "leader check"]
)
def test_a_command_line_that_is_wrong_would_be_found(line, tmp_path):
    with pytest.raises((UsageError, KeyError, AssertionError)):
        parse(line.split(), tmp_path)


def test_guides_show_many_commands():
    assert len(COMMANDS) > 60

"""docs/recordings.md: its commands and its code, as they stand there."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs/recordings.md").read_text()
(SHELL,) = re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)
(CODE,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
COMMANDS = [line.partition("#")[0].strip() for line in SHELL.splitlines() if line.strip()]


@pytest.fixture(scope="module")
def desk(recorded, tmp_path_factory):
    """A folder with what the page speaks of."""
    folder = tmp_path_factory.mktemp("desk")
    for name in ("recordings", "before", "after"):
        shutil.copytree(recorded.box, folder / name)
    shutil.copy(recorded.bus, folder / "run.lcmlog")
    return folder


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_of_the_page_works_and_writes_what_it_says(desk, command):
    words = shlex.split(command)
    assert words[0] == "pilotfish"
    done = subprocess.run([sys.executable, "-m", *words], cwd=desk, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    if "--out" in words:
        assert (desk / words[words.index("--out") + 1]).exists()


def test_the_code_of_the_page_prints_a_run(desk):
    done = subprocess.run([sys.executable, "-c", CODE], cwd=desk, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    time_s, worst_mm = map(float, done.stdout.splitlines()[0].split())
    assert time_s > 2.5
    assert worst_mm > 100  # it begins 1.34 m too far
    assert " s  status: tracking" in done.stdout


def test_the_page_names_every_table():
    from pilotfish.logs import TABLES

    assert all(f"`{name}`" in PAGE for name in TABLES if name != "events")

"""``pilotfish identify`` on what the real programs record of themselves over LCM."""

from __future__ import annotations

import subprocess
import sys

import pytest
import yaml
from typer.testing import CliRunner

from pilotfish import data
from pilotfish.cli import app
from pilotfish.harness.over_lcm import run_over_lcm
from pilotfish.harness.ports import private_lcm_url
from pilotfish.harness.scenario import Scenario


@pytest.fixture(scope="module")
def box(tmp_path_factory):
    """Eight seconds behind a leader on a line, from too far away: the robot speeds up and slows down."""
    folder = tmp_path_factory.mktemp("identify")
    run_over_lcm(
        Scenario.load(data.path("scenarios/square.yaml")),
        profile="anticipate",
        duration_s=8.0,
        lcm_url=private_lcm_url(),
        coordinator_options=["--black-box", str(folder / "box")],
    )
    return folder / "box"


def identify(*words: object):
    return CliRunner().invoke(app, ["identify", *map(str, words)])


def test_the_drive_of_a_recorded_run_is_that_of_the_scenario(box, tmp_path):
    """The scenario has 33 ms and 100 ms, which are the defaults, too; what STATUS says stands beside."""
    done = identify(box, "-o", tmp_path / "drive.yaml", "--plot", tmp_path / "drive.png")
    assert done.exit_code == 0, done.output
    row = next(line for line in done.output.splitlines() if "control.drive.latency_s" in line)
    value, sigma = (float(word) for word in row.split("│")[2].split("+-"))
    assert abs(value - 1 / 30) < 5 * sigma < 0.03
    assert "0.03333 (default)" in row
    assert "+-" in row.split("│")[4]
    assert (tmp_path / "drive.png").read_bytes().startswith(b"\x89PNG")
    assert isinstance(yaml.safe_load((tmp_path / "drive.yaml").read_text()), dict)


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["--plot", "drive.gif"], 64, "ends in none of .png, .svg, .pdf"),
        (["--track-width-m", "9"], 64, "9.0 is not a number from 0.02 to 5 m"),
        (["--robot", "nobody"], 66, "no file of the black box of 'nobody'"),
    ],
)
def test_a_wrong_option_says_what_is_allowed(box, words, code, says):
    done = subprocess.run(
        [sys.executable, "-m", "pilotfish", "identify", str(box), *words], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == code
    assert says in " ".join(done.stderr.replace("│", " ").split())
    assert "Traceback" not in done.stderr

"""Whatever a command is given: one line that says what is wrong, and the exit code for it. Never a traceback, never a
wait without end."""

import re
import subprocess
import sys

import command_lines
import numpy as np
import pytest
from PIL import Image
from synthetic_run import exponential_run
from typer.testing import CliRunner

from logs.recordings import Writer
from pilotfish.cli import app

runner = CliRunner()
pytestmark = pytest.mark.usefixtures("small_pictures")
# 0: it does not mind. 1: `fuzzy check` found something. 2: the command line. The others are those of errors.py.
EXPECTED = {0, 1, 64, 65, 66, 70, 74, 78}
WITHIN_S = 60.0


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """What the command lines need: recordings, and a video in which there is nothing to see."""
    folder = tmp_path_factory.mktemp("here")
    exponential_run().to_csv(folder / "run.csv")
    (folder / "video").mkdir()
    for k in range(3):
        Image.fromarray(np.full((480, 640), 90, np.uint8)).save(folder / "video" / f"{k}.png")
    log = Writer(folder / "run.lcmlog")
    log.image(np.full((48, 64), 90, np.uint8))
    log.frame()
    return {"run": folder / "run.csv", "video": folder / "video", "log": log.file}


@pytest.mark.parametrize(
    ("command", "place", "wrong"),
    [pytest.param(*case, id=f"{case[0]}-{case[1]}-{case[2][:12] or 'nothing'}") for case in command_lines.cases()],
)
@pytest.mark.fault("bad_command_line_input")
def test_bad_input_ends_with_a_line_and_its_exit_code(tmp_path, here, command, place, wrong):
    words = command_lines.line(command, here, tmp_path, place, wrong)
    result = runner.invoke(app, words)
    assert result.exception is None or isinstance(result.exception, SystemExit), (
        f"{words}: {type(result.exception).__name__}: {result.exception}"
    )
    assert result.exit_code in EXPECTED
    if result.exit_code:
        said = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
        assert "Traceback" not in said
        # A box of typer's for the command line; else one line of ours.
        ours = [said_line for said_line in said.splitlines() if said_line.startswith("pilotfish: ")]
        assert result.exit_code in (1, 64) or len(ours) == 1, said
    if wrong == "where_nobody_can":
        assert result.exit_code == 74
        assert re.search(r"pilotfish: /proc/wrong[.a-z0-9]*: nothing can be written in /proc", said), said


def run_in_shell(words, shell):
    command = " ".join(f"'{word}'" for word in [sys.executable, "-m", "pilotfish", *words])
    return subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command} {shell}"],
        capture_output=True,
        text=True,
        timeout=WITHIN_S,
        check=False,
    )


PRINTING = {
    "help": ["--help"],
    "help of a command": ["tune", "--help"],
    "version": ["--version"],
    "fuzzy show": ["fuzzy", "show", command_lines.LAW],
    "experiment": ["experiment", "line", *command_lines.SHORT],
}


@pytest.mark.parametrize("words", PRINTING.values(), ids=PRINTING)
@pytest.mark.fault("bad_command_line_input")
def test_a_full_disk_under_standard_output_ends_with_74_and_one_line(words):
    done = run_in_shell(words, "> /dev/full")
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr
    assert done.stderr.strip().splitlines()[-1] == "pilotfish: cannot write: No space left on device"
    assert done.returncode == 74


@pytest.mark.parametrize("words", PRINTING.values(), ids=PRINTING)
def test_a_reader_that_has_seen_enough_is_no_error_to_speak_of(words):
    done = run_in_shell(words, "2> >(grep -a -e Traceback -e Error -e ignored >&2) | true")
    assert done.stderr == ""
    assert done.returncode in (0, 1, 141)  # 0: all had been written before the reader went


@pytest.mark.parametrize("closing", [">&-", "2>&-", "<&-", "<&- >&- 2>&-"])
def test_closed_streams_change_nothing_but_that_nobody_hears(tmp_path, closing):
    out = tmp_path / "law.fll"
    done = run_in_shell(["fuzzy", "convert", command_lines.LAW, out], closing)
    assert (done.returncode, done.stderr) == (0, "")
    assert out.read_text().startswith("Engine:")

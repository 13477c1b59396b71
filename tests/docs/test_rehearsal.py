"""docs/calibrating-a-camera.md, "Rehearse it without a camera": typed in this order, it prints what the page says."""

from __future__ import annotations

import re

import pytest

import page_commands
from pilotfish.harness.ports import private_lcm_url

PAGE, SECTION = "docs/calibrating-a-camera.md", "Rehearse it without a camera"
COMMANDS = page_commands.commands(PAGE, SECTION)
RESULTS = page_commands.blocks(PAGE, "text", SECTION)
pytest.importorskip("cv2")


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """What each command printed."""
    desk = page_commands.desk_in(tmp_path_factory.mktemp("rehearsal"), private_lcm_url())
    result = {}
    for command in COMMANDS:
        done = desk(command, timeout=300)
        assert done.returncode == 0, (command, done.stdout, done.stderr)
        result[command] = done.stdout
    return result


def test_each_calibration_of_the_page_is_rendered_first_and_has_a_printed_result():
    assert [command.split()[1] for command in COMMANDS[::2]] == ["render"] * 3
    assert [command.split()[1] for command in COMMANDS[1::2]] == ["calibrate", "calibrate", "learn-body"]
    assert len(RESULTS) == 3


@pytest.mark.parametrize("number", range(3))
def test_a_calibration_finds_what_was_rendered_as_the_page_says(said, number):
    printed, shown = said[COMMANDS[2 * number + 1]], RESULTS[number]
    assert shown.splitlines()[-1] in printed.splitlines()
    found, on_page = differences(printed), differences(shown)
    assert list(found) == list(on_page)
    for name, (off, allowed) in on_page.items():
        # The last digits are those of one machine's arithmetic.
        assert found[name][0] == pytest.approx(off, abs=0.1 * (allowed or 1.0)), name
        assert found[name][1] == allowed
        assert allowed is None or abs(off) <= allowed


@pytest.mark.parametrize("number", range(3))
def test_a_rendering_names_the_command_that_comes_next(said, number):
    """The page's has the calibration that was found instead of the true one."""
    (told,) = re.findall(r"^next, .*?: (.*)$", said[COMMANDS[2 * number]], re.MULTILINE)
    typed = re.sub(r"--camera \S+", "--camera CAMERA", COMMANDS[2 * number + 1])
    assert re.sub(r"--camera \S+", "--camera CAMERA", told) == typed


def differences(text):
    """Name -> (off, allowed) of a table's rows."""
    row = re.compile(
        r"^ +(\w[\w', ]*?) {2,}.*?([+-]?[\d.]+) (%|px|mm|°)(?: {2,}([\d.]+) (?:%|px|mm|°))? *$", re.MULTILINE
    )
    rows = text.partition("allowed")[2]
    return {name: (float(off), float(allowed) if allowed else None) for name, off, _, allowed in row.findall(rows)}

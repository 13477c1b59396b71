"""docs/tutorial.md from top to bottom, as far as no hardware is needed. A command that is not known here fails."""

from __future__ import annotations

import math
import re
import shlex
import sys
import urllib.request
from contextlib import ExitStack
from pathlib import Path

import pytest

import page_commands
from pilotfish import coordinator, data
from pilotfish.harness.child import Child
from pilotfish.harness.executables import find_executable
from pilotfish.harness.ports import private_lcm_url

ROOT = Path(__file__).parents[2]
COMMANDS = page_commands.commands("docs/tutorial.md")

# What each command is checked for; some stand on the page more than once.
CHECKS = {
    "scripts/setup": "readme",
    "scripts/build": "readme",
    ". .venv/bin/activate": "readme",
    "pilotfish doctor": "readme",
    "pilotfish tags --ids 0 --size 0.16 --out tag.pdf": "writes",
    "pilotfish view --camera 0 --tag-size 0.16": "camera",
    "pilotfish render line --out pictures --frames 90": "writes",
    "pilotfish view --camera images:pictures --tag-size 0.16 --fov-deg 56": "live pose",
    "pilotfish tags --board charuco --out board.pdf": "writes",
    "pilotfish calibrate camera camera:0 --board board.yaml --out camera.yaml": "calibration",
    "pilotfish view --camera 0 --tag-size 0.16 --camera-file camera.yaml": "camera",
    "pilotfish init robot1": "writes",
    "pilotfish doctor --config robot1/robot1.yaml": "machine",
    "pilotfish-coordinator --config robot1/robot1.yaml --source lcm": "program",
    "pilotfish-base --config robot1/base.yaml --driver simulator": "program",
    "pilotfish-sim --scenario data/scenarios/line.yaml --realtime --drive-by base --duration-s 120": "program",
    "pilotfish doctor --following robot1": "diagnosis",
    "pilotfish stop robot1": "operator",
    "pilotfish go robot1": "operator",
    "pilotfish top --once": "operator",
    "pilotfish tags --ids 0 --size 0.16 --position -0.20 0 0.25 --leader leader.yaml --out leader.pdf": "writes",
    "pilotfish leader check leader.yaml": "writes",
    "pilotfish-coordinator --config robot1/robot1.yaml": "camera",
    "pilotfish-base --config robot1/base.yaml --driver dry_run": "dry run",
    "pilotfish top": "screen",  # tests/top
    "pilotfish-base --config robot1/base.yaml --driver serial:/dev/ttyUSB0": "serial line",
}


def checked_as(kind: str) -> list[str]:
    """The page's commands of a kind, each once, in order."""
    return [command for command in dict.fromkeys(COMMANDS) if CHECKS[command] == kind]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the whole page is typed."""
    return tmp_path_factory.mktemp("tutorial")


@pytest.fixture(scope="module")
def url():
    return private_lcm_url()


@pytest.fixture(scope="module")
def desk(folder, url):
    run = page_commands.desk_in(folder, url)
    for command in checked_as("writes"):
        done = run(command)
        assert done.returncode == 0, (command, done.stderr)
    return run


def start(command: str, folder: Path, url: str, name: str) -> Child:
    """A program of the page that goes on until it is ended."""
    program, *words = shlex.split(command)
    found = [sys.executable, "-m", "pilotfish"] if program == "pilotfish" else [find_executable(program)]
    where = ["env", f"--chdir={folder}", f"LCM_DEFAULT_URL={url}"]
    return Child([*where, *found, *words], folder, name)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_of_the_tutorial_is_checked_below(command):
    assert command in CHECKS


def test_sheets_boards_pictures_and_files_are_where_the_page_says(desk, folder):
    for name in ("tag.pdf", "board.pdf", "board.yaml", "leader.pdf", "leader.yaml", "robot1/robot1.yaml"):
        assert (folder / name).stat().st_size > 50, name
    assert len(list((folder / "pictures").glob("*.png"))) == 90


def test_rendered_pictures_show_a_live_pose(desk, folder, url):
    (command,) = checked_as("live pose")
    with start(f"{command} --port 0", folder, url, "view") as view:
        view.wait_until(lambda: "Ctrl-C" in view.stdout(), 20.0, "being ready")
        with urllib.request.urlopen(view.stdout().split()[0], timeout=10) as page:
            assert b"<html" in page.read()


def test_56_degrees_are_the_rendered_cameras_field_of_view():
    """The width is seen under 2 atan(640 / (2 f)) with the shipped calibration's f."""
    camera = coordinator.load_calibration(data.path("calibrations/sim_640x480.yaml"))
    assert 2 * math.degrees(math.atan(camera.width / (2 * camera.fx))) == pytest.approx(56.0, abs=0.5)


def test_the_printed_board_calibrates_a_camera_that_sees_it(desk, folder):
    """Twenty rendered views of the board that the page prints, in place of a camera."""
    done = desk("pilotfish render board --board board.yaml --views 20 --out views")
    assert done.returncode == 0, done.stderr
    (command,) = checked_as("calibration")
    done = desk(command.replace("camera:0", "views"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert (folder / "camera.yaml").is_file()


def test_without_hardware_the_programs_say_what_is_missing(desk):
    if Path("/dev/video0").exists() or Path("/dev/ttyUSB0").exists():
        pytest.skip("this machine has a camera or a serial line; it would be used")
    for command in [*checked_as("camera"), *checked_as("serial line")]:
        done = desk(command)
        # --camera-file is read before the camera is opened: 78 if nobody has calibrated yet
        assert done.returncode == 69 or "camera.yaml" in done.stderr, (command, done.returncode, done.stderr)
        assert re.search(r"/dev/video0|camera|/dev/ttyUSB0", done.stderr), done.stderr


def test_the_doctor_reads_the_folders_configuration(desk):
    (command,) = checked_as("machine")
    done = desk(command)
    assert done.returncode in (0, 1), done.stderr
    assert "robot1 is free" in done.stdout


def test_the_robot_follows_is_stopped_and_goes_on_in_the_simulator(desk, folder, url):
    """The three terminals, and the fourth: with a shorter watch than the page's 10 s."""
    (diagnosis,) = checked_as("diagnosis")
    stop, go, top = checked_as("operator")
    with ExitStack() as terminals:
        eyes, *_ = [
            terminals.enter_context(start(command, folder, url, f"terminal{number}"))
            for number, command in enumerate(checked_as("program"))
        ]
        eyes.wait_until(lambda: "tracking" in eyes.stdout(), 30.0, "seeing its leader")
        for _ in range(6):  # real time: a busy machine loses pictures while the programs start
            done = desk(f"{diagnosis} --seconds 3")
            if done.returncode == 0:
                break
        assert (done.returncode, "robot1 follows" in done.stdout) == (0, True), done.stdout + done.stderr
        assert desk(stop).returncode == 0
        done = desk(f"{diagnosis} --seconds 3")
        assert done.returncode == 1, done.stdout
        assert "stop" in done.stdout
        assert "pilotfish resume robot1" in re.sub(r"\s+", " ", done.stdout)
        done = desk(go)
        assert done.returncode == 0, done.stderr
        assert "robot1: tracking" in done.stdout
        done = desk(top)
        assert done.returncode == 0, done.stderr
        assert "robot" in done.stdout


def test_the_dry_run_runs_until_it_is_ended(desk, folder, url):
    (command,) = checked_as("dry run")
    with start(command, folder, url, "base") as base:
        base.wait_until(lambda: base.stdout() + base.stderr() != "", 10.0, "its first line")
        assert base.process.poll() is None
        assert base.terminate() == 0


def test_pictures_of_the_tutorial_exist():
    text = (ROOT / "docs/tutorial.md").read_text()
    pictures = re.findall(r"!\[.+?\]\((.*?)\)", text)
    assert len(pictures) >= 3
    assert all((ROOT / "docs" / picture).is_file() for picture in pictures)

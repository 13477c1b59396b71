"""The README's commands and code blocks do what it says. A command that is not known here fails the test."""

import os
import re
import shutil
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import page_commands
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.harness.ports import private_lcm_url

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()
COMMANDS = page_commands.commands("README.md")
CODE = page_commands.blocks("README.md", "python")


@pytest.fixture
def desk(tmp_path):
    return page_commands.desk_in(tmp_path, private_lcm_url())


def test_the_readme_shows_commands_and_code():
    assert len(COMMANDS) >= 10
    assert CODE


@pytest.mark.parametrize("code", CODE)
def test_the_code_runs_and_prints_a_tracked_leader(code):
    import sys

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "tracking" in done.stdout


# What each command of the README is checked for. None: an existing program of LCM's, or one that other tests run.
CHECKS = {
    "scripts/setup": "script",
    "scripts/build": "script",
    ". .venv/bin/activate": "environment",  # made by scripts/setup, which CI has run
    "pilotfish tags --ids 0 --size 0.16 --out tag.pdf": "tag",
    "pilotfish view --camera 0 --tag-size 0.16": "live pose",
    "pilotfish init robot1": "folder",
    "pilotfish-coordinator --config robot1/robot1.yaml": "folder, no camera",
    "pilotfish doctor --following robot1": "nobody there",
    "pilotfish go robot1": "operator",
    "scripts/demo": "script",
    "scripts/test": "script",
    "pilotfish-coordinator --config data/config/coordinator.yaml --source camera:0": "no camera",
    "pilotfish-coordinator --config data/config/line.yaml": "real time",
    "pilotfish-sim --scenario data/scenarios/line.yaml --realtime": "real time",
    "pilotfish stop robot1": "operator",
    "pilotfish setpoint robot1 --distance-m 1.2 --bearing-deg -10": "operator",
    "pilotfish resume robot1": "operator",
    "pilotfish-spy": "program",
    "pilotfish doctor": "doctor",
    "lcm-logger run.log": "log",
    "lcm-logplayer run.log": "log",
    "pilotfish-coordinator --config data/config/line.yaml --source log:run.log --json": "log",
    "pilotfish learn-body turn.mp4 --camera camera.yaml --tag-size 0.16 --height-of 0=0.25 --output my_robot.yaml": (
        "your own film"  # run on rendered films in tests/calibration
    ),
    "pilotfish fuzzy show data/fuzzy/coordination.yaml": "law",
    "pilotfish fuzzy explain data/fuzzy/coordination.yaml --e -0.2 --ec 0.1": "law",
    "pilotfish experiment line --out out": "experiment",
    "pilotfish render data/scenarios/circle.yaml --out out/pictures --frames 30": "render",
    "pilotfish-coordinator --config data/config/circle.yaml --source images:out/pictures --lcm-url memq:// --json": (
        "render"
    ),
}


def commands_checked_as(kind):
    return [command for command in COMMANDS if CHECKS[command] == kind]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_checked_below(command):
    assert command in CHECKS


def test_the_scripts_can_be_executed():
    for command in commands_checked_as("script"):
        assert os.access(ROOT / command, os.X_OK)


def test_pictures_are_rendered_and_followed(desk):
    render, follow = commands_checked_as("render")
    done = desk(render)
    assert done.returncode == 0, done.stderr
    done = desk(follow)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count('"status":"tracking"') == 30


def test_a_tag_is_printed(desk, tmp_path):
    (command,) = commands_checked_as("tag")
    done = desk(command)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "tag.pdf").read_bytes().startswith(b"%PDF")


def test_without_a_camera_there_is_no_live_pose_and_it_says_so(desk):
    """With one: docs/tutorial.md's test, on pictures, and tests/view/test_view_camera.py, on a simulated camera."""
    (command,) = commands_checked_as("live pose")
    if Path("/dev/video0").exists():
        pytest.skip("this machine has a camera; it would be used")
    done = desk(command)
    assert done.returncode == 69
    assert "/dev/video0" in done.stderr


def test_a_robots_folder_is_made_and_its_coordinator_starts(desk):
    (init,) = commands_checked_as("folder")
    (start,) = commands_checked_as("folder, no camera")
    done = desk(init)
    assert done.returncode == 0, done.stderr
    if Path("/dev/video0").exists():
        pytest.skip("this machine has a camera; it would be used")
    done = desk(start)
    assert done.returncode == 69, done.stderr  # 78 would be a configuration that is not read
    assert "camera" in done.stderr


def test_the_doctor_misses_a_robot_that_is_not_there(desk):
    (command,) = commands_checked_as("nobody there")
    done = desk(f"{command} --seconds 1")
    assert done.returncode == 1, done.stderr
    assert "robot1 does not follow" in done.stdout


def test_the_law_is_shown_and_explained(desk):
    for command in commands_checked_as("law"):
        done = desk(command)
        assert done.returncode == 0, done.stderr
        assert "NZ" in done.stdout


def test_an_experiment_ends_with_a_table_and_pictures(desk, tmp_path):
    """With a shorter run than the README's; whole ones are in tests/python/test_experiments.py."""
    (command,) = commands_checked_as("experiment")
    done = desk(f"{command} --duration-s 3")
    assert done.returncode == 0, done.stderr
    assert "steady-state distance error" in done.stdout
    assert list((tmp_path / "out").glob("*.png"))


def test_the_doctor_has_a_verdict(desk):
    (command,) = commands_checked_as("doctor")
    done = desk(command)
    assert done.returncode in (0, 1), done.stderr
    assert "multicast route" in done.stdout


def test_without_a_camera_it_says_so(desk):
    (command,) = commands_checked_as("no camera")
    if Path("/dev/video0").exists():
        pytest.skip("this machine has a camera; it would be used")
    done = desk(command)
    assert done.returncode == 69
    assert "camera" in done.stderr


def test_an_operator_is_told_that_there_is_no_robot_on_this_bus(desk):
    """All at once: each waits some seconds. What they do to one that is there: tests/python/test_operating.py."""
    with ThreadPoolExecutor() as terminals:
        for done in terminals.map(desk, commands_checked_as("operator")):
            assert done.returncode == 69
            assert "no coordinator of robot1 answers" in done.stderr


def test_simulator_and_coordinator_meet_in_real_time_and_the_log_can_be_replayed(desk, tmp_path):
    """lcm-logger records the run that the README's two terminals show; the coordinator reads it back."""
    follow, play = commands_checked_as("real time")
    logger, player, replay = commands_checked_as("log")
    for program in (logger.split()[0], player.split()[0]):
        assert shutil.which(program)
    url = private_lcm_url()
    environment = {**os.environ, "LCM_DEFAULT_URL": url}
    quiet = {"cwd": tmp_path, "env": environment, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([shutil.which("lcm-logger"), f"--lcm-url={url}", "run.log"], **quiet) as recorder:
        with subprocess.Popen([find_executable(COORDINATOR), *follow.split()[1:]], **quiet) as coordinator:
            options = [*play.split()[1:], "--duration-s", "3"]
            done = subprocess.run([find_executable(SIM), *options], cwd=tmp_path, env=environment, timeout=60)
            assert done.returncode == 0
            coordinator.terminate()
            assert coordinator.wait(10) == 0
        deadline = time.monotonic() + 10.0
        while (tmp_path / "run.log").stat().st_size < 100_000 and time.monotonic() < deadline:
            time.sleep(0.05)
        recorder.terminate()
    done = desk(replay)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count('"status":"tracking"') >= 10


def test_pictures_in_the_readme_exist():
    for picture in re.findall(r"!\[.*?\]\((.*?)\)", README):
        assert (ROOT / picture).is_file(), picture


def test_links_in_the_readme_lead_somewhere():
    for target in re.findall(r"(?<!!)\[[^\]]*\]\(([^)#]+)[^)]*\)", README):
        assert (ROOT / target).exists(), target

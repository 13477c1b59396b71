"""The command line of `pilotfish view`: what is wrong is said in one line, with what to do and the right exit code."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time

import pytest
from typer.testing import CliRunner
from view_server import serving

from pilotfish import data
from pilotfish.cli import app


def run(*arguments):
    """In this process, as the command line does it."""
    return CliRunner().invoke(app, ["view", *map(str, arguments)], env={"COLUMNS": "300"})


CALIBRATION = data.path("calibrations/sim_640x480.yaml")
CASES = {
    "a camera without a tag's size": (["--camera", "0"], 64, "--tag-size"),
    "a tag without a size": (["--camera", "0", "--tag-size", "0"], 64, "0.005 to 5"),
    "a size that is no number": (["--camera", "0", "--tag-size", "nan"], 64, "0.005 to 5"),
    "a robot and a camera": (["robot1", "--camera", "0", "--tag-size", "0.1"], 64, "without a robot"),
    "two lenses": (
        ["--camera", "0", "--tag-size", "0.1", "--fov-deg", "60", "--camera-file", CALIBRATION],
        64,
        "--fov-deg",
    ),
    "a lens without a camera": (["--fov-deg", "60"], 64, "say --camera"),
    "a port that is none": (["--port", "70000"], 64, "65535"),
    "a name that is none": (["robot 1"], 64, "letters, digits"),
    "no such camera": (["--camera", "63", "--tag-size", "0.1"], 69, "/dev/video63"),
    "no such folder": (["--camera", "images:/nowhere", "--tag-size", "0.1"], 66, "/nowhere"),
    "no such video": (["--camera", "video:/nowhere.mp4", "--tag-size", "0.1"], 66, "/nowhere.mp4"),
    "another kind of source": (["--camera", "lcm", "--tag-size", "0.1"], 64, "images:DIR"),
    "a picture size that is none": (["--camera", "0", "--tag-size", "0.1", "--size", "big"], 64, "640x480"),
    "no such configuration": (["--config", "/nowhere.yaml"], 66, "/nowhere.yaml"),
    "a configuration that is none": (["--config", data.path("fuzzy/coordination.yaml")], 78, "fuzzy controller"),
    "no such controller": (["--fuzzy", "/nowhere.yaml"], 66, "/nowhere.yaml"),
    "no such key": (["--key", "/nowhere.key"], 66, "/nowhere.key"),
    "no such bus": (["--lcm-url", "nonsense"], 69, "udpm"),
    "a bus without datagrams": (["--lcm-url", "memq://"], 64, "udpm"),
    "another host's address": (["--host", "203.0.113.9"], 69, "0.0.0.0"),
    "no address": (["--host", "no such host"], 69, "--host"),
}


@pytest.mark.parametrize("case", CASES)
def test_what_is_wrong_is_said_in_a_line(case):
    arguments, code, said = CASES[case]
    ended = run(*arguments)
    assert ended.exit_code == code, ended.stderr
    assert said in ended.stderr


def test_a_port_that_is_taken_is_named():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        ended = run("robot1", "--port", taken.getsockname()[1])
        assert ended.exit_code == 69
        assert f"port {taken.getsockname()[1]}: another program listens there; choose another --port" in ended.stderr


def test_ctrl_c_ends_it_quietly(tmp_path, url):  # and SIGTERM every other server of these tests
    with serving(tmp_path, "--lcm-url", url) as server:
        server.child.process.send_signal(signal.SIGINT)
        assert server.child.process.wait(10) == 0
        assert server.child.stderr() == ""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("repeats", [2, 20])
def test_asked_again_while_it_ends_it_ends_as_quietly(tmp_path, url, number, repeats):
    """A finger that bounces, or a shell and a supervisor that both ask: within a few milliseconds."""
    with serving(tmp_path, "--lcm-url", url) as server:
        for _ in range(repeats):
            server.child.process.send_signal(number)
            time.sleep(0.002)
        code = server.child.process.wait(10)
        assert (code, server.child.stderr()) == (0, "")


def test_a_missing_package_is_named_with_the_command_that_installs_it(tmp_path):
    (tmp_path / "starlette.py").write_text(
        "raise ModuleNotFoundError(\"No module named 'starlette'\", name='starlette')"
    )
    environment = os.environ | {"PYTHONPATH": f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}"}
    command = [sys.executable, "-m", "pilotfish", "view"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=30, env=environment)
    assert ended.returncode == 69
    assert "pip install 'pilotfish[view]'" in ended.stderr

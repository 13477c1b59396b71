"""Programs that are started with closed standard streams, as some supervisors do: the numbers 0 to 2 must not go to a
socket, or what is meant for the console goes out on the bus."""

import os
import subprocess
import time
from pathlib import Path

import pytest

from pilotfish import data
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.harness.ports import private_lcm_url

ARGUMENTS = {
    COORDINATOR: ["--config", data.path("config/line.yaml")],
    SIM: ["--scenario", data.path("scenarios/line.yaml"), "--wait-s", "60"],
}
CLOSED = [(0,), (1,), (2,), (0, 1), (0, 1, 2)]
WITHIN_S = 60.0


def start(program, arguments, closed):
    def close():
        for number in closed:
            os.close(number)

    quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return subprocess.Popen([find_executable(program), *arguments], preexec_fn=close, **quiet)


def descriptors(process):
    """What each number stands for, once the bus is open."""
    folder, deadline = Path(f"/proc/{process.pid}/fd"), time.monotonic() + WITHIN_S
    while time.monotonic() < deadline and process.poll() is None:
        try:
            links = {int(entry.name): str(entry.readlink()) for entry in folder.iterdir()}
        except FileNotFoundError:  # one that was closed meanwhile
            continue
        if any(link.startswith("socket:") for link in links.values()):
            return links
        time.sleep(0.02)
    pytest.fail(f"the bus was not opened (exit code {process.poll()})")


@pytest.mark.parametrize("closed", CLOSED, ids=str)
@pytest.mark.parametrize("program", ARGUMENTS)
def test_no_socket_gets_the_number_of_a_closed_stream(program, closed):
    process = start(program, [*ARGUMENTS[program], "--lcm-url", private_lcm_url()], closed)
    try:
        links = descriptors(process)
        assert {number: links.get(number) for number in (0, 1, 2)} == dict.fromkeys((0, 1, 2), "/dev/null")
    finally:
        process.terminate()
        process.wait(WITHIN_S)


@pytest.mark.parametrize("closed", CLOSED, ids=str)
@pytest.mark.parametrize("program", ARGUMENTS)
def test_a_bad_configuration_still_ends_with_78_when_streams_are_closed(tmp_path, program, closed):
    option, *_ = ARGUMENTS[program]
    assert start(program, [option, tmp_path], closed).wait(WITHIN_S) == 78

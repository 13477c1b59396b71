"""A wrong command line of a C++ program: one line with its name and what may be meant, then where help is."""

import subprocess

import pytest

from pilotfish.harness.executables import BASE, COORDINATOR, SIM, find_executable

CASES = [
    # (program, arguments, what it says)
    (COORDINATOR, ["--sorce", "camera:0"], "--sorce is not an option; did you mean --source?"),
    (COORDINATOR, ["--simulated-tim"], "--simulated-tim is not an option; did you mean --simulated-time?"),
    (COORDINATOR, ["--colour=red"], "--colour=red is not an option"),
    (COORDINATOR, ["data/config/line.yaml"], "'data/config/line.yaml' needs --config in front of it"),
    (SIM, ["line.yml"], "'line.yml' needs --scenario in front of it"),
    (BASE, ["base.yaml", "--nmae", "robot1"], "--nmae is not an option; did you mean --name?"),
    (BASE, ["loud"], "'loud' is not expected here"),
    (COORDINATOR, [], "--config is required"),
    (COORDINATOR, ["--config", "x.yaml", "--source", "usb:0"], "--source: 'usb:0' is not a source"),
]


@pytest.mark.parametrize(("program", "arguments", "said"), CASES, ids=[" ".join(case[1]) or "-" for case in CASES])
def test_a_wrong_command_line_is_answered_with_what_may_be_meant(program, arguments, said):
    done = subprocess.run([find_executable(program), *arguments], check=False, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (64, "")
    assert done.stderr.startswith(f"{program}: {said}")

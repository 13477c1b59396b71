"""pilotfish-base between a coordinator (played here) and the simulator's wheels."""

import signal
import subprocess

import pytest
import yaml
from commander import Commander
from wheels_process import WheelsProcess

from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import SIM, find_executable
from pilotfish.lcmtypes.bot_core.pose_t import pose_t
from pilotfish.lcmtypes.pilotfish.base_t import base_t

SECONDS = 60.0  # longer than any of these tests


@pytest.fixture
def scenario(tmp_path):
    """line.yaml, where no setpoint need be sent."""
    folder = shipped.path("scenarios")
    scenario = yaml.safe_load((folder / "line.yaml").read_text())
    for robot in scenario["robots"]:
        robot.pop("setpoint", None)
        for part, key in (("body", "leader"), ("camera", "calibration"), (None, "coordinator")):
            place = robot.get(part, {}) if part else robot
            if key in place:
                place[key] = str((folder / place[key]).resolve())
    file = tmp_path / "scenario.yaml"
    file.write_text(yaml.safe_dump(scenario))
    return file


class Watched(Commander):
    """A commander that also knows the truth about robot1."""

    def __init__(self, url):
        super().__init__(url)
        self.truth = []
        self.bus.subscribe("ROBOT1_POSE", lambda _, data: self.truth.append(pose_t.decode(data)))

    def speed_mps(self):
        return self.truth[-1].vel[0] if self.truth else 0.0


@pytest.fixture
def driven(tmp_path, url, scenario):
    """(the base, a commander, with the simulator's wheels turning)"""
    command = [find_executable(SIM), "--scenario", scenario, "--lcm-url", url, "--realtime", "--drive-by", "base"]
    with (
        WheelsProcess(tmp_path, url, "simulator") as base,
        Child([*command, "--duration-s", str(SECONDS)], tmp_path, "sim"),
    ):
        commander = Watched(url)
        commander.simulated = True
        commander.drive_until(lambda: commander.speed_mps() > 0.25, "wheels that turn")
        yield base, commander


def test_the_simulated_wheels_do_what_the_base_says_and_stand_when_the_commands_end(driven):
    _, commander = driven
    assert commander.last.state == base_t.STATE_DRIVING
    assert not commander.last.measured
    commander.listen_until(lambda: abs(commander.speed_mps()) < 1e-3, "standing")
    assert commander.last.state == base_t.STATE_WAITING


def test_simulated_wheels_of_which_no_base_says_anything_stand_still(driven):
    """As a motor controller's do: the base is stopped while it says 'drive', and the commands go on."""
    base, commander = driven
    base.process.send_signal(signal.SIGSTOP)
    commander.drive_until(lambda: abs(commander.speed_mps()) < 1e-3, "standing")
    base.process.send_signal(signal.SIGCONT)
    commander.drive_until(lambda: commander.speed_mps() > 0.25, "driving again")


def test_a_stop_holds_the_simulated_wheels(driven):
    _, commander = driven
    commander.setpoint(run=False)
    commander.drive_until(lambda: abs(commander.speed_mps()) < 1e-3, "standing in spite of commands")
    assert commander.last.stopped


def test_a_base_needs_the_clock(scenario):
    command = [find_executable(SIM), "--scenario", scenario, "--drive-by", "base"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30)
    assert done.returncode == 64
    assert "--realtime" in done.stderr

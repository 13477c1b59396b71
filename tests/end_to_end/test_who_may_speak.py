"""The real coordinator, operators with and without its key, and recordings of what they said."""

import subprocess

import pytest
import yaml
from onboard import LINE_CONFIG, Onboard

from pilotfish import bus
from pilotfish.errors import OperatorError
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.operating import Operator, new_key

SHORT_S = 1.0


def config_with_key(folder):
    content = yaml.safe_load(LINE_CONFIG.read_text())
    for place, key in ((content["camera"], "calibration"), (content, "leader"), (content, "fuzzy")):
        place[key] = str((LINE_CONFIG.parent / place[key]).resolve())
    file = folder / "robot.yaml"
    file.write_text(yaml.safe_dump(content | {"key_file": "robot.key"}))  # relative to the file
    return file


def test_anyone_stops_the_robot_and_only_who_has_the_key_lets_it_go_on(tmp_path):
    new_key(tmp_path / "robot.key")
    with Onboard(tmp_path, config=config_with_key(tmp_path)) as onboard:
        stranger = Operator("robot1", lcm_url=onboard.url)
        assert not stranger.stop().setpoint.run
        with pytest.raises(OperatorError, match="its key is not yours"):
            stranger.resume(SHORT_S)
        owner = Operator("robot1", lcm_url=onboard.url, key_file=tmp_path / "robot.key")
        assert owner.resume().setpoint.run
        assert owner.set_setpoint(distance_m=1.5, bearing_rad=0.1).setpoint.distance_m == 1.5
        with pytest.raises(OperatorError, match="below its stop distance"):
            owner.set_setpoint(distance_m=0.1, bearing_rad=0.0, within_s=SHORT_S)


def test_what_an_operator_said_is_not_accepted_a_second_time_nor_by_the_next_run(tmp_path):
    recorded = []

    def play_back(onboard):
        refused = stranger_status(onboard).rejected
        before = sum(count for name, count in refused.items() if name.startswith("setpoint_"))
        for data in recorded:
            onboard.bus.publish("ROBOT1_SETPOINT", data)
        operator = Operator("robot1", lcm_url=onboard.url)
        for _ in range(200):
            rejected = operator.listen().rejected
            if sum(count for name, count in rejected.items() if name.startswith("setpoint_")) >= before + len(recorded):
                return operator.status, rejected
        raise AssertionError(f"{len(recorded)} messages played back, {before} refused before, now {rejected}")

    def stranger_status(onboard):
        return Operator("robot1", lcm_url=onboard.url).listen()

    with Onboard(tmp_path) as onboard:
        tape = onboard.bus.subscribe("ROBOT1_SETPOINT", lambda _, data: recorded.append(data))
        operator = Operator("robot1", lcm_url=onboard.url)
        operator.set_setpoint(distance_m=1.5, bearing_rad=0.1)
        onboard.listen_until(lambda: len(recorded) == operator.sent, "all that the operator said")
        onboard.bus.unsubscribe(tape)
        operator.stop()
        status, rejected = play_back(onboard)
        assert not status.setpoint.run
        assert rejected["setpoint_replayed"] >= len(recorded)
    with Onboard(tmp_path) as onboard:  # a new session
        status, rejected = play_back(onboard)
        assert status.setpoint.distance_m == 1.1
        assert rejected["setpoint_wrong_session"] == len(recorded)


def test_a_key_that_others_may_read_starts_nothing(tmp_path):
    new_key(tmp_path / "robot.key")
    (tmp_path / "robot.key").chmod(0o640)
    command = [find_executable(COORDINATOR), "--config", config_with_key(tmp_path), "--lcm-url", "nonsense://"]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 78  # and not 69: the bus has not been tried
    assert "key_file: " in done.stderr
    assert "chmod 600" in done.stderr


def test_its_commands_carry_a_mac_that_only_this_key_makes(tmp_path):
    new_key(tmp_path / "robot.key")
    new_key(tmp_path / "other.key")
    with Onboard(tmp_path, config=config_with_key(tmp_path)) as onboard:
        caught = []
        onboard.bus.subscribe("ROBOT1_COMMAND", lambda _, data: caught.append(data))
        onboard.listen_until(lambda: len(caught) >= 3, "three commands")
    for data in caught:
        macs = [
            bus.message_mac(bus.load_key(str(tmp_path / f"{k}.key")), "ROBOT1_COMMAND", data)
            for k in ("robot", "other")
        ]
        assert [data[-32:] == mac for mac in macs] == [True, False]

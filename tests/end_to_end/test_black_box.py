"""The black box of the real program: recorded while it drives, replayed bit for bit."""

from __future__ import annotations

import signal
import subprocess
import sys

import lcm
import pytest
from real_time_robot import Robot, moves, noisy_gray

from pilotfish.harness.ports import private_lcm_url


def replay(folder, *options):
    command = [sys.executable, "-m", "pilotfish", "replay", str(folder), "--assert", *options]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def recorded_drive(tmp_path, stop):
    box = tmp_path / "box"
    with Robot(tmp_path, "--black-box", str(box)) as robot:
        robot.follow(20)
        for k in range(8):
            robot.show(noisy_gray(k))
        robot.follow(10)
        robot.send_setpoint(1.3, 0.0, True)
        robot.follow(10)
        robot.send_setpoint(1.3, 0.0, False)
        robot.show_leader(5)
        robot.child.process.send_signal(stop)
        robot.child.process.wait(10)
        sent = len(robot.commands)
        assert any(moves(c) for c in robot.commands)
    return box, sent


@pytest.mark.parametrize("stop", [signal.SIGTERM, signal.SIGKILL])
def test_every_command_of_a_drive_is_recomputed_bit_for_bit_also_after_a_kill(tmp_path, stop):
    box, sent = recorded_drive(tmp_path, stop)
    done = replay(box)
    assert done.returncode == 0, done.stdout + done.stderr
    compared = next(line for line in done.stdout.splitlines() if "commands sent compared" in line)
    assert int(compared.split("│")[2]) >= sent - 10  # of the last ones a kill may have lost some


def test_a_replay_says_nothing_on_a_bus(tmp_path, monkeypatch):
    box, _ = recorded_drive(tmp_path, signal.SIGTERM)
    url = private_lcm_url()
    monkeypatch.setenv("LCM_DEFAULT_URL", url)
    received = []
    listener = lcm.LCM(url)
    listener.subscribe(".*", lambda channel, _: received.append(channel))
    assert replay(box).returncode == 0
    while listener.handle_timeout(200):
        pass
    assert received == []

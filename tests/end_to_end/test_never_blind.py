"""The one rule, with the real program in real time: nothing moves without a fresh, checked measurement.

What is asserted is what left the program: which commands, how many, in which order. bench/safety measures how fast.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import signal
import subprocess
import time

import pytest
from real_time_robot import PERIOD_US, PICTURES, Robot, moves, noisy_gray

from pilotfish import core
from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import SIM, find_executable
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t


@pytest.mark.fault("stamps_backward")
def test_stamps_that_run_backward_on_gray_pictures_move_nothing(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        utime = robot.now_us()
        for k in range(1, 15):
            robot.show(noisy_gray(k), utime - k * PERIOD_US)
        first = len(robot.commands)
        for k in range(15, 60):
            robot.show(noisy_gray(k), utime - k * PERIOD_US)
        assert len(robot.commands) - first > 30
        assert not any(moves(c) for c in robot.commands[first:])


@pytest.mark.fault("recorded_pictures")
@pytest.mark.parametrize("days", [0.04, 2, 40])
def test_a_recording_of_any_age_drives_nobody(tmp_path, days):
    """As lcm-logplayer sends it: its pictures have the dates of their exposure."""
    with Robot(tmp_path) as robot:
        old_us = time.time_ns() // 1000 - round(days * 86_400e6) - robot.now_us()
        robot.clock_shift_us += old_us
        for k in range(45):
            robot.show(PICTURES[k].image)
        assert len(robot.commands) > 30
        assert not any(moves(c) for c in robot.commands)


@pytest.mark.fault("second_source")
def test_a_camera_on_this_hosts_clock_is_not_replaced_while_it_is_silent(tmp_path):
    with Robot(tmp_path) as robot:
        robot.clock_shift_us = 0
        robot.follow()
        own_us = robot.now_us()
        for k in range(60):  # two seconds of pictures of which nothing is known
            robot.show(PICTURES[k % 60].image, 7_000_000 + robot.now_us() - own_us)
        assert not any(moves(c) for c in robot.commands[-40:])
        first = len(robot.commands)
        robot.show_leader(5)
        assert any(moves(c) for c in robot.commands[first:])


@pytest.mark.fault("wild_stamp")
def test_one_wild_stamp_stops_nobody(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        epochs = robot.status().clock_epochs
        robot.send_image(core.Frame(noisy_gray(0), utime=2**61))
        first = len(robot.commands)
        robot.follow(30)
        assert robot.tracked_since(first) >= 20
        assert robot.status().clock_epochs == epochs


@pytest.mark.fault("stamps_wrong_unit")
def test_stamps_in_milliseconds_are_refused_and_a_leader_that_has_gone_moves_nothing(tmp_path):
    with Robot(tmp_path) as robot:
        for k in range(20):
            robot.show(PICTURES[k].image, robot.now_us() // 1000)
        assert "too old" in robot.commands[-1].text
        assert not robot.moving_after()


@pytest.mark.fault("clock_set")
@pytest.mark.parametrize("shift_us", [-3_600_000_000, 3_600_000_000])
def test_a_clock_that_is_set_by_an_hour_is_followed_again_from_rest(tmp_path, shift_us):
    with Robot(tmp_path) as robot:
        robot.clock_shift_us = 10_000_000_000  # no stamp is below 0
        robot.follow()
        epochs = robot.status().clock_epochs
        first = len(robot.commands)
        robot.clock_shift_us += shift_us
        robot.follow(50)  # a second until it is accepted
        statuses = [c.status for c in robot.commands[first:]]
        assert command_t.STATUS_INVALID_INPUT in statuses
        assert statuses[-1] == command_t.STATUS_TRACKING
        assert robot.status().clock_epochs == epochs + 1


@pytest.mark.fault("simulator_twice", "simulator_killed")
def test_a_simulator_that_dies_stops_the_robot_and_a_second_one_is_followed_from_rest(tmp_path):
    scenario = shipped.path("scenarios/line.yaml")
    with Robot(tmp_path) as robot:
        for run in range(2):
            command = [find_executable(SIM), "--scenario", scenario, "--realtime", "--lcm-url", robot.url]
            with Child(command, tmp_path, f"sim{run}") as sim:
                robot.listen_until(lambda: sum(moves(c) for c in robot.commands) > 40, "moving", 30)
                sim.process.send_signal(signal.SIGKILL)
                sim.process.wait()
            assert not robot.moving_after()
            robot.commands.clear()


@pytest.mark.fault("late_frames", "process_stopped")
def test_after_a_second_of_being_stopped_the_first_command_is_zero_and_pictures_from_before_move_nothing(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        robot.child.process.send_signal(signal.SIGSTOP)
        robot.show_leader(30)  # they wait in the kernel
        first = len(robot.commands)
        robot.child.process.send_signal(signal.SIGCONT)
        robot.listen_until(lambda: len(robot.commands) > first + 10, "commands")
        assert not moves(robot.commands[first])
        # The pictures of the last 100 ms before it went on are young enough; all others are not.
        assert sum(c.status == command_t.STATUS_TRACKING for c in robot.commands[first:]) <= 4


@pytest.mark.fault("camera_frozen")
def test_a_camera_that_repeats_its_picture_moves_nothing(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        for _ in range(15):
            robot.show(PICTURES[0].image)
        first = len(robot.commands)
        for _ in range(25):
            robot.show(PICTURES[0].image)
        frozen = robot.commands[first:]
        assert len(frozen) > 15 and not any(moves(c) for c in frozen)
        assert any("the same pixels" in c.text for c in frozen)
        robot.follow(10)


@pytest.mark.fault("picture_of_another_size")
def test_pictures_of_another_size_are_refused_before_they_are_decoded(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        first = len(robot.commands)
        for _ in range(20):
            false_image = image_t()
            false_image.utime, false_image.width, false_image.height, false_image.row_stride = (
                robot.now_us(),
                4096,
                4096,
                4096,
            )
            false_image.pixelformat = 1196444237  # MJPEG; its bytes are no JPEG at all, which is not detected
            false_image.data = bytes(1000)
            false_image.size = 1000
            robot.bus.publish("ROBOT1_IMAGE", false_image.encode())
            robot.pass_a_period()
        assert any("size is not the calibration's" in c.text for c in robot.commands[first:])
        assert not moves(robot.commands[-1])


# --- processes -------------------------------------------------------------------------------------------------------


@pytest.mark.fault("signals")
@pytest.mark.parametrize(
    "name", ["SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGINT", "SIGTERM", "SIGALRM", "SIGPROF", "SIGRTMIN"]
)
def test_every_signal_that_asks_for_an_end_leaves_zeros_behind(tmp_path, name):
    with Robot(tmp_path) as robot:
        robot.follow(10)
        robot.child.process.send_signal(getattr(signal, name))
        assert robot.child.process.wait(10) == 0
        robot.listen_until(lambda: robot.commands[-1].status == command_t.STATUS_STOPPED, "the last command")
        assert not moves(robot.commands[-1])


@pytest.mark.fault("crash")
@pytest.mark.parametrize("name", ["SIGSEGV", "SIGABRT", "SIGBUS", "SIGFPE", "SIGILL"])
def test_a_crash_leaves_a_zero_behind_that_outranks_every_other_command_of_the_session(tmp_path, name):
    with Robot(tmp_path) as robot:
        robot.follow(10)
        robot.child.process.send_signal(getattr(signal, name))
        assert robot.child.process.wait(10) == -getattr(signal, name)
        robot.listen_until(lambda: robot.commands[-1].counter == 2**63 - 1, "the final message")
        assert not moves(robot.commands[-1])
        assert "the program failed" in robot.commands[-1].text


@pytest.mark.fault("terminal_blocked")
@pytest.mark.parametrize("blocked", ["stdout", "stderr", "both"])
def test_a_terminal_that_does_not_read_holds_up_neither_commands_nor_the_end(tmp_path, blocked):
    robot = Robot(tmp_path)
    robot.child.terminate()
    read_end, write_end = os.pipe()
    with contextlib.suppress(OSError):
        fcntl.fcntl(write_end, 1031, 4096)  # F_SETPIPE_SZ: full after one page
    files = {name: (write_end if blocked in (name, "both") else subprocess.DEVNULL) for name in ("stdout", "stderr")}
    process = subprocess.Popen(robot.child.command, **files)
    try:
        robot.listen_until(lambda: len(robot.commands) > 3, "commands", 20)
        for _ in range(5):  # JSON lines for several pages, and a log line at each change
            robot.follow(12)
            for k in range(8):
                robot.show(noisy_gray(k))
        first = len(robot.commands)
        robot.follow(30)
        assert robot.tracked_since(first) >= 20
        process.terminate()
        assert process.wait(10) == 0
        robot.listen_until(lambda: robot.commands[-1].status == command_t.STATUS_STOPPED, "zeros")
    finally:
        process.kill()
        process.wait()
        os.close(read_end)
        os.close(write_end)

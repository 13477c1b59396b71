"""The one rule, with the real program in real time: nothing moves without a fresh, checked measurement.

Pictures come at 30 Hz over LCM, with stamps of a clock of their own. What is asserted is what left the program: which
commands, how many, in which order. How fast is measured by bench/safety.
"""

from __future__ import annotations

import contextlib
import os
import random
import re
import signal
import socket
import struct
import subprocess
import time

import lcm
import numpy as np
import pytest
from onboard import LINE_CONFIG, Onboard

from pilotfish import bus, core
from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t
from scenes import PERIOD_US, leader_pictures

PICTURES = leader_pictures(60)
GRAY = np.full((480, 640), 128, np.uint8)
PERIOD_S = PERIOD_US * 1e-6
PATIENCE_S = 0.4  # four times the age limit: what still moves then moves blindly, on however slow a machine


def noisy_gray(seed):
    """Without a leader, and different each time, as a sensor's picture is."""
    return (GRAY + np.random.default_rng(seed).integers(-3, 4, GRAY.shape)).astype(np.uint8)


def moves(command):
    return (command.linear_mps, command.angular_radps) != (0.0, 0.0)


class Robot(Onboard):
    """A coordinator in real time, and a camera that one can be mean with."""

    def __init__(self, folder, *options, **keywords):
        super().__init__(folder, *options, simulated=False, **keywords)
        self.sent = 0
        self.clock_shift_us = 0
        self.next_s = None

    def now_us(self):
        """The camera's clock, which is not this host's: somebody may set it."""
        return time.monotonic_ns() // 1000 + self.clock_shift_us

    def show(self, image, utime=None):
        """One picture, exposed now unless it says otherwise; then a period of the camera's 30 Hz passes."""
        self.send_image(core.Frame(image, utime=self.now_us() if utime is None else utime))
        self.pass_a_period()

    def pass_a_period(self):
        start_s = time.monotonic()
        self.next_s = max((self.next_s or start_s) + PERIOD_S, start_s)
        while (left_s := self.next_s - time.monotonic()) > 0:
            self.bus.handle_timeout(max(int(left_s * 1e3), 1))

    def show_leader(self, frames):
        for _ in range(frames):
            self.show(PICTURES[self.sent % len(PICTURES)].image)
            self.sent += 1

    def follow(self, frames=20):
        """Drives behind the leader. The test tests nothing unless the robot moves."""
        first = len(self.commands)
        self.show_leader(frames)
        assert any(moves(c) for c in self.commands[first:]), self.child.error("it never moved")

    def tracked_since(self, first):
        return sum(c.status == command_t.STATUS_TRACKING for c in self.commands[first:])

    def moving_after(self, patience_s=PATIENCE_S, for_s=0.5):
        """The commands that still move the robot when `patience_s` have passed."""
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            self.bus.handle_timeout(10)
        first = len(self.commands)
        end = time.monotonic() + for_s
        while time.monotonic() < end or len(self.commands) - first < 5:
            assert time.monotonic() < end + 10, self.child.error("it fell silent")
            self.bus.handle_timeout(10)
        return [c for c in self.commands[first:] if moves(c)]

    def status(self):
        """The next status_t."""
        heard = []
        subscription = self.bus.subscribe(
            f"{self.robot.upper()}_STATUS", lambda _, data: heard.append(status_t.decode(data))
        )
        self.listen_until(lambda: bool(heard), "a status")
        self.bus.unsubscribe(subscription)
        return heard[-1]


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
        robot.follow(25)
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
            lie = image_t()
            lie.utime, lie.width, lie.height, lie.row_stride = robot.now_us(), 4096, 4096, 4096
            lie.pixelformat = 1196444237  # MJPEG; its bytes are no JPEG at all, which nobody finds out
            lie.data = bytes(1000)
            lie.size = 1000
            robot.bus.publish("ROBOT1_IMAGE", lie.encode())
            robot.pass_a_period()
        assert any("size is not the calibration's" in c.text for c in robot.commands[first:])
        assert not moves(robot.commands[-1])


# --- processes -------------------------------------------------------------------------------------------------------


@pytest.mark.fault("signals")
@pytest.mark.parametrize("name", ["SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGINT", "SIGTERM", "SIGALRM"])
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
        robot.listen_until(lambda: robot.commands[-1].counter == 2**63 - 1, "the last words")
        assert not moves(robot.commands[-1])
        assert "the program failed" in robot.commands[-1].text


@pytest.mark.fault("terminal_blocked")
@pytest.mark.parametrize("blocked", ["stdout", "stderr", "both"])
def test_a_terminal_that_does_not_read_holds_up_neither_commands_nor_the_end(tmp_path, blocked):
    robot = Robot(tmp_path)
    robot.child.terminate()
    read_end, write_end = os.pipe()
    with contextlib.suppress(OSError):
        import fcntl

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


# --- who may speak ---------------------------------------------------------------------------------------------------


def forged_command(session, linear_mps=0.3):
    message = command_t()
    message.session, message.counter = session, 1
    message.linear_mps, message.text, message.mac = linear_mps, "", bytes(32)
    return message.encode()


@pytest.mark.fault("second_coordinator")
def test_a_second_coordinator_of_the_same_name_does_not_start(tmp_path):
    with Robot(tmp_path) as robot:
        second = [find_executable(COORDINATOR), "--config", str(LINE_CONFIG), "--lcm-url", robot.url]
        done = subprocess.run([str(word) for word in second], capture_output=True, text=True, timeout=30)
        assert done.returncode == 69
        assert "another coordinator" in done.stderr and "robot1" in done.stderr


@pytest.mark.fault("second_coordinator")
def test_while_somebody_else_commands_the_robot_it_sends_zeros_and_says_why(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        own = robot.commands[-1].session
        for _ in range(30):
            robot.bus.publish("ROBOT1_COMMAND", forged_command(session=4711))
            robot.show_leader(1)
        mine = [c for c in robot.commands[-20:] if c.session == own]
        assert mine and not any(moves(c) for c in mine)
        assert "another coordinator" in mine[-1].text
        # A second after the last of them it goes on.
        robot.show_leader(45)
        assert moves(robot.commands[-1])


@pytest.mark.fault("stop_latched", "forged_setpoint", "setpoint_too_near")
def test_after_a_stranger_s_stop_only_a_resume_of_this_session_moves_the_robot(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        session = robot.commands[-1].session

        def say(run, session, counter, distance_m=1.1):
            setpoint = core.Setpoint(distance_m=distance_m, run=run)
            report = bus.SetpointReport(utime=0, session=session, counter=counter, setpoint=setpoint)
            other = bus.Bus(robot.url)
            other.publish_setpoint("robot1", report)

        def drives():
            robot.show_leader(12)
            return moves(robot.commands[-1])

        say(False, session=0, counter=0)
        assert not drives()
        say(True, session=4711, counter=10)  # another session's
        assert not drives()
        say(True, session=session, counter=5, distance_m=0.3)  # there the robots would touch
        assert not drives()
        say(True, session=session, counter=6)
        assert drives()
        say(False, session=0, counter=0)
        assert not drives()
        say(True, session=session, counter=6)  # a replay
        assert not drives()
        say(True, session=session, counter=7)
        assert drives()
        rejected = {each.name: each.count for each in robot.status().rejected}
        assert rejected["setpoint_wrong_session"] == 1
        assert rejected["setpoint_replayed"] == 1 and rejected["setpoint_too_near"] == 1


@pytest.mark.fault("played_back_commands")
def test_a_recorded_log_played_back_on_the_live_bus_resumes_and_drives_nothing(tmp_path):
    with Robot(tmp_path) as robot:
        recorded = []
        everything = robot.bus.subscribe(".*", lambda channel, data: recorded.append((channel, bytes(data))))
        robot.follow()
        robot.send_setpoint(1.5, 0.0, True)
        robot.moving_after(0.1, 0.1)
        robot.bus.unsubscribe(everything)
    assert {"ROBOT1_COMMAND", "ROBOT1_SETPOINT"} <= {channel for channel, _ in recorded}
    with Robot(tmp_path) as robot:  # another day: a new session
        robot.send_setpoint(1.1, 0.0, False)
        player = lcm.LCM(robot.url)
        for channel, data in recorded:
            if not channel.endswith("IMAGE"):
                player.publish(channel, data)
        sessions = {command_t.decode(data).session for channel, data in recorded if channel.endswith("COMMAND")}
        robot.listen_until(lambda: len([c for c in robot.commands if c.session not in sessions]) > 20, "commands")
        assert not any(moves(c) for c in robot.commands if c.session not in sessions)
        assert not robot.status().setpoint_run and robot.status().setpoint_distance_m == pytest.approx(1.1)


@pytest.mark.fault("replayed_log")
def test_a_replay_stays_off_the_live_bus_unless_it_is_asked_for(tmp_path):
    url = private_lcm_url()
    log = lcm.EventLog(str(tmp_path / "run.log"), "w")
    for picture in PICTURES[:10]:
        message = image_t()
        message.utime, message.width, message.height, message.row_stride = picture.utime, 640, 480, 640
        message.pixelformat, message.data = 1497715271, picture.image.tobytes()
        message.size = len(message.data)
        log.write_event(picture.utime, "ROBOT1_IMAGE", message.encode())
    log.close()
    heard = []
    listener = lcm.LCM(url)
    listener.subscribe("ROBOT1_COMMAND", lambda _, data: heard.append(command_t.decode(data)))
    command = [str(find_executable(COORDINATOR)), "--config", str(LINE_CONFIG), "--source", f"log:{tmp_path}/run.log"]

    def replay(*options):
        environment = os.environ | {"LCM_DEFAULT_URL": url}
        done = subprocess.run([*command, *options], capture_output=True, text=True, timeout=60, env=environment)
        while listener.handle_timeout(300):
            pass
        return done

    assert replay("--json").returncode == 0
    assert heard == []
    refused = replay("--lcm-url", url)
    assert refused.returncode == 64 and "--live" in refused.stderr
    assert heard == []
    assert replay("--live").returncode == 0
    assert any(moves(c) for c in heard) and all(c.simulated for c in heard), "real wheels do not obey these"


# --- floods ----------------------------------------------------------------------------------------------------------


@pytest.mark.fault("setpoint_flood")
def test_a_flood_of_setpoints_neither_stops_the_commands_nor_fills_the_log(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        session = robot.commands[-1].session
        sender = bus.Bus(robot.url)
        first = len(robot.commands)
        for k in range(1, 31):
            for i in range(200):
                setpoint = core.Setpoint(distance_m=1.1 + 0.001 * ((k + i) % 2), run=True)
                report = bus.SetpointReport(utime=0, session=session, counter=k * 1000 + i, setpoint=setpoint)
                sender.publish_setpoint("robot1", report)
            robot.show_leader(1)
        assert len(robot.commands) - first >= 20
        lines = [line for line in robot.child.stderr().splitlines() if "setpoint" in line]
        assert len(lines) < 60, f"{len(lines)} lines for 6000 setpoints"


@pytest.mark.fault("image_flood")
def test_a_flood_of_pictures_does_not_silence_the_commands(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        flood = lcm.LCM(robot.url)
        small, big = image_t(), image_t()
        for message, side, data in [(small, (640, 480), noisy_gray(0).tobytes()), (big, (4096, 4096), bytes(60_000))]:
            message.width, message.height, message.row_stride = side[0], side[1], side[0]
            message.pixelformat = 1497715271 if message is small else 1196444237
            message.data, message.size = data, len(data)
        first = len(robot.commands)
        start_s = time.monotonic()
        for k in range(600):
            message = small if k % 3 else big
            message.utime = robot.now_us()
            flood.publish("ROBOT1_IMAGE", message.encode())
            robot.bus.handle_timeout(0)
        took_s = time.monotonic() - start_s
        robot.listen_until(lambda: len(robot.commands) - first >= took_s * 10, "a command every 100 ms at least", 5)
        assert not robot.moving_after()


@pytest.mark.fault("random_datagrams")
def test_random_bytes_on_the_port_stop_nothing(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow()
        port = int(re.search(r":(\d+)", robot.url.split("//")[1])[1])
        group = robot.url.split("//")[1].split(":")[0]
        rng = random.Random(1)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            for _ in range(3000):
                magic = rng.choice([b"", b"LC02", b"LC03", struct.pack(">I", 0x4C433033)])
                sender.sendto(magic + rng.randbytes(rng.randrange(0, 200)), (group, port))
        first = len(robot.commands)
        robot.follow(20)
        assert robot.tracked_since(first) >= 10


@pytest.mark.fault("cpu_starved")
def test_with_four_busy_processes_zeros_still_come_when_pictures_stop(tmp_path):
    busy = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(4)]
    try:
        with Robot(tmp_path) as robot:
            for _ in range(3):
                robot.follow(30)
                assert not robot.moving_after()
    finally:
        for process in busy:
            process.kill()
            process.wait()

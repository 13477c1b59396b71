"""Who may command, and the effect of a flood of messages, with the real program in real time."""

from __future__ import annotations

import os
import random
import re
import socket
import struct
import subprocess
import time

import lcm
import pytest
from onboard import LINE_CONFIG
from real_time_robot import PICTURES, Robot, moves, noisy_gray

from pilotfish import bus, core
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t


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
def test_while_another_sender_commands_the_robot_it_sends_zeros_and_says_why(tmp_path):
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
    received = []
    listener = lcm.LCM(url)
    listener.subscribe("ROBOT1_COMMAND", lambda _, data: received.append(command_t.decode(data)))
    command = [str(find_executable(COORDINATOR)), "--config", str(LINE_CONFIG), "--source", f"log:{tmp_path}/run.log"]

    def replay(*options):
        environment = os.environ | {"LCM_DEFAULT_URL": url}
        done = subprocess.run([*command, *options], capture_output=True, text=True, timeout=60, env=environment)
        while listener.handle_timeout(300):
            pass
        return done

    assert replay("--json").returncode == 0
    assert received == []
    refused = replay("--lcm-url", url)
    assert refused.returncode == 64 and "--live" in refused.stderr
    assert received == []
    assert replay("--live").returncode == 0
    assert any(moves(c) for c in received) and all(c.simulated for c in received), "real wheels do not obey these"


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
        # This receiver has had the flood, too: it has caught up when it has an answer to a picture shown since.
        sent_utime = robot.now_us()
        for _ in range(300):
            robot.show_leader(1)
            if robot.commands[-1].utime >= sent_utime:
                break
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

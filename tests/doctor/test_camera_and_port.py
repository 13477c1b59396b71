"""The camera that a configuration names, the bus's port, processors and tools: on made machines, and on this one."""

import os
import socket
import subprocess
from pathlib import Path

import pytest

from pilotfish.doctor import Host, Verdict, camera, network, ports, system, tools
from pilotfish.doctor.camera import Measured, Mode
from pilotfish.doctor.following.setup import Setup
from pilotfish.harness.ports import free_udp_port

# What v4l2-ctl 1.22 prints for a common webcam.
FORMATS = """ioctl: VIDIOC_ENUM_FMT
\tType: Video Capture

\t[0]: 'YUYV' (YUYV 4:2:2)
\t\tSize: Discrete 640x480
\t\t\tInterval: Discrete 0.033s (30.000 fps)
\t\t\tInterval: Discrete 0.067s (15.000 fps)
\t\tSize: Discrete 1280x720
\t\t\tInterval: Discrete 0.100s (10.000 fps)
\t[1]: 'MJPG' (Motion-JPEG, compressed)
\t\tSize: Discrete 1280x720
\t\t\tInterval: Discrete 0.033s (30.000 fps)
\t[2]: 'GREY' (8-bit Greyscale)
\t\tSize: Stepwise 16x16 - 640x480 with step 1/1
\t\t\tInterval: Discrete 0.010s (100.000 fps)
"""
CONTROLS = """
User Controls

                     brightness 0x00980900 (int)    : min=-64 max=64 step=1 default=0 value=0

Camera Controls

                  auto_exposure 0x009a0901 (menu)   : min=0 max=3 default=3 value=3 (Aperture Priority Mode)
         exposure_time_absolute 0x009a0902 (int)    : min=1 max=5000 step=1 default=157 value=157 flags=inactive
     exposure_dynamic_framerate 0x009a0903 (bool)   : default=0 value=1
"""


def said(returncode, stdout="", stderr=""):
    return subprocess.CompletedProcess([], returncode, stdout, stderr)


def setup(source="camera:0", width=640, height=480):
    return Setup(Path("robot1.yaml"), "robot1", source, width, height, "tag36h11", (0, 1, 2), "three_faces")


def v4l2(formats=FORMATS, controls=CONTROLS):
    return lambda command: said(0, formats if "--list-formats-ext" in command else controls)


def checks(findings):
    return {finding.check: finding for finding in findings}


# --- camera -----------------------------------------------------------------------------------------------------------
def test_the_modes_of_a_camera_are_read_with_their_highest_rates():
    assert camera.parse_modes(FORMATS) == [
        Mode("YUYV", 640, 480, 30.0),
        Mode("YUYV", 1280, 720, 10.0),
        Mode("MJPG", 1280, 720, 30.0),
    ]
    assert camera.parse_modes("nonsense\n(30.000 fps)\n") == []


def test_a_camera_that_has_the_calibration_s_size_is_well(machine):
    host = machine({"dev/video0": ""}, **{"v4l2-ctl": v4l2()})
    good = Measured("YUYV 640x480", 61, 2.0, 640, 480)  # 60 periods in 2 s
    found = checks(camera.check_camera(host, setup(), lambda index, asked: good))
    assert found["camera formats"].verdict is Verdict.ok
    assert found["camera formats"].seen == "YUYV 640x480 at 30 Hz"
    assert found["camera of the robot"].verdict is Verdict.ok
    assert "30.0 pictures a second of 640x480" in found["camera of the robot"].seen


def test_a_size_that_the_camera_does_not_have_is_wrong_with_those_it_has(machine):
    found = camera.check_formats(machine(**{"v4l2-ctl": v4l2()}), "/dev/video0", setup(width=800, height=600))
    assert found.verdict is Verdict.wrong
    assert "800x600" in found.seen and "MJPG 1280x720 at 30 Hz" in found.seen


def test_an_automatic_exposure_is_told_with_the_command_that_fixes_it(machine):
    found = camera.check_exposure(machine(**{"v4l2-ctl": v4l2()}), "/dev/video2")
    assert found.verdict is Verdict.note
    assert "--device /dev/video2" in found.advice
    settings = "auto_exposure=1,exposure_time_absolute=100,exposure_dynamic_framerate=0"
    assert settings in found.advice


def test_a_fixed_exposure_is_well_and_its_time_is_told(machine):
    """157 units of 100 us are 15.7 ms; 1 is V4L2_EXPOSURE_MANUAL."""
    fixed = CONTROLS.replace("value=3 (Aperture", "value=1 (Manual")
    found = camera.check_exposure(machine(**{"v4l2-ctl": v4l2(controls=fixed)}), "/dev/video0")
    assert (found.verdict, found.seen) == (Verdict.ok, "fixed, 15.7 ms")


def test_a_camera_that_is_not_there_is_wrong_and_those_that_are_there_are_named(machine):
    (found,) = camera.check_camera(machine({"dev/video2": ""}), setup())
    assert found.verdict is Verdict.wrong
    assert found.seen == "/dev/video0 is not there; cameras here: video2"


def test_without_v4l_utils_the_camera_is_measured_all_the_same(machine):
    host = machine({"dev/video0": ""})
    found = checks(camera.check_camera(host, setup(), lambda index, asked: Measured("x", 31, 1.0, 640, 480)))
    assert "v4l-utils" in found["camera formats"].advice
    assert found["camera of the robot"].verdict is Verdict.ok


@pytest.mark.parametrize(
    ("measured", "verdict", "words"),
    [
        (Measured("x", 31, 2.0, 640, 480), Verdict.note, "15.0 pictures a second"),  # 30 periods in 2 s, 30 Hz wanted
        (Measured("x", 61, 2.0, 320, 240), Verdict.wrong, "the calibration is for 640x480"),
        (Measured("", 0, 0.0, 0, 0, "no picture within 5 s"), Verdict.wrong, "no picture within 5 s"),
        (Measured("", 0, 0.0, 0, 0, "Device or resource busy"), Verdict.note, "busy"),
        (Measured("x", 61, 2.0, 640, 480, age_s=0.012), Verdict.ok, "12 ms old when read"),
    ],
)
def test_pictures_are_judged_by_rate_and_size(measured, verdict, words):
    found = camera.judge(setup(), measured)
    assert found.verdict is verdict
    assert words in found.seen


def test_a_real_camera_that_does_not_open_is_told():
    absent = next(k for k in range(60, 64) if not Path(f"/dev/video{k}").exists())
    measured = camera.take_pictures(absent, setup())
    assert measured.frames == 0
    assert f"/dev/video{absent}" in measured.problem


# --- port -------------------------------------------------------------------------------------------------------------
def udp_socket(port, shared):
    own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    if shared:
        own.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    own.bind(("", port))
    return own


def test_a_free_port_is_well():
    found = ports.check_port(Host(), free_udp_port())
    assert found.verdict is Verdict.ok
    assert "nobody yet" in found.seen


def test_a_port_that_lcm_s_programs_share_is_well_and_they_are_named():
    port = free_udp_port()
    with udp_socket(port, shared=True):
        found = ports.check_port(Host(), port)
    assert found.verdict is Verdict.ok
    assert f"({os.getpid()})" in found.seen


def test_a_port_that_a_program_keeps_for_itself_is_wrong_and_the_program_is_named():
    port = free_udp_port()
    with udp_socket(port, shared=False):
        found = ports.check_port(Host(), port)
    assert found.verdict is Verdict.wrong
    assert "EADDRINUSE" in found.seen and f"({os.getpid()})" in found.seen
    assert f"sport = :{port}" in found.advice and f":{port + 1}?" in found.advice


# --- processors and tools ---------------------------------------------------------------------------------------------
GOVERNOR = "sys/devices/system/cpu/cpu{}/cpufreq/scaling_governor"


def test_processors_at_full_speed_are_well_and_others_are_told(machine):
    assert system.check_governor(machine()).verdict is Verdict.note  # a virtual machine has none
    fast = machine({GOVERNOR.format(k): "performance\n" for k in range(4)})
    assert (system.check_governor(fast).verdict, system.check_governor(fast).seen) == (
        Verdict.ok,
        "performance on 4",
    )
    mixed = machine({GOVERNOR.format(3): "powersave\n"})
    found = system.check_governor(mixed)
    assert found.verdict is Verdict.note
    assert found.seen.startswith("performance on 3, powersave on 1")
    assert "cpupower frequency-set -g performance" in found.advice


@pytest.mark.parametrize(
    ("answer", "verdict", "words"),
    [
        (None, Verdict.note, "not installed"),
        (said(1), Verdict.note, "not installed"),
        (said(0, stderr='openjdk version "17.0.15" 2025-04-15\n'), Verdict.ok, "17.0.15"),
        (said(0, stderr="something else"), Verdict.ok, "unknown version"),
    ],
)
def test_java_is_looked_for(machine, answer, verdict, words):
    found = tools.check_java(machine(java=answer))
    assert found.verdict is verdict
    assert words in found.seen


def test_lcm_s_tools_are_looked_for_on_the_path(machine, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    missing = tools.check_lcm_tools(machine())
    assert missing.verdict is Verdict.note
    assert "lcm-logger, lcm-logplayer, lcm-spy" in missing.seen
    for name in ("lcm-logger", "lcm-logplayer", "lcm-spy"):
        (tmp_path / name).touch(mode=0o755)
    assert tools.check_lcm_tools(machine()).verdict is Verdict.ok


def test_the_line_for_a_report_has_the_versions(machine):
    found = tools.check_versions(machine({"etc/os-release": 'ID=x\nPRETTY_NAME="Some Linux 12"\n'}))
    for words in ("pilotfish 0.1.0", "Python 3.", "lcm 1.", "Some Linux 12"):
        assert words in found.seen


def test_the_receive_buffer_is_mended_for_good(machine):
    found = network.check_receive_buffer(machine({"proc/sys/net/core/rmem_max": "212992"}))
    assert "/etc/sysctl.d/60-pilotfish.conf" in found.advice

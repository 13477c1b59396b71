"""The examples in Python end in words, whatever ends them: Ctrl-C, a reader that has seen enough, what is not there."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest
from PIL import Image

from build_tree import ROOT
from pilotfish import bus, core, data
from pilotfish.harness.ports import private_lcm_url
from scenes import leader_pictures, save_pictures

EXAMPLES = ROOT / "examples/python"
WITHIN_S = 20.0
LINE = data.path("config/line.yaml")


def command(name, *arguments):
    return [sys.executable, str(EXAMPLES / f"{name}.py"), *map(str, arguments)]


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pictures")
    save_pictures(leader_pictures(2), folder)
    return folder


@pytest.mark.parametrize(
    ("name", "arguments", "says"),
    [
        ("track_images", ["nowhere", 600, 0.16], "there is no folder nowhere"),
        ("track_images", ["{tmp}", 600, 0.16], "there are no pictures in {tmp}"),
        ("track_images", ["{pictures}", "long", 0.16], "could not convert string to float: 'long'"),
        ("track_images", ["{pictures}", -600, 0.16], "-600"),
        ("track_images", ["{pictures}", 600, 0], "size_m"),
        ("follow_without_lcm", ["nowhere.yaml", "{pictures}"], "nowhere.yaml"),
        ("follow_without_lcm", [LINE, "nowhere"], "there is no folder nowhere"),
    ],
)
def test_what_is_wrong_is_said_in_a_line(tmp_path, pictures, name, arguments, says):
    places = {"tmp": tmp_path, "pictures": pictures}
    words = [str(argument).format(**places) for argument in arguments]
    done = subprocess.run(command(name, *words), capture_output=True, text=True, timeout=WITHIN_S)
    assert done.returncode == 1
    assert done.stderr.startswith(f"{name}: ") and says.format(**places) in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_pictures_that_cannot_be_followed_are_answered_with_the_reason(tmp_path):
    """The calibration is for 640 x 480."""
    Image.new("L", (1280, 720), 128).save(tmp_path / "0.png")
    words = command("follow_without_lcm", LINE, tmp_path)
    done = subprocess.run(words, capture_output=True, text=True, timeout=WITHIN_S, check=True)
    why = "the frame's size is not the calibration's (1280 x 720, calibration 640 x 480)"
    assert done.stdout.splitlines()[0].endswith(f"rad/s: {why}")


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("track_images", ["{pictures}", 600, 0.16]),
        ("follow_without_lcm", [LINE, "{pictures}"]),
        ("fuzzy_controller", []),
        ("own_law", []),
    ],
)
def test_a_reader_that_has_seen_enough_is_no_error_to_speak_of(pictures, name, arguments):
    words = command(name, *(str(argument).format(pictures=pictures) for argument in arguments))
    reading, writing = os.pipe()
    os.close(reading)  # before the first line
    done = subprocess.run(words, stdout=writing, stderr=subprocess.PIPE, text=True, timeout=WITHIN_S)
    os.close(writing)
    assert (done.returncode, done.stderr) == (-signal.SIGPIPE, "")


@contextmanager
def driving():
    """The wheel driver, once it has received a first command."""
    url = private_lcm_url()
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command("wheel_driver", "r1", url), bufsize=0, **pipes) as process:
        try:
            link, counter, deadline = bus.Bus(url), 0, time.monotonic() + WITHIN_S
            os.set_blocking(process.stdout.fileno(), False)

            def send():
                nonlocal counter
                assert time.monotonic() < deadline
                counter += 1
                valid_until_us = core.monotonic_now_us() + 100_000
                twist, status = core.Twist(linear_mps=0.25), core.Status.tracking
                link.publish_command(
                    "r1",
                    bus.CommandReport(
                        utime=counter,
                        session=7,
                        counter=counter,
                        valid_until_us=valid_until_us,
                        command=twist,
                        status=status,
                    ),
                )
                time.sleep(0.01)  # a coordinator's period; it is not waited for

            while not process.stdout.read():
                send()
            yield process, send
        finally:
            process.kill()


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_the_wheels_stand_still_when_the_driver_is_told_to_end(number, code):
    with driving() as (process, _):
        process.send_signal(number)
        assert process.wait(WITHIN_S) == code
        assert process.stdout.read().splitlines()[-1] == b"v = +0.000 m/s, w = +0.000 rad/s"
        assert process.stderr.read() == b""


def test_the_driver_ends_quietly_when_nobody_reads_what_it_prints():
    with driving() as (process, send):
        process.stdout.close()
        while process.poll() is None:
            send()
        assert (process.returncode, process.stderr.read()) == (141, b"")

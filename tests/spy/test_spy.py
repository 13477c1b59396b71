"""pilotfish-spy on a virtual screen, with every type of message on the bus."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from spy_screen import LAUNCHER, PATIENCE_S

from pilotfish import bus, core
from pilotfish.harness.child import Child
from pilotfish.harness.ports import private_lcm_url

MAKE_JARS = Path(__file__).parents[2] / "apps/spy/make_jars"
FIELD_BACKGROUND = (230, 230, 255)  # lcm-spy paints it behind decoded fields, and nowhere else


def run(*arguments, **environment):
    return subprocess.run(
        ["sh", LAUNCHER, *arguments],
        env={"PATH": os.environ["PATH"], **environment},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )


def test_help_names_the_options_and_needs_neither_screen_nor_java(tmp_path):
    shown = run("--help")
    assert shown.returncode == 0
    assert "--lcm-url" in shown.stdout
    assert "PILOTFISH_LCMTYPES_JAR" in shown.stdout


@pytest.mark.parametrize("arguments", [["--nonsense"], ["--lcm-url"], ["-l"]])
def test_wrong_arguments_are_a_usage_error(arguments):
    refused = run(*arguments)
    assert refused.returncode == 64
    assert arguments[0] in refused.stderr


@pytest.fixture
def only_tools(tmp_path):
    """A PATH with what the launcher needs, but without Java."""
    for tool in ["sh", "cat", "dirname", "readlink"]:
        (tmp_path / tool).symlink_to(shutil.which(tool))
    return tmp_path


def test_without_java_it_says_which_package_to_install(only_tools):
    refused = run(PATH=str(only_tools), DISPLAY=":0")
    assert refused.returncode == 69
    assert "there is no Java; on Debian and Ubuntu: apt-get install default-jre" in refused.stderr


def test_with_a_java_without_windows_it_says_which_package_to_install(tmp_path, only_tools):
    home = tmp_path / "jvm"
    (home / "lib/server").mkdir(parents=True)
    (home / "bin").mkdir()
    (home / "bin/java").write_text("#!/bin/sh\n")
    (home / "bin/java").chmod(0o755)
    refused = run(PATH=f"{home / 'bin'}:{only_tools}", DISPLAY=":0")
    assert refused.returncode == 69
    assert "has no windows" in refused.stderr
    assert "apt-get install default-jre" in refused.stderr


@pytest.mark.usefixtures("lcm_spy")
def test_without_a_screen_it_says_so():
    refused = run()
    assert refused.returncode == 69
    assert "there is no screen (DISPLAY is not set)" in refused.stderr


@pytest.mark.usefixtures("lcm_spy")
def test_a_jar_that_is_not_there_is_refused():
    refused = run(DISPLAY=":0", PILOTFISH_LCMTYPES_JAR="/nowhere/types.jar")
    assert refused.returncode == 69
    assert "PILOTFISH_LCMTYPES_JAR=/nowhere/types.jar: there is no such file" in refused.stderr


@pytest.mark.usefixtures("lcm_spy")
def test_without_the_plug_in_it_says_what_is_missing(tmp_path):
    types = tmp_path / "types.jar"
    types.touch()
    said = run(PILOTFISH_LCMTYPES_JAR=str(types)).stderr  # and ends, because there is no screen
    assert f"no {tmp_path}/pilotfish-spy.jar, so a double click on a status or an image shows its fields only" in said


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        ([], 64, "usage: make_jars LCM_GEN LCM_JAR FOLDER"),
        (["/nowhere/lcm-gen", "/dev/null", "jars"], 69, "/nowhere/lcm-gen: there is no such program"),
        (["true", "/nowhere/lcm.jar", "jars"], 69, "/nowhere/lcm.jar: there is no such file"),
    ],
)
def test_jars_that_cannot_be_made_are_refused_with_what_to_install(tmp_path, arguments, code, said):
    tools = {"JAVAC": "true", "JAR": "true"}
    refused = subprocess.run(
        [MAKE_JARS, *arguments], cwd=tmp_path, env={**os.environ, **tools}, capture_output=True, text=True, check=False
    )
    assert refused.returncode == code
    assert said in refused.stderr
    assert not (tmp_path / "jars").exists()


class Traffic:
    """One message of every type that Pilotfish knows, again and again."""

    def __init__(self, url):
        self.bus = bus.Bus(url)
        self.sent = 0

    def publish(self):
        self.sent += 1
        utime = self.sent
        image = core.Frame(np.full((48, 64), 100, np.uint8), utime=utime)
        tag = core.TagDetection(id=3, corners_px=np.ones((4, 2)))
        seen = core.Observation(utime=utime, distance_m=1.1, tags=[tag])
        pose = bus.PoseReport(utime=utime, x_m=1.0, y_m=2.0, heading_rad=0.3)
        self.bus.publish_image("ROBOT1_IMAGE", image)
        self.bus.publish_observation("robot1", bus.ObservationReport(utime=utime, observation=seen))
        self.bus.publish_command("robot1", bus.CommandReport(utime=utime, counter=utime))
        self.bus.publish_status("robot1", bus.StatusReport(utime=utime, rejected={"image_corrupt": 2}))
        self.bus.publish_setpoint("robot1", bus.SetpointReport(utime=utime, setpoint=core.Setpoint(distance_m=1.1)))
        self.bus.publish_pose("robot1", pose)
        self.bus.publish_motion("robot1", bus.MotionReport(utime=utime, twist=core.Twist(linear_mps=0.2)))


CHANNELS = ["COMMAND", "IMAGE", "MOTION", "OBSERVATION", "POSE", "SETPOINT", "STATUS"]  # as the table sorts them
TYPES = {"bot_core": 4, "pilotfish": 16}


def test_every_channel_shows_its_decoded_fields(tmp_path, screen, monkeypatch):
    url = private_lcm_url()
    traffic = Traffic(url)
    monkeypatch.setenv("DISPLAY", screen.display)

    def field_pixels():
        traffic.publish()
        return int((screen.pixels() == FIELD_BACKGROUND).all(axis=2).sum())

    def listed():
        traffic.publish()
        return screen.rows() == len(CHANNELS)

    with Child(["sh", LAUNCHER, "--lcm-url", url], tmp_path, "spy") as spy:
        spy.wait_until(lambda: screen.windows("^LCM Spy$"), PATIENCE_S, "showing its window")
        spy.wait_until(listed, PATIENCE_S, "listing all channels")
        assert f"Found {sum(TYPES.values())} LCM types" in spy.stdout_file.read_text()

        for row, channel in enumerate(CHANNELS):
            assert field_pixels() == 0
            if channel in ("IMAGE", "STATUS"):  # a double click shows the robot; the fields are in the menu
                screen.click(row, button=3)
                screen.xdotool("mousemove_relative", 30, 12, "click", 1)
            else:
                screen.click(row, times=2)
            title = f"^ROBOT1_{channel}$"
            spy.wait_until(lambda title=title: screen.windows(title), PATIENCE_S, title)
            # A type that lcm-spy does not know has an empty window; ours show their fields, however many.
            spy.wait_until(lambda: field_pixels() > 5000, PATIENCE_S, f"showing the fields of {channel}")
            Image.fromarray(screen.pixels()).save(tmp_path / f"{channel}.png")
            (viewer,) = screen.windows(title)
            screen.xdotool("windowunmap", viewer)
            spy.wait_until(lambda: field_pixels() == 0, PATIENCE_S, f"putting {channel} away")

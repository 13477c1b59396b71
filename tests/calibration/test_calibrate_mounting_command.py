"""``pilotfish calibrate mounting`` from films and logs to the lines that a coordinator reads."""

import re
import subprocess
import sys

import lcm
import numpy as np
import pytest
import yaml
from driven_cameras import MOUNTING, ONE, error_of, pictures_of, straight, turn
from PIL import Image
from typer.testing import CliRunner

from pilotfish import core
from pilotfish import data as shipped
from pilotfish.cli import app
from pilotfish.lcmtypes.bot_core import image_t, pose_t

CALIBRATION = str(shipped.path("calibrations/sim_640x480.yaml"))
TURNED, DRIVEN = 20, 14
COMMON = ["--camera", CALIBRATION, "--tag-size", "0.16"]


@pytest.fixture(scope="module")
def frames():
    return pictures_of(ONE, turn(TURNED) + straight(DRIVEN))


@pytest.fixture(scope="module")
def films(frames, tmp_path_factory):
    """A folder each of the turn, the drive, and both."""
    folder = tmp_path_factory.mktemp("films")
    for name, part in (("turn", frames[:TURNED]), ("drive", frames[TURNED:]), ("both", frames)):
        (folder / name).mkdir()
        for k, frame in enumerate(part):
            Image.fromarray(frame.image).save(folder / name / f"{k:03d}.png")
    return folder


@pytest.fixture(scope="module")
def log(frames, tmp_path_factory):
    """What lcm-logger would have recorded: pictures every 0.2 s, and odometry whose turns are 2 % too long."""
    path = tmp_path_factory.mktemp("log") / "run.lcmlog"
    file = lcm.EventLog(str(path), "w", overwrite=True)
    for k, frame in enumerate(frames):
        image = image_t()
        image.utime, image.width, image.height, image.row_stride = 200_000 * (k + 5), 640, 480, 640
        image.pixelformat = image_t.PIXEL_FORMAT_GRAY
        image.data = frame.image.tobytes()
        image.size = len(image.data)
        file.write_event(image.utime, "ROBOT1_IMAGE", image.encode())
    angles, ways = np.linspace(np.radians(-16), np.radians(16), TURNED), np.linspace(0.0, 0.6, DRIVEN)
    t_turn, t_drive = 0.2 * (np.arange(TURNED) + 5), 0.2 * (np.arange(DRIVEN) + TURNED + 5)
    for t in np.arange(0.0, 0.2 * (TURNED + DRIVEN + 10), 0.02):
        heading, way = 1.02 * np.interp(t, t_turn, angles), np.interp(t, t_drive, ways)
        pose = pose_t()
        pose.utime = int(t * 1e6)
        pose.pos = [way * np.cos(heading), way * np.sin(heading), 0.0]
        pose.orientation = [np.cos(heading / 2), 0.0, 0.0, np.sin(heading / 2)]
        file.write_event(pose.utime, "ROBOT1_POSE", pose.encode())
    file.close()
    return path


def run(*arguments):
    result = CliRunner().invoke(app, ["calibrate", "mounting", *map(str, arguments)])
    return result, re.sub(r"[\s│]+", " ", re.sub(r"\x1b\[[0-9;]*m", "", result.output))


def mounting_in(file):
    """Of the lines, as a coordinator's file has them."""
    section = yaml.safe_load(file.read_text())["camera"]["mounting"]
    angles = {f"{name}_rad": np.radians(section[f"{name}_deg"]) for name in ("pan", "tilt", "roll")}
    return core.CameraMounting(position_m=section["position_m"], **angles)


def check(file):
    error = np.abs(error_of(mounting_in(file)))
    assert error[:3].max() < 2e-3
    assert error[3:].max() < np.radians(0.1)


def test_two_films_become_the_lines_to_paste(films, tmp_path):
    out = tmp_path / "new" / "mounting.yaml"
    command = [
        sys.executable,
        "-m",
        "pilotfish",
        "calibrate",
        "mounting",
        films / "turn",
        "--straight",
        films / "drive",
    ]
    done = subprocess.run(
        [*command, *COMMON, "--height-of", "0=0.32", "--out", out], capture_output=True, text=True, timeout=200
    )
    assert done.returncode == 0, done.stderr
    assert "camera:\n  mounting:\n    position_m: [" in done.stdout
    check(out)


def test_one_film_is_taken_apart(films, tmp_path):
    result, said = run(films / "both", *COMMON, "--height-m", MOUNTING.position_m[2], "--out", tmp_path / "m.yaml")
    assert result.exit_code == 0, said
    check(tmp_path / "m.yaml")


def test_a_log_with_odometry_is_taken_apart_by_it_and_odometry_is_weighed(log, tmp_path):
    result, said = run(log, *COMMON, "--height-of", "0=0.32", "--out", tmp_path / "m.yaml")
    assert result.exit_code == 0, said
    check(tmp_path / "m.yaml")
    assert "by the odometry:" in said
    turn_percent = float(re.search(r"odometry makes a turn ([+-][\d.]+) %", said)[1])
    assert turn_percent == pytest.approx(2.0, abs=0.3)


def test_a_turn_alone_says_what_it_does_not_show(films):
    result, said = run(films / "turn", "--turn-only", *COMMON)
    assert result.exit_code == 0, said
    assert "not seen: the height" in said and "not seen: pan" in said
    assert "# not observed" in said


@pytest.mark.parametrize(
    ("arguments", "exit_code", "wrong"),
    [
        (["nowhere", *COMMON], 66, "no such file or folder"),
        (["FILMS/turn", *COMMON], 65, "--straight"),
        (["FILMS/both", *COMMON, "--height-m", "0.3", "--height-of", "0=0.3"], 64, "exclude each other"),
        (["FILMS/both", *COMMON, "--height-m", "nan"], 64, "not a number from -5 to 5"),
        (["FILMS/both", *COMMON, "--pan-deg", "3"], 64, "--turn-only"),
        (["FILMS/both", *COMMON, "--height-of", "7=0.3"], 65, "tag was not seen; seen were [0]"),
        (["FILMS/both", *COMMON, "--family", "tag99"], 64, "--family"),
        (["FILMS/both", "--camera", CALIBRATION, "--tag-size", "7=0.1"], 65, "no size is given for tag 0"),
        (["LOG", *COMMON, "--robot", "robot2"], 65, "no pictures on ROBOT2_IMAGE"),
    ],
)
def test_what_is_wrong_is_said(films, log, arguments, exit_code, wrong):
    arguments = [each.replace("FILMS", str(films)).replace("LOG", str(log)) for each in arguments]
    result, said = run(*arguments)
    assert (result.exit_code, wrong in said) == (exit_code, True), said


def test_a_tag_on_the_floor_has_the_height_zero():
    from pilotfish.cli.learn_body import of_tag

    assert of_tag("5=0", "--height-of", allow_zero=True) == (5, 0.0)

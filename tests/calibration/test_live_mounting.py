"""``pilotfish calibrate mounting camera:N``: a turn and a drive before a camera that runs, with Enter in between."""

import io
import os
import re
import subprocess
import sys
import time

import numpy as np
import pytest
import yaml
from driven_cameras import CAMERA, MOUNTING, ONE, error_of, ground, pictures_of, sizes_of, straight, turn
from rich.console import Console
from typer.testing import CliRunner

from fake_camera import NUMBER, FakeCamera, built
from pilotfish import core
from pilotfish import data as shipped
from pilotfish.calibration.mounting import calibrate_mounting
from pilotfish.calibration.mounting.live import AIM_DRIVE, AIM_TURN, DRIVE, TURN, collect_live
from pilotfish.cli import app
from pilotfish.cli.live_screen import enter_key
from pilotfish.cli.mounting_live import _TODO, drawn
from pilotfish.errors import BodyLearningError, CalibrationError

CALIBRATION = str(shipped.path("calibrations/sim_640x480.yaml"))
TURNED, DRIVEN = 20, 14
WITHIN_S = 60.0


@pytest.fixture(scope="module")
def parts():
    """Frames of the robot standing, turning, and driving."""
    frames = pictures_of(ONE, [ground(), *turn(TURNED), *straight(DRIVEN)])
    return {"stands": frames[:1], "turn": frames[1 : 1 + TURNED], "drive": frames[1 + TURNED :]}


def presses(frames_before_each):
    """An ``advance`` that says yes at the pictures after so many others."""
    asked = 0
    at = set(np.cumsum(frames_before_each).tolist())

    def advance():
        nonlocal asked
        asked += 1
        return asked in at

    return advance


def blank(count):
    return [core.Frame(np.full((480, 640), 120, np.uint8), utime=k + 1) for k in range(count)]


def check(mounting):
    error = np.abs(error_of(mounting))
    assert error[:2].max() < 2e-3  # the height is not seen
    assert error[3:].max() < np.radians(0.1)


def test_each_part_is_what_was_seen_between_two_presses(parts):
    """Standing: 3 pictures; the turn; standing: 5; the drive. What stands is of no part, and a robot that stands at the
    beginning of a part counts once."""
    frames = parts["stands"] * 3 + parts["turn"] + parts["stands"] * 5 + parts["drive"]
    states = []
    collected, phases = collect_live(
        frames, CAMERA, sizes_of(ONE), advance=presses([3, TURNED, 5, DRIVEN]), on_picture=states.append
    )
    assert (phases.turning.sum(), phases.straight.sum()) == (TURNED, DRIVEN)
    assert not (phases.turning & phases.straight).any()
    seen = [state.part for state in states]
    assert sorted(set(seen), key=seen.index) == [AIM_TURN, TURN, AIM_DRIVE, DRIVE]
    check(calibrate_mounting(collected.sightings, CAMERA, phases=phases).mounting)


def test_how_far_it_has_come_is_about_the_truth(parts):
    frames = parts["stands"] + parts["turn"] + parts["stands"] + parts["drive"]
    states = []
    collect_live(frames, CAMERA, sizes_of(ONE), advance=presses([1, TURNED, 1, DRIVEN]), on_picture=states.append)
    # It turns by 32 degrees and drives 0.6 m; distortion, tilt and the camera's place make hints of that.
    assert np.degrees(states[-1].turned_rad) == pytest.approx(32.0, abs=5.0)
    assert states[-1].driven_m == pytest.approx(0.6, abs=0.1)


def test_of_a_robot_that_stands_one_picture_is_kept(parts):
    frames = parts["stands"] * 30 + parts["turn"]
    states = []
    collect_live(
        frames,
        CAMERA,
        sizes_of(ONE),
        turn_only=True,
        advance=presses([1, 29 + TURNED]),
        on_picture=states.append,
    )
    assert states[29].pictures == (1, 0)
    assert states[-1].pictures[0] <= TURNED + 1


def test_a_part_does_not_end_before_there_is_enough_of_it(parts):
    frames = blank(20) + parts["stands"] + parts["turn"][:4] + parts["turn"][4:]
    states = []
    collect_live(
        frames,
        CAMERA,
        sizes_of(ONE),
        turn_only=True,
        advance=presses([20, 1, 4, TURNED - 4]),
        on_picture=states.append,
    )
    refused = [(number, state.refused) for number, state in enumerate(states, 1) if state.refused]
    assert [number for number, _ in refused] == [20, 25]
    assert "no tag is in the picture" in refused[0][1]
    assert "only 4 different pictures of a tag yet, 8 are needed" in refused[1][1]


def test_a_robot_that_goes_to_and_fro_is_told_to_drive_one_way(parts):
    """Forward is where the drive leads; 0.6 m there and 0.3 m back is no direction that can be relied on."""
    forth_and_back = parts["drive"] + parts["drive"][7:][::-1]
    frames = parts["stands"] + parts["turn"] + parts["stands"] + forth_and_back
    collected, phases = collect_live(
        frames, CAMERA, sizes_of(ONE), advance=presses([1, TURNED, 1, len(forth_and_back)])
    )
    with pytest.raises(CalibrationError, match=r"went back by 0\.[23]\d m: let it drive in one direction only"):
        calibrate_mounting(collected.sightings, CAMERA, phases=phases)


def test_a_drive_the_other_way_round_is_noticed(parts):
    """Towards the tag, and said to be backwards: then the camera would look to the rear."""
    frames = parts["stands"] + parts["turn"] + parts["stands"] + parts["drive"]
    collected, phases = collect_live(
        frames, CAMERA, sizes_of(ONE), forward=False, advance=presses([1, TURNED, 1, DRIVEN])
    )
    found = calibrate_mounting(collected.sightings, CAMERA, phases=phases)
    assert any("looks to the rear" in warning and "--backwards" in warning for warning in found.warnings)


def test_a_tag_without_a_size_is_refused_at_once(parts):
    from pilotfish.calibration.body import TagSizes

    endless = (frame for _ in range(10**6) for frame in parts["turn"])
    with pytest.raises(BodyLearningError, match=r"--tag-size 0=METRES"):
        collect_live(endless, CAMERA, TagSizes(by_id={7: 0.1}), advance=lambda: False)


def test_enter_is_heard_once_and_an_input_that_has_ended_is_an_error(monkeypatch):
    read, write = os.pipe()
    with os.fdopen(read) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        with enter_key() as pressed:
            assert not pressed()
            os.write(write, b"\n\n")  # pressed twice, in a hurry
            assert pressed()
            assert not pressed()
            os.write(write, b"x")
            assert not pressed()  # not Enter
            os.close(write)
            with pytest.raises(CalibrationError, match="standard input has ended"):
                pressed()


def test_a_terminal_does_not_echo_meanwhile_and_does_afterwards(monkeypatch):
    import termios

    leader, follower = os.openpty()
    with os.fdopen(follower) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        with enter_key() as pressed:
            assert not termios.tcgetattr(follower)[3] & termios.ECHO
            os.write(leader, b"\n")
            deadline = time.monotonic() + WITHIN_S
            while not pressed():
                assert time.monotonic() < deadline
        assert termios.tcgetattr(follower)[3] & termios.ECHO
    os.close(leader)


def test_the_screen_says_what_to_do_and_where_the_tag_is(parts):
    states = []
    collect_live(
        parts["stands"] + parts["turn"],
        CAMERA,
        sizes_of(ONE),
        turn_only=True,
        advance=presses([1, TURNED]),
        on_picture=states.append,
    )
    screen = io.StringIO()
    todo = {part: _TODO[part] for part in (AIM_TURN, TURN)}
    Console(file=screen, width=100).print(drawn(states[-2], todo, CAMERA.width))
    said = screen.getvalue()
    assert "2 of 2: turn" in said
    assert "turn on the spot, slowly" in said
    place = re.search(r"\|( *)#( *)\|", said)
    # The picture is 40 columns wide; the tag's centre is where the state says.
    assert len(place[1]) == int(states[-2].tags[0][0] / 640 * 40)
    assert re.search(r"turned by about \d+ of 25° or more \(\d+ pictures\)", said)


@pytest.mark.parametrize(
    ("arguments", "exit_code", "wrong"),
    [
        (["camera:93", "--straight", CALIBRATION], 64, "the drive follows the turn in the same run"),
        (["camera:93"], 65, "standard input has ended"),
        (["camera:x"], 66, "a camera is spelled camera:0"),
        (["camera:0", "--rate-hz", "nan"], 64, "not a number from 1 to 1000"),
    ],
)
def test_what_is_wrong_with_a_live_calibration_is_said(arguments, exit_code, wrong):
    common = ["--camera", CALIBRATION, "--tag-size", "0.16"]
    result = CliRunner().invoke(app, ["calibrate", "mounting", *arguments, *common])
    said = re.sub(r"[\s│]+", " ", re.sub(r"\x1b\[[0-9;]*m", "", result.output))
    assert (result.exit_code, wrong in said) == (exit_code, True), said


def test_a_running_camera_s_mounting_is_found_with_enter_between_the_parts(parts, tmp_path):
    if not built("libfake_camera.so").exists():
        pytest.skip("the simulated camera is not built")
    rng = np.random.default_rng(1)

    def noisy(image):  # a camera whose pictures repeat to the bit is taken for a frozen one
        return np.clip(image + rng.normal(0.0, 1.0, image.shape), 0, 255).astype(np.uint8)

    # One place after the other, each for some pictures: at its own pace the camera would begin again at the end.
    series = {
        f"{name} {place}": [noisy(frame.image) for _ in range(5)]
        for name, frames in parts.items()
        for place, frame in enumerate(frames)
    }
    camera = FakeCamera(tmp_path, series, rate_hz=30)
    out = tmp_path / "mounting.yaml"
    command = [sys.executable, "-u", "-m", "pilotfish", "calibrate", "mounting", f"camera:{NUMBER}", "--rate-hz", "30"]
    command += ["--camera", CALIBRATION, "--tag-size", "0.16", "--height-m", str(MOUNTING.position_m[2])]
    command += ["--out", str(out)]
    with subprocess.Popen(
        [*camera.prefix(), *command],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        bufsize=1,
    ) as process:
        said = []

        def until(words):
            for line in process.stdout:
                said.append(line)
                if words in line:
                    return
            pytest.fail(f"ended without '{words}': {''.join(said)}")

        def pass_by(name, pictures):
            """Every place of the part, each until so many more pictures were taken."""
            for place in range(len(parts[name])):
                camera.show(f"{name} {place}")
                enough, deadline = camera.taken + pictures, time.monotonic() + WITHIN_S
                while camera.taken < enough:
                    assert time.monotonic() < deadline
                    assert process.poll() is None, process.stdout.read()
                    time.sleep(0.005)

        def press(words):
            process.stdin.write("\n")
            until(words)

        until("1 of 4: Turn the robot")
        press("2 of 4: Let it turn on the spot")
        pass_by("turn", 3)
        press("3 of 4: Let the robot face the tag")
        pass_by("stands", 8)
        press("4 of 4: Drive straight towards the tag")
        pass_by("drive", 3)
        process.stdin.write("\n")
        rest, _ = process.communicate(timeout=120)
    assert process.returncode == 0, "".join(said) + rest
    section = yaml.safe_load(out.read_text())["camera"]["mounting"]
    angles = {f"{name}_rad": np.radians(section[f"{name}_deg"]) for name in ("pan", "tilt", "roll")}
    check(core.CameraMounting(position_m=section["position_m"], **angles))

"""What the programs show to people: a summary every 2 s, reasons with their numbers, small pictures on the bus."""

import io
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
from onboard import LINE_CONFIG
from PIL import Image
from real_time_robot import Robot
from test_coordinator_program import run

from camera_robot import CameraRobot, leader_camera
from pilotfish import core
from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import BASE, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t
from scenes import leader_pictures, save_pictures

SUMMARY = re.compile(
    r"(?:tracking|coasting)[^:]*: leader measured in (\d+) of (\d+) frames, ([\d.]+) Hz; "
    r"d ([\d.]+) m \(([+-]\d+) mm\), bearing (-?[\d.]+) deg \(([+-][\d.]+)\); "
    r"v ([\d.-]+) m/s, w ([\d.-]+) rad/s; answered within [\d.]+ ms"
)


def edited_config(folder, **replacements):
    """The line's configuration with its files in a folder, and lines of text in place of others."""
    for name in ("config", "fuzzy", "calibrations", "leaders"):
        shutil.copytree(shipped.path(name), folder / name)
    file = folder / "config/line.yaml"
    text = file.read_text()
    for old, new in replacements.items():
        assert old in text
        text = text.replace(old, new)
    file.write_text(text)
    return file


def test_a_coordinator_says_every_two_seconds_what_it_measures(tmp_path):
    with Robot(tmp_path) as robot:
        robot.follow(150)  # 5 s: two lines at least
        robot.child.wait_until(lambda: len(SUMMARY.findall(robot.child.stderr())) >= 2, 10.0, "two summaries")
        for measured, frames, rate, d, error, bearing, off, v, _ in SUMMARY.findall(robot.child.stderr())[:2]:
            assert 1 <= int(measured) <= int(frames)
            # a line is due after 2 s, and is written with the next frame
            assert 0.2 < float(rate) / (int(frames) / 2.0) <= 1.01
            # the line scenario's setpoint: 1.10 m at -10 degrees
            assert float(d) - 1.10 == pytest.approx(int(error) * 1e-3, abs=1.1e-3)
            assert float(bearing) + 10.0 == pytest.approx(float(off), abs=0.11)
            assert float(v) > 0.0


def test_a_summary_says_how_many_were_refused_since_the_last(tmp_path):
    with Robot(tmp_path) as robot:
        for k in range(150):
            robot.show(np.full((480, 320), k % 256, np.uint8))  # of another size
        robot.child.wait_until(lambda: "; refused: " in robot.child.stderr(), 10.0, "a summary")
        said = robot.child.stderr()
        assert re.search(r"refused: frames_invalid \+\d\d", said), said
        assert "; frame 320 x 480, calibration 640 x 480): leader measured in 0 of" in said


def test_quiet_programs_say_nothing_when_all_is_well(tmp_path):
    save_pictures(leader_pictures(3), tmp_path / "run")
    source = ["--source", f"images:{tmp_path / 'run'}", "--lcm-url", "memq://"]
    loud = run("--config", LINE_CONFIG, *source)
    quiet = run("--config", LINE_CONFIG, *source, "--quiet")
    assert (loud.returncode, quiet.returncode) == (0, 0)
    assert "ready" in loud.stdout + loud.stderr
    assert (quiet.stdout, quiet.stderr) == ("", "")


def test_a_base_says_every_two_seconds_what_the_wheels_do(tmp_path):
    program = find_executable(BASE)
    command = [program, "--config", shipped.path("config/base.yaml"), "--lcm-url", private_lcm_url()]
    with Child(command, tmp_path, "base") as base:
        line = re.compile(r"waiting: v 0\.000 m/s, w 0\.000 rad/s; 0 commands accepted in \d+\.\d s")
        base.wait_until(lambda: len(line.findall(base.stdout() + base.stderr())) >= 2, 20.0, "two summaries")


def test_a_leader_with_other_ids_is_refused_with_both_lists(tmp_path):
    ids = {"id: 0": "id: 40", "id: 1": "id: 41", "id: 2": "id: 42"}
    config = edited_config(tmp_path)
    leader = config.parent.parent / "leaders/three_faces.yaml"
    text = leader.read_text()
    for old, new in ids.items():
        assert old in text
        text = text.replace(old, new)
    leader.write_text(text)
    with Robot(tmp_path, config=config) as robot:
        texts = []
        robot.bus.subscribe("ROBOT1_STATUS", lambda _, data: texts.append(status_t.decode(data).text))
        robot.show_leader(10)
        robot.listen_until(lambda: any("saw" in text for text in texts), "a reason with ids")
    text = next(text for text in texts if "saw" in text)
    said = re.search(
        r"no tag of the leader's body in the picture \(saw id ([\d, ]+), the leader has 40, 41, 42\)", text
    )
    assert said, text
    assert set(said[1].split(", ")) <= {"0", "1", "2"}


def test_a_frame_of_another_size_is_refused_with_both_sizes(tmp_path):
    gray = [core.Frame(np.full((240, 320), 99 + k, np.uint8), utime=1_000_000 + 33_333 * k) for k in range(3)]
    save_pictures(gray, tmp_path / "run")
    done = run("--config", LINE_CONFIG, "--source", f"images:{tmp_path / 'run'}", "--lcm-url", "memq://")
    assert (
        "the frame's size is not the calibration's (frame 320 x 240, calibration 640 x 480)"
        in done.stdout + done.stderr
    )


@pytest.mark.parametrize(("max_width_px", "shrink"), [(640, 1), (639, 2), (320, 2), (200, 4)])
def test_a_cameras_pictures_are_on_the_bus_small_enough_for_people(tmp_path, max_width_px, shrink):
    """The smallest whole factor that makes 640 fit: 640 / 639 -> 2, 640 / 200 = 3.2 -> 4."""
    preview = f"preview:\n  rate_hz: 10\n  max_width_px: {max_width_px}\n  jpeg_quality: 95\nsetpoint:"
    config = edited_config(tmp_path, **{"setpoint:": preview})
    received = []
    with CameraRobot(leader_camera(tmp_path), tmp_path, config=config) as robot:
        robot.bus.subscribe("ROBOT1_PREVIEW", lambda _, data: received.append(image_t.decode(data)))
        robot.listen_until(lambda: len(received) >= 3, "three pictures")
    message = received[-1]
    assert (message.width, message.height) == (640 // shrink, 480 // shrink)
    assert [(extra.key, bytes(extra.value)) for extra in message.metadata] == [
        ("pilotfish_shrink", str(shrink).encode())
    ]
    shown = np.asarray(Image.open(io.BytesIO(bytes(message.data)))).astype(float)
    truth = leader_pictures(1)[0].image.astype(float)
    means = truth.reshape(480 // shrink, shrink, 640 // shrink, shrink).mean(axis=(1, 3))
    # The camera's noise is some gray levels, a JPEG's of quality 95 one; a picture moved by a pixel differs by 10.
    assert np.abs(shown - means).mean() < 3.0


def test_pictures_for_people_come_at_the_rate_asked_for_and_not_at_all_if_it_is_zero(tmp_path):
    for rate_hz in (4, 0):
        folder = tmp_path / str(rate_hz)
        folder.mkdir()
        config = edited_config(folder, **{"setpoint:": f"preview:\n  rate_hz: {rate_hz}\nsetpoint:"})
        received = []
        with CameraRobot(leader_camera(folder), folder, config=config) as robot:
            robot.bus.subscribe("ROBOT1_PREVIEW", lambda _, data, to=received: to.append(image_t.decode(data).utime))
            robot.drives(90)
        # 250 ms apart, by the clock of the program; exposures may be up to a frame nearer to each other
        assert np.all(np.diff(received) > 200_000)
        assert bool(received) == (rate_hz > 0)


def test_every_picture_of_a_cameras_run_is_recorded_and_can_be_seen_again(tmp_path):
    box = tmp_path / "box"
    with CameraRobot(leader_camera(tmp_path), tmp_path, "--record", str(box), "--record-raw") as robot:
        robot.drives(30)
    done = subprocess.run(
        [sys.executable, "-m", "pilotfish", "replay", str(box), "--assert", "--from-pixels"],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    rows = dict(re.findall(r"│ (.+?) +│ (\d+) +│", done.stdout))
    assert int(rows["frames seen again, compared"]) >= 30
    assert rows["frames without their picture"] == "0"


def test_raw_recording_needs_a_recording(tmp_path):
    done = run("--config", LINE_CONFIG, "--record-raw")
    assert done.returncode == 64 and "--record" in done.stderr

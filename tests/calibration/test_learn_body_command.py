"""``pilotfish learn-body`` from pictures to a leader that the coordinator reads, and the file in between."""

import math
import re
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image
from turning_bodies import FIVE, TWELVE, film
from typer.testing import CliRunner

from pilotfish import coordinator, core
from pilotfish import data as shipped
from pilotfish.calibration.body import write_leader_body
from pilotfish.cli import app

CALIBRATION = str(shipped.path("calibrations/sim_640x480.yaml"))
SIZES = [word for size in ("0.16", "1=0.12", "5=0.10", "7=0.12") for word in ("--tag-size", size)]


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("video")
    for frame in film():
        Image.fromarray(frame.image).save(folder / f"{frame.utime:04d}.png")
    return folder


def run(*arguments):
    result = CliRunner().invoke(app, ["learn-body", *map(str, arguments)])
    return result, re.sub(r"[\s│]+", " ", re.sub(r"\x1b\[[0-9;]*m", "", result.output))


def test_a_film_becomes_a_leader_that_the_coordinator_reads(pictures, tmp_path):
    output = tmp_path / "new" / "my_robot.yaml"
    command = [sys.executable, "-m", "pilotfish", "learn-body", pictures, "--camera", CALIBRATION, *SIZES]
    done = subprocess.run(
        [*command, "--height-of", "0=0.25", "--output", output], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    assert f"wrote {output}" in done.stdout
    assert "44 frames read" in done.stdout
    learned = coordinator.load_leader_body(str(output))
    assert learned.name == "my_robot"
    assert [tag.size_m for tag in learned.tags] == [tag.size_m for tag in FIVE.tags]
    for tag, true in zip(learned.tags, FIVE.tags, strict=True):
        np.testing.assert_allclose(tag.corners_m, true.corners_m, atol=2e-3)


def test_a_known_tag_is_taken_as_it_was_given(pictures, tmp_path):
    # A negative number after an option is a number, not an option; every other frame is enough.
    place = ["--reference-tag", 0, "--reference-position", -0.2, 0, 0.25]
    result, said = run(
        pictures, "--camera", CALIBRATION, *SIZES, *place, "--every", 2, "--output", tmp_path / "robot.yaml"
    )
    assert result.exit_code == 0, said
    assert "22 frames read" in said
    reference, *_ = coordinator.load_leader_body(str(tmp_path / "robot.yaml")).tags
    assert (reference.position_m, reference.tilt_rad) == ([-0.2, 0.0, 0.25], 0.0)
    assert abs(reference.facing_rad) == pytest.approx(math.pi)


@pytest.mark.parametrize("body", [FIVE, TWELVE], ids=["five", "twelve"])
def test_a_written_body_is_read_as_the_same(body, tmp_path):
    again = write_leader_body(tmp_path / "body.yaml", body, ["learned: from {nothing}"])
    assert (again.name, again.family) == (body.name, body.family)
    for read, written in zip(again.tags, body.tags, strict=True):
        assert (read.id, read.size_m) == (written.id, written.size_m)
        # Written to 0.01 mm and 0.001 degrees: half of that, and at 0.1 m from the centre 1.5e-6 m of each turn.
        np.testing.assert_allclose(read.corners_m, written.corners_m, atol=1.5e-5)
    assert (tmp_path / "body.yaml").read_text().startswith("# learned: from {nothing}\nname: leader\n")


def test_a_name_that_yaml_would_take_for_something_else_stays_a_name(tmp_path):
    for name in ("no", "1e3", "a: b", "#1", "Hai ä"):
        body = core.LeaderBody(FIVE.tags[:1], name=name)
        assert write_leader_body(tmp_path / "body.yaml", body).name == name


@pytest.mark.parametrize(
    ("arguments", "exit_code", "wrong"),
    [
        (["--tag-size", "large"], 64, "'large' is not a number of metres"),
        (["--tag-size", "7=-0.1"], 64, "0.005 to 5 metres"),
        (["--tag-size", "0.16", "--tag-size", "0.10"], 64, "several sizes"),
        (["--tag-size", "0.16", "--height-of", "0.3"], 64, "ID=METRES"),
        (["--tag-size", "0.16", "--reference-position", "0", "0", "0"], 64, "--reference-tag ID"),
        (["--tag-size", "0.16", "--family", "tag99"], 64, "--family"),
        (["--tag-size", "1=0.12"], 65, "--tag-size 0=METRES"),
    ],
)
def test_what_is_wrong_is_said(pictures, tmp_path, arguments, exit_code, wrong):
    output = tmp_path / "robot.yaml"
    result, said = run(pictures, "--camera", CALIBRATION, "--every", 4, *arguments, "--output", output)
    assert (result.exit_code, wrong in said) == (exit_code, True), said
    assert not output.exists()


def test_an_empty_folder_and_a_broken_calibration_are_named(tmp_path, pictures):
    (tmp_path / "empty").mkdir()
    result, said = run(tmp_path / "empty", "--camera", CALIBRATION, *SIZES, "--output", tmp_path / "robot.yaml")
    assert result.exit_code == 65
    assert "empty" in said
    (tmp_path / "camera.yaml").write_text("image_width: 640\n")
    result, said = run(pictures, "--camera", tmp_path / "camera.yaml", *SIZES, "--output", tmp_path / "robot.yaml")
    assert result.exit_code == 78
    assert "image_height" in said

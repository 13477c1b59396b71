"""Slips that a reader would rather guess at: each is refused with the key, the value and what is allowed instead."""

import re
import shutil
import subprocess

import pytest
from test_config_files import OPENCV, break_file

from pilotfish import coordinator, core, sim
from pilotfish import data as shipped
from pilotfish.harness.executables import COORDINATOR, find_executable


@pytest.fixture
def folder(tmp_path):
    for name in ("config", "fuzzy", "calibrations", "leaders"):
        shutil.copytree(shipped.path(name), tmp_path / name)
    return tmp_path


def refusal(load, *arguments):
    with pytest.raises(ValueError, match=r"^[\w.\[\]-]+: ") as refused:
        load(*arguments)
    return str(refused.value)


@pytest.mark.parametrize(
    ("line", "slip", "key"),
    [
        (r"  distance_m: 1\.10", "  distance_m: 010", "setpoint.distance_m"),
        (r"^frame_rate_hz: 30", "frame_rate_hz: 0030", "frame_rate_hz"),
        (r"  bearing_deg: -10\.0", "  bearing_deg: -010", "setpoint.bearing_deg"),
        (r"    position_m: \[[^]]*\]", "    position_m: [0, 0, 01]", "camera.mounting.position_m"),
        (r"^setpoint:", "black_box:\n  total_mb: 0100\nsetpoint:", "black_box.total_mb"),
    ],
)
def test_a_number_with_a_zero_in_front_is_not_guessed_at(folder, line, slip, key):
    """Eight to YAML 1.1, ten to YAML 1.2, for 010."""
    break_file(folder / "config/line.yaml", line, slip)
    said = refusal(coordinator.load_coordinator, folder / "config/line.yaml")
    value = re.search(r"-?0\d+", slip).group()
    assert said.startswith(f"{key}: '{value}' may be meant as octal; write the decimal number")


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("0,6", "'0,6' is not a number; a decimal point is '.'"),
        ("0.6 m/s", "'0.6 m/s' is not a number; without a unit, which the key names"),
        ("1e400", "'1e400' is not a number; it is too large or too small, or not written as 1.5e3"),
        ("fast", "'fast' is not a number"),
        ("6-7", "'6-7' is not a number"),
    ],
)
def test_what_is_no_number_is_refused_with_what_may_be_meant(folder, written, said):
    break_file(folder / "config/line.yaml", r"  distance_m: 1\.10", f"  distance_m: {written}")
    whole = refusal(coordinator.load_coordinator, folder / "config/line.yaml")
    assert whole.startswith(f"setpoint.distance_m: {said} (")


@pytest.mark.parametrize(
    ("line", "quoted", "key"),
    [
        (r"  distance_m: 1\.10", "  distance_m: '1.10'", "setpoint.distance_m"),
        (r"    position_m: \[[^]]*\]", '    position_m: [0, 0, "0.1"]', "camera.mounting.position_m"),
        (r"^setpoint:", "black_box:\n  total_mb: '100'\nsetpoint:", "black_box.total_mb"),
        (r"^setpoint:", "setpoint:\n  run: 'false'", "setpoint.run"),
    ],
)
def test_what_stands_in_quotes_is_a_text_and_no_number(folder, line, quoted, key):
    """As in YAML itself; what another program writes with quotes may be a number by accident, or not at all."""
    break_file(folder / "config/line.yaml", line, quoted)
    said = refusal(coordinator.load_coordinator, folder / "config/line.yaml")
    assert re.match(rf"{re.escape(key)}: '[\w.]+' is a text, because it stands in quotes; write it without", said)


def test_a_name_in_quotes_is_a_name(folder):
    break_file(folder / "config/line.yaml", r"^name: \w+", "name: 'robot7'")
    assert coordinator.load_coordinator(folder / "config/line.yaml").name == "robot7"


def test_a_tab_in_front_of_a_line_is_named(folder):
    break_file(folder / "config/line.yaml", r"  distance_m: 1\.10", "\tdistance_m: 1.1")
    said = refusal(coordinator.load_coordinator, folder / "config/line.yaml")
    assert said.endswith("there are tabs in front of lines: indent with spaces")


@pytest.mark.parametrize(
    ("file", "kind"),
    [
        ("scenarios/line.yaml", "a scenario"),
        ("config/base.yaml", "a configuration of pilotfish-base"),
        ("leaders/three_faces.yaml", "a leader's body"),
        ("fuzzy/coordination.yaml", "a fuzzy controller"),
    ],
)
def test_a_file_of_another_kind_is_said_to_be_one(file, kind):
    said = refusal(coordinator.load_coordinator, shipped.path(file))
    assert f" is missing; this file looks like {kind} (in " in said
    other = refusal(sim.load_scenario, shipped.path("config/line.yaml"))
    assert "this file looks like a coordinator's configuration" in other


@pytest.mark.parametrize("zero", ["0", "0.10", "-0", "0.0e0", "00.5"])
def test_a_zero_before_nothing_or_a_point_is_a_number(folder, zero):
    break_file(folder / "config/line.yaml", r"  bearing_deg: -10\.0", f"  bearing_deg: {zero}")
    bearing_rad = coordinator.load_coordinator(folder / "config/line.yaml").coordinator.setpoint.bearing_rad
    assert bearing_rad == pytest.approx(float(zero) * 3.14159265358979 / 180)


@pytest.mark.parametrize("max_age_s", ["0", "0.001"])
def test_an_age_too_short_for_any_camera_is_at_fault_itself(folder, max_age_s):
    """1.2 frames of the fastest camera, 1000 Hz, take 0.0012 s; of this one, 30 Hz, 0.04 s."""
    break_file(folder / "config/line.yaml", "^setpoint:", f"safety:\n  max_age_s: {max_age_s}\nsetpoint:")
    said = refusal(coordinator.load_coordinator, folder / "config/line.yaml")
    assert said.startswith(f"safety.max_age_s: {max_age_s} is too short: with frame_rate_hz 30 at least 0.04 s")
    assert "at most 0.25" in said


def test_an_age_that_a_faster_camera_would_keep_blames_the_camera(folder):
    break_file(folder / "config/line.yaml", "^setpoint:", "safety:\n  max_age_s: 0.03\nsetpoint:")
    said = refusal(coordinator.load_coordinator, folder / "config/line.yaml")
    assert said.startswith("frame_rate_hz: 30 is too slow: with safety.max_age_s 0.03 at least 40 Hz are needed")


@pytest.mark.parametrize(("facing_deg", "turned"), [(180.0, ""), (-180.0, ""), (180.0, "\n    roll_deg: 90")])
def test_two_tags_in_one_place_that_look_the_same_way_are_refused(folder, facing_deg, turned):
    body = folder / "leaders/three_faces.yaml"
    break_file(body, r"-0\.1196, 0\.1675, 0\.25", "-0.20, 0.0, 0.25")
    break_file(body, r"facing_deg: 130\.0", f"facing_deg: {facing_deg}{turned}")
    said = refusal(coordinator.load_leader_body, body)
    assert said.startswith("leader.tags[1].position_m: tag 1 is where tag 0 is, and looks the same way")


def test_two_sides_of_one_sheet_are_two_places(folder):
    body = folder / "leaders/three_faces.yaml"
    break_file(body, r"-0\.1196, 0\.1675, 0\.25", "-0.20, 0.0, 0.25")
    break_file(body, r"facing_deg: 130\.0", "facing_deg: 0.0")
    assert len(coordinator.load_leader_body(body).tags) == 3


def test_a_leader_of_a_program_is_checked_like_that_of_a_file():
    there = {"size_m": 0.1, "position_m": [0.0, 0.0, 0.2]}
    tags = [core.BodyTag(id=i, **there) for i in (0, 1)]
    said = refusal(lambda: core.LeaderBody(name="twice", family="tag36h11", tags=tags))
    assert said.startswith("leader.tags[1].position_m: tag 1 is where tag 0 is")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (
            OPENCV.replace("cols: 3", "cols: 7"),
            "calibration.camera_matrix.data: holds 9 numbers, not the 21 of rows: 3 and cols: 7",
        ),
        (
            OPENCV.replace("rows: 5", "rows: 4"),
            "calibration.distortion_coefficients.data: holds 5 numbers, not the 4 of rows: 4 and cols: 1",
        ),
        (OPENCV.replace("rows: 5", "rows: 5000000"), "calibration.distortion_coefficients.rows: 5000000 is outside"),
        (OPENCV.replace("cols: 1", "cols: -1"), "calibration.distortion_coefficients.cols: -1 is outside [0, 14]"),
        (OPENCV.replace("   cols: 1\n", ""), "calibration.distortion_coefficients.cols: is missing"),
    ],
)
def test_a_matrix_of_another_size_than_it_says_is_refused(tmp_path, text, says):
    (tmp_path / "camera.yml").write_text(text)
    assert refusal(coordinator.load_calibration, tmp_path / "camera.yml").startswith(says)


def test_a_matrix_that_does_not_say_its_size_is_read(tmp_path):
    text = re.sub(r"   (rows|cols): \d\n", "", OPENCV)
    (tmp_path / "camera.yml").write_text(text)
    assert coordinator.load_calibration(tmp_path / "camera.yml").k3 == 0.005


@pytest.mark.parametrize("key", ["leader", "fuzzy", "tuning"])
@pytest.mark.parametrize("content", ["", "- a\n- list\n", "a: [", "a: 1\n---\nb: 2\n"])
def test_a_file_without_content_is_refused_with_the_key_that_names_it(folder, key, content):
    (folder / "config/empty.yaml").write_text(content)
    config = folder / "config/line.yaml"
    lines = [line for line in config.read_text().splitlines() if not line.startswith(f"{key}:")]
    config.write_text("\n".join([*lines, f"{key}: empty.yaml\n"]))
    assert refusal(coordinator.load_coordinator, config).startswith(f"{key}: {folder / 'config/empty.yaml'} ")


def test_a_fuzzy_file_in_fll_without_an_engine_is_refused_with_the_key_that_names_it(folder):
    (folder / "config/empty.fll").write_text("")
    break_file(folder / "config/line.yaml", "^fuzzy: .*", "fuzzy: empty.fll")
    assert refusal(coordinator.load_coordinator, folder / "config/line.yaml").startswith("fuzzy: two InputVariables")


def run(*options):
    config = shipped.path("config/line.yaml")
    command = [find_executable(COORDINATOR), "--config", config, "--lcm-url", "memq://", *options]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize("content", [None, "", "law: [", "pid"])
def test_a_tuning_on_the_command_line_is_refused_as_that_option(tmp_path, content):
    file = tmp_path / "nothere"
    if content is not None:
        file.write_text(content)
    done = run("--tuning", file)
    assert done.returncode == 78
    assert f"bad configuration: --tuning: {'cannot read ' if content is None else ''}{file}" in done.stderr


def test_a_source_that_ends_with_its_colon_lacks_its_channel(folder):
    done = run("--source", "lcm:")
    assert (done.returncode, "'lcm:' lacks the part after the colon" in done.stderr) == (64, True)
    break_file(folder / "config/line.yaml", "^source: lcm", 'source: "lcm:"')
    command = [find_executable(COORDINATOR), "--config", folder / "config/line.yaml", "--lcm-url", "memq://"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 78
    assert "source: 'lcm:' lacks the part after the colon" in done.stderr

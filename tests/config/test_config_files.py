"""Files that must load, and broken ones that must be refused with the key, the value and what is allowed."""

import math
import re
import shutil
from pathlib import Path

import pytest

from pilotfish import coordinator
from pilotfish import data as shipped

DATA = shipped.path(".")


@pytest.fixture
def folder(tmp_path):
    """A private copy of the shipped data, to be broken."""
    for name in ("config", "fuzzy", "calibrations", "leaders"):
        shutil.copytree(DATA / name, tmp_path / name)
    return tmp_path


def break_file(path: Path, pattern: str, replacement: str) -> None:
    text = path.read_text()
    broken, count = re.subn(pattern, replacement, text, count=1, flags=re.MULTILINE)
    assert count == 1, f"{pattern!r} is not in {path.name}: the test would test nothing"
    path.write_text(broken)


@pytest.mark.parametrize("name", sorted(p.name for p in (DATA / "config").glob("*.yaml") if p.name != "base.yaml"))
def test_every_shipped_configuration_loads(name):
    file = coordinator.load_coordinator(str(DATA / "config" / name))
    assert file.name
    coordinator.Coordinator(file.coordinator)


def test_degrees_become_radians_and_the_frame_rate_sets_the_control_period(folder):
    break_file(folder / "config/line.yaml", "frame_rate_hz: 30", "frame_rate_hz: 20")
    file = coordinator.load_coordinator(str(folder / "config/line.yaml"))
    assert file.coordinator.setpoint.bearing_rad == pytest.approx(math.radians(-10))
    assert file.coordinator.setpoint.distance_m == 1.10
    assert file.coordinator.control.velocity.control_period_s == pytest.approx(1 / 20)


def test_odometry_and_announcements_are_off_unless_asked_for(folder):
    file = folder / "config/line.yaml"
    assert (coordinator.load_coordinator(file).odometry, coordinator.load_coordinator(file).leader_intent_from) == (
        "none",
        "",
    )
    break_file(file, "^source: lcm", "odometry: pose\nleader_intent_from: leader")
    asked = coordinator.load_coordinator(file)
    assert (asked.odometry, asked.leader_intent_from) == ("pose", "leader")
    break_file(file, "^odometry: pose\nleader_intent_from: leader", "odometry: none\nleader_intent_from: none")
    declined = coordinator.load_coordinator(file)
    assert (declined.odometry, declined.leader_intent_from) == ("none", "")


BROKEN = [
    # (what to break, by what, what the message must say)
    (r"^name: \w+", "name: robot 1", r"name: 'robot 1' is not a name"),
    (r"^name: \w+.*", "", r"name: is missing"),
    (r"^frame_rate_hz: 30", "frame_rate_hz: 0", r"frame_rate_hz: 0 is outside \[1, 1000\]"),
    (r"^frame_rate_hz: 30", "frame_rate_hz: fast", r"frame_rate_hz: 'fast' is not a number"),
    (r"^frame_rate_hz: 30", "frame_rate_hz: .nan", r"frame_rate_hz: nan is outside"),
    (r"^source: lcm", "odometry: wheels", r"odometry: 'wheels' is not an odometry; choose none or pose"),
    (r"^source: lcm", "leader_intent_from: the leader", r"leader_intent_from: 'the leader' is not a name"),
    (r"^profile: anticipate", "profile: best", r"profile: 'best' is not a profile; choose paper or anticipate"),
    (r"  distance_m: 1\.10", "  distance_m: -1", r"setpoint\.distance_m: -1 is outside \[0\.05, 20\]"),
    (
        r"  distance_m: 1\.10",
        "  distance: 1.1",
        r"setpoint\.distance: is not a known key here; known: bearing_deg, bearing_rad, distance_m, run",
    ),
    (r"  bearing_deg: -10\.0", "  bearing_deg: 400", r"setpoint\.bearing_deg: 400 is outside \[-70, 70\]"),
    (
        r"  bearing_deg: -10\.0",
        "  bearing_deg: 1\n  bearing_rad: 1",
        r"setpoint\.bearing_deg: is given in radians as well",
    ),
    (
        r"    position_m: \[[^]]*\]",
        "    position_m: [1, 2]",
        r"camera\.mounting\.position_m: needs three numbers, got 2",
    ),
    (r"calibration: .*", "calibration: nowhere.yaml", r"calibration: cannot read .*nowhere\.yaml"),
    (r"^leader: .*", "leader: nowhere.yaml", r"^leader: cannot read .*nowhere\.yaml"),
    (r"^vision:", "visoin:", r"visoin: is not a known key here"),
    (r"^control:", "profile: paper\ncontrol:", r"profile"),
    (
        r"    max_linear_mps: 0\.6",
        "    max_linear_mps: .inf",
        r"control\.limits\.max_linear_mps: inf is outside",
    ),
    (r"    gain_per_s: 2\.0", "    gain_per_s: [2]", r"control\.heading\.gain_per_s: a list is not a number"),
    (r"^setpoint:$", "setpoint: [", r"is not valid YAML"),
]


@pytest.mark.parametrize(("pattern", "replacement", "message"), BROKEN, ids=[b[1].strip() or "no name" for b in BROKEN])
def test_a_broken_configuration_is_refused_with_its_key(folder, pattern, replacement, message):
    path = folder / "config/line.yaml"
    break_file(path, pattern, replacement)
    with pytest.raises(ValueError, match=message) as refused:
        coordinator.load_coordinator(str(path))
    assert str(path) in str(refused.value) or "nowhere.yaml" in str(refused.value)


def test_a_configuration_that_is_not_there_is_refused_with_its_path(tmp_path):
    with pytest.raises(ValueError, match=r"file: cannot read .*missing\.yaml"):
        coordinator.load_coordinator(str(tmp_path / "missing.yaml"))


@pytest.mark.parametrize(
    ("pattern", "replacement", "message"),
    [
        (r"size_m: [\d.]+", "size_m: 0", r"tags\[0\]\.size_m: 0 is outside \[0\.005, 5\]"),
        (r"size_m: [\d.]+", "size_cm: 16", r"tags\[0\]\.size_m: is missing"),
        (r"family: \w+", "family: 36h11", r"'36h11'"),
    ],
)
def test_a_broken_leader_is_refused_with_its_key(folder, pattern, replacement, message):
    break_file(folder / "leaders/three_faces.yaml", pattern, replacement)

    def start():
        coordinator.Coordinator(coordinator.load_coordinator(str(folder / "config/line.yaml")).coordinator)

    with pytest.raises(ValueError, match=message):
        start()


OPENCV = """%YAML:1.0
---
calibration_time: "Sat Nov 21 2026"
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 612.5, 0., 321.25, 0., 611.5, 238.75, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.5e-01, 8.0e-02, 1.0e-03, -2.0e-03, 5.0e-03 ]
avg_reprojection_error: 1.9e-01
"""

VISP = """<?xml version="1.0"?>
<root>
  <camera>
    <name>Camera</name>
    <image_width>640</image_width>
    <image_height>480</image_height>
    <model>
      <type>perspectiveProjWithoutDistortion</type>
      <px>600.1</px> <py>601.2</py> <u0>319.3</u0> <v0>240.4</v0>
    </model>
    <model>
      <type>perspectiveProjWithDistortion</type>
      <px>605.1</px> <py>606.2</py> <u0>318.3</u0> <v0>241.4</v0> <kud>-0.19</kud> <kdu>0.2</kdu>
    </model>
  </camera>
</root>
"""


def test_opencvs_calibration_is_read_as_opencv_writes_it(tmp_path):
    (tmp_path / "camera.yml").write_text(OPENCV)
    camera = coordinator.load_calibration(str(tmp_path / "camera.yml"))
    assert (camera.width, camera.height) == (640, 480)
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (612.5, 611.5, 321.25, 238.75)
    assert (camera.k1, camera.k2, camera.p1, camera.p2, camera.k3) == (-0.25, 0.08, 0.001, -0.002, 0.005)


def test_visps_xml_is_read_with_its_distortion(tmp_path):
    """ViSP's u = u0 + px x (1 + kud r^2) is k1 = kud; the model with distortion is preferred."""
    (tmp_path / "camera.xml").write_text(VISP)
    camera = coordinator.load_calibration(str(tmp_path / "camera.xml"))
    assert (camera.fx, camera.fy, camera.cx, camera.cy, camera.k1) == (605.1, 606.2, 318.3, 241.4, -0.19)
    assert (camera.k2, camera.p1, camera.p2, camera.k3) == (0, 0, 0, 0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (OPENCV.replace("612.5", "nonsense"), r"camera_matrix\.data: 'nonsense' is not a number"),
        (OPENCV.replace("612.5", ".nan"), r"camera\.fx: nan"),
        (OPENCV.replace("image_width: 640\n", ""), r"image_width: is missing"),
        (
            OPENCV.replace("rows: 5", "rows: 8").replace("5.0e-03 ]", "5.0e-03, 0.1, 0.2, 0.3 ]"),
            r"distortion_coefficients: only k1",
        ),
        (VISP.replace("<px>605.1</px>", ""), r"calibration\.px: is missing"),
        (VISP.replace("perspectiveProj", "ProjWithKannalaBrandt"), r"calibration\.model"),
        (VISP.replace("</camera>", "</camera><camera/>"), r"several cameras"),
        ("<root>", r"is not valid XML|no <camera>"),
        ("", r"neither a mapping nor ViSP's XML"),
        ("just words", r"neither a mapping nor ViSP's XML"),
    ],
)
def test_a_broken_calibration_is_refused_with_its_key(tmp_path, text, message):
    (tmp_path / "camera").write_text(text)
    with pytest.raises(ValueError, match=message):
        coordinator.load_calibration(str(tmp_path / "camera"))


def test_the_documented_keys_are_the_keys_that_are_read():
    """docs/configuration.md is what --describe-config prints, from the tables that read and check the file."""
    documented = Path(__file__).parents[2] / "docs" / "configuration.md"
    assert documented.read_text() == coordinator.describe_config()

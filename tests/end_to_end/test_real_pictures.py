"""The onboard program on pictures that were not rendered here: the AprilTag images of Debian's visp-images-data.

They show five tag36h11 tags, each with its true pose cMo_<id>.txt in ViSP's tag frame, which is ours turned by half a
turn about x. Taken together the five are one rigid body, so they can be a leader: its base is put 2 m ahead of the
camera and 0.3 m to the left, looking ahead, and the true poses say where on that body each tag hangs.
"""

import math
import subprocess
from pathlib import Path

import numpy as np
import pytest

from pilotfish import core
from pilotfish import data as shipped
from pilotfish.harness.executables import COORDINATOR, find_executable
from pilotfish.harness.frame_report import parse_reports

IMAGES = Path("/usr/share/visp-images-data/ViSP-images/AprilTag/benchmark")
SIZES_M = {0: 0.2, 1: 0.2, 2: 0.2, 3: 0.1, 4: 0.1}
LEADER_X_M, LEADER_Y_M = 2.0, 0.3


def body_tag(tag_id: int) -> str:
    """One entry of the leader's file. In our frames R = Rz(facing + pi) Ry(tilt) Rx(roll) L, with L the rotation of a
    camera that looks ahead, so facing, tilt and roll are the angles of R L^-1 about z, y and x."""
    bMc = core.CameraMounting().bMc
    oMb = np.eye(4)
    oMb[:2, 3] = -LEADER_X_M, -LEADER_Y_M
    cMt = np.loadtxt(IMAGES / "640x480" / f"cMo_{tag_id}.txt") @ np.diag([1, -1, -1, 1])
    oMt = oMb @ bMc @ cMt
    turned = oMt[:3, :3] @ bMc[:3, :3].T
    facing = math.atan2(turned[1, 0], turned[0, 0]) - math.pi
    tilt = math.asin(-turned[2, 0])
    roll = math.atan2(turned[2, 1], turned[2, 2])
    return (
        f"  - {{id: {tag_id}, size_m: {SIZES_M[tag_id]}, position_m: {oMt[:3, 3].tolist()}, "
        f"facing_rad: {facing}, tilt_rad: {tilt}, roll_rad: {roll}}}\n"
    )


def write_configuration(folder: Path, width: int, height: int, focal_px: float) -> Path:
    (folder / "leader.yaml").write_text(
        "name: five_tags\nfamily: tag36h11\ntags:\n" + "".join(body_tag(tag_id) for tag_id in SIZES_M)
    )
    matrix = [focal_px, 0, width / 2 - 0.5, 0, focal_px, height / 2 - 0.5, 0, 0, 1]
    (folder / "camera.yaml").write_text(
        f"image_width: {width}\nimage_height: {height}\ncamera_matrix: {{data: {matrix}}}\n"
        "distortion_coefficients: {data: [0, 0, 0, 0, 0]}\n"
    )
    config = folder / "coordinator.yaml"
    config.write_text(
        "name: robot1\ncamera: {calibration: camera.yaml}\nleader: leader.yaml\n"
        f"fuzzy: {shipped.path('fuzzy/coordination.yaml')}\nsetpoint: {{distance_m: 1.1, bearing_deg: 0}}\n"
        "control: {guard: {minimum_distance_m: 0.7}}\n"  # the tags lie far from this leader's centre
    )
    return config


@pytest.mark.skipif(not IMAGES.is_dir(), reason="no visp-images-data; scripts/setup installs it")
@pytest.mark.parametrize(("size", "focal_px"), [("640x480", 700.0), ("1920x1080", 2100.0)])
def test_a_leader_of_five_tags_is_measured_on_visps_pictures(tmp_path, size, focal_px):
    width, height = map(int, size.split("x"))
    config = write_configuration(tmp_path, width, height, focal_px)
    pictures = tmp_path / "pictures"
    pictures.mkdir()
    (pictures / "0.png").symlink_to(IMAGES / size / f"tag36_11_{size}.png")
    program = find_executable(COORDINATOR)
    command = [program, "--config", config, "--source", f"images:{pictures}", "--lcm-url", "memq://", "--json"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    (report,) = parse_reports(done.stdout.splitlines())
    assert report.status == "tracking", report.reason
    assert sorted(report.tag_ids) == sorted(SIZES_M)
    # Single tags are good to about 6 mm here (640x480); five of them around the leader can only be better.
    assert report.distance_m == pytest.approx(math.hypot(LEADER_X_M, LEADER_Y_M), abs=0.006)
    assert math.degrees(report.bearing_rad) == pytest.approx(math.degrees(math.atan2(LEADER_Y_M, LEADER_X_M)), abs=0.1)
    assert math.degrees(report.heading_rad) == pytest.approx(0.0, abs=0.2)

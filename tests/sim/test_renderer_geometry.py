"""Where the renderer puts a tag, against ViSP's projection; what hides it."""

import os
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from tag_scenes import (
    BLACK,
    SHARP,
    SIZE_M,
    WHITE,
    body_pose,
    corners_in_camera,
    measured_corners,
    render_tag,
    tag_body,
    tag_pose,
    undistorted,
)

from pilotfish import coordinator, core, sim, vision
from pilotfish import data as shipped

IDEAL = core.CameraModel(width=640, height=480, fx=600, fy=600, cx=319.5, cy=239.5)
VISP_LENS = core.CameraModel(width=640, height=480, fx=600, fy=600, cx=321.3, cy=238.6, k1=-0.12)
OFFSETS = {"centred": (0.0, 0.0), "to the side": (0.17, -0.11)}


@pytest.fixture(scope="module")
def visp(tmp_path_factory):
    """project(camera, points (N, 3)) -> pixels (N, 2), by ViSP, in a program built here."""
    compiler = os.environ.get("CXX") or shutil.which("c++")
    if not compiler or not shutil.which("pkg-config"):
        pytest.skip("needs a C++ compiler and pkg-config")
    program = tmp_path_factory.mktemp("visp") / "visp_projection"
    flags = subprocess.run(["pkg-config", "--cflags", "visp"], check=True, capture_output=True, text=True).stdout
    source = Path(__file__).with_name("visp_projection.cpp")
    subprocess.run(
        [*shlex.split(compiler), "-std=c++17", source, "-o", program, *shlex.split(flags), "-lvisp_core"],
        check=True,
    )

    def project(camera, points):
        intrinsics = f"{camera.fx!r} {camera.fy!r} {camera.cx!r} {camera.cy!r} {camera.k1!r}"
        lines = "".join(f"{intrinsics} {x!r} {y!r} {z!r}\n" for x, y, z in np.asarray(points).tolist())
        answer = subprocess.run([program], input=lines, check=True, capture_output=True, text=True, timeout=60)
        return np.array(answer.stdout.split(), dtype=float).reshape(-1, 2)

    return project


def corner_errors_px(camera, cMt, expected_px):
    """(4,): distance of each corner in the picture from where it should be."""
    image = render_tag(camera, cMt)
    measured = measured_corners(image, camera, expected_px)
    pixels = np.array([camera.project([x, y, 1.0]) for x, y in measured])
    return np.linalg.norm(pixels - expected_px, axis=1)


@pytest.mark.parametrize("camera", [IDEAL, VISP_LENS], ids=["pinhole", "distorted"])
def test_the_projection_of_core_is_visps(visp, camera):
    random = np.random.default_rng(7)
    points = random.uniform([-0.5, -0.4, 1.0], [0.5, 0.4, 3.0], (200, 3))
    ours = np.array([camera.project(point) for point in points])
    assert np.abs(ours - visp(camera, points)).max() < 1e-9


@pytest.mark.parametrize("offset", OFFSETS.values(), ids=OFFSETS)
@pytest.mark.parametrize("yaw_deg", [0, 20, 40, 60, -45])
@pytest.mark.parametrize("distance_m", [0.65, 1.1, 2.44])
@pytest.mark.parametrize("camera", [IDEAL, VISP_LENS], ids=["pinhole", "distorted"])
def test_the_corners_of_a_rendered_tag_are_where_visp_projects_them(visp, camera, distance_m, yaw_deg, offset):
    # Upright and level edges, and then some that cross the pixels at an angle.
    for tilt_deg, roll_deg in ((0, 0), (9, 4), (-12, 30)):
        x_m, y_m = offset
        cMt = tag_pose(distance_m, yaw_deg, tilt_deg, roll_deg, x_m * distance_m, y_m * distance_m)
        errors = corner_errors_px(camera, cMt, visp(camera, corners_in_camera(cMt)))
        assert errors.max() < 0.03


@pytest.mark.parametrize("yaw_deg", [0, 30, 60])
@pytest.mark.parametrize("distance_m", [0.65, 1.1, 2.44])
def test_the_corners_are_right_through_all_five_coefficients_of_distortion(distance_m, yaw_deg):
    # ViSP's model has one coefficient; the others are pinned through core's projection, OpenCV's formula.
    camera = core.CameraModel(
        width=640,
        height=480,
        fx=600,
        fy=595,
        cx=321.3,
        cy=238.6,
        k1=-0.2,
        k2=0.05,
        p1=0.001,
        p2=-0.0015,
        k3=-0.004,
    )
    cMt = tag_pose(distance_m, yaw_deg, 5, 8, 0.15 * distance_m, 0.1 * distance_m)
    expected_px = np.array([camera.project(corner) for corner in corners_in_camera(cMt)])
    assert corner_errors_px(camera, cMt, expected_px).max() < 0.03


def test_a_shift_by_a_fraction_of_a_pixel_moves_an_upright_edge_by_that_fraction():
    # At 1.2 m a pixel is 2 mm wide. Sampling on a grid would show steps here; the area does not.
    for fraction in np.linspace(0, 1, 13):
        cMt = tag_pose(1.2, x_m=0.002 * fraction)
        expected_px = np.array([IDEAL.project(corner) for corner in corners_in_camera(cMt)])
        assert corner_errors_px(IDEAL, cMt, expected_px).max() < 0.005


def test_the_gray_inside_a_cell_is_the_inks_and_the_papers():
    # Head-on at 0.6 m a cell is 20 px wide, and the tag's black border runs from -0.08 to -0.06 m: its middle is
    # at u = 319.5 - 600 * 0.07 / 0.6 = 249.5. The quiet zone's middle is 20 px further out.
    image = render_tag(IDEAL, tag_pose(0.6))
    assert image[240, 249] == BLACK
    assert image[240, 229] == WHITE


def test_a_detector_reads_the_rendered_tag_upright_and_finds_its_corners():
    cMt = tag_pose(1.1, 15, 5, 10)
    image = render_tag(IDEAL, cMt, sim.Imperfections(noise_sigma=1.0, clutter=0.0), tag_id=7)
    found = vision.TagDetector("tag36h11").detect(image).tags
    expected_px = np.array([IDEAL.project(corner) for corner in corners_in_camera(cMt)])
    assert [tag.id for tag in found] == [7]
    assert np.abs(found[0].corners_px - expected_px).max() < 0.5


def box(size_m, gray=110.0):
    return sim.RobotBody(box_size_m=size_m, box_gray=gray)


def looking_at(x_m, y_m=0.0, heading_rad=0.0, height_m=0.0):
    """cMo of a robot whose base is x_m ahead of the camera and y_m to its left."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    bMo = np.array([[c, -s, 0, x_m], [s, c, 0, y_m], [0, 0, 1, height_m], [0, 0, 0, 1]])
    return np.linalg.inv(core.CameraMounting().bMc) @ bMo


def test_a_box_in_front_hides_the_tag_and_one_behind_does_not():
    renderer = sim.Renderer(IDEAL, SHARP)
    tag = (tag_body(), body_pose(tag_pose(1.0)))
    alone = renderer.render([tag])
    behind = renderer.render([tag, (box([0.1, 0.1, 0.1]), looking_at(1.5))])
    before = renderer.render([tag, (box([0.1, 0.1, 0.1]), looking_at(0.6))])
    assert np.array_equal(behind, alone)
    # Its near face is at 0.55 m: 600 * 0.05 / 0.55 = 54.5 px to each side of the middle.
    assert np.all(before[240 - 54 : 240 + 54, 320 - 54 : 320 + 54] == 110)
    # Half of the pixels at 55 px are covered, and beyond everything is as before.
    assert np.array_equal(before[:, : 320 - 56], alone[:, : 320 - 56])


def test_the_order_in_which_bodies_are_given_does_not_matter():
    renderer = sim.Renderer(IDEAL, SHARP)
    scene = [
        (tag_body(), body_pose(tag_pose(1.0, 30))),
        (box([0.2, 0.2, 0.2]), looking_at(1.4, 0.1, 0.5)),
        (box([0.1, 0.1, 0.1], gray=60.0), looking_at(0.7, 0.08, -0.3)),
    ]
    assert np.array_equal(renderer.render(scene), renderer.render(scene[::-1]))


def test_a_tag_on_the_face_of_its_own_box_is_not_hidden_by_it():
    body = sim.RobotBody(box_size_m=[0.3, 0.3, 0.3], white_gray=WHITE, black_gray=BLACK)
    body.leader = core.LeaderBody([core.BodyTag(id=0, size_m=SIZE_M, position_m=[-0.15, 0, 0])])
    on_box = sim.Renderer(IDEAL, SHARP).render([(body, looking_at(1.15))])
    alone = render_tag(IDEAL, tag_pose(1.0))
    # The sheet is 0.2 m wide: 60 px to each side. Its outermost pixels touch the box instead of the wall.
    inner = np.s_[240 - 58 : 240 + 58, 320 - 58 : 320 + 58]
    assert np.array_equal(on_box[inner], alone[inner])


def test_a_tag_seen_from_behind_shows_its_blank_back():
    # Turned by 180 degrees the ink is on the far side.
    image = render_tag(IDEAL, tag_pose(1.0, 180.0))
    sheet = image[240 - 58 : 240 + 58, 320 - 58 : 320 + 58]
    assert np.unique(sheet).size == 1


def test_what_is_behind_the_camera_is_not_drawn():
    renderer = sim.Renderer(IDEAL, SHARP)
    empty = renderer.render([])
    assert np.array_equal(renderer.render([(box([0.2, 0.2, 0.2]), looking_at(-1.0))]), empty)


@pytest.mark.parametrize("x_m", [0.06, 0.1, 0.15, 0.3])
def test_a_tag_that_fills_or_leaves_the_picture_is_cut_at_its_border(x_m):
    # Far outside the picture the polynomial of a strong distortion folds back; nothing may come from there.
    camera = core.CameraModel(width=640, height=480, fx=400, fy=400, cx=320, cy=240, k1=-0.3, k2=0.08)
    image = render_tag(camera, tag_pose(x_m, 40.0, x_m=0.3))
    left_part = image[:, :100]  # the tag is to the right
    assert np.array_equal(left_part, sim.Renderer(camera, SHARP).render([])[:, :100])


def test_every_shipped_leader_can_be_drawn():
    for file in sorted(shipped.path("leaders").glob("*.yaml")):
        scenario = sim.load_scenario(shipped.path("scenarios/line.yaml"))
        body = scenario.robot("leader").body
        body.leader = coordinator.load_leader_body(file)
        image = sim.Renderer(IDEAL, SHARP).render([(body, looking_at(1.5, height_m=-0.25))])
        assert (image == round(body.white_gray)).sum() > 1000


def met_by_rays(tags, rays):
    """Grays (N,) of the nearest sheet along each ray (N, 3), background 128; `tags`: a list of (id, cMt)."""
    gray, nearest = np.full(len(rays), 128.0), np.full(len(rays), np.inf)
    for tag_id, cMt in tags:
        normal, origin = cMt[:3, 2], cMt[:3, 3]
        depth = (normal @ origin) / (rays @ normal)
        on_sheet = (rays * depth[:, None] - origin) @ cMt[:3, :2] / (SIZE_M / 8) + 5  # in cells, from the top left
        hit = np.all((on_sheet > 0) & (on_sheet < 10), axis=1) & (depth > 0) & (depth < nearest)
        column, row = on_sheet[hit].astype(int).T
        cells = vision.TagFamily("tag36h11").bitmap(tag_id)
        gray[hit] = BLACK + (WHITE - BLACK) * cells[row, column] / 255.0
        nearest[hit] = depth[hit]
    return gray


def test_a_pixel_is_the_mean_of_what_the_rays_through_it_meet():
    # Three sheets behind one another, with cells of 1 to 3 pixels, against 24 x 24 rays a pixel.
    camera = core.CameraModel(width=48, height=36, fx=45, fy=45, cx=23.4, cy=18.1, k1=-0.2, k2=0.03, p1=0.01)
    tags = [
        (3, tag_pose(0.45, 50, -10, 25, -0.04, 0.02)),
        (4, tag_pose(0.70, -40, 15, -8, 0.06, -0.05)),
        (5, tag_pose(0.95, 10, 30, 40, 0.05, 0.12)),
    ]
    image = sim.Renderer(camera, SHARP).render([(tag_body(tag_id), body_pose(cMt)) for tag_id, cMt in tags])
    n = 24
    inside = (np.arange(n) + 0.5) / n - 0.5
    v, u, dv, du = np.meshgrid(np.arange(36), np.arange(48), inside, inside, indexing="ij")
    points = undistorted(camera, np.stack([(u + du).ravel(), (v + dv).ravel()], axis=1))
    rays = np.column_stack([points, np.ones(len(points))])
    expected = met_by_rays(tags, rays).reshape(36, 48, n * n).mean(axis=2)
    # An edge along a row of rays is off by up to half a row: 255 / 48 = 5.3 grays, two edges in a pixel by 10.6.
    difference = np.abs(image - expected)
    assert difference.max() < 10.6
    assert difference.mean() < 0.5

"""A camera without any coordinator: one tag in rendered pictures, whose true pose is known."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from PIL import Image
from test_view_page import text, wait_for_text
from view_server import serving

from camera_robot import leader_camera
from fake_camera import NUMBER
from pilotfish import core, data, vision
from pilotfish.coordinator import load_calibration
from pilotfish.view.camera_feed import CameraFeed, assumed_camera, open_source
from pilotfish.view.one_tag import OneTag

SIZE_M, WIDTH, HEIGHT, FOV_DEG = 0.16, 640, 480, 60.0


def tag_picture(range_m, *, tag=7, right_m=0.0):
    """A tag that faces a pinhole camera squarely: a point (X, Y, range) is seen at u = f X / Z + cx. Its cells are then
    upright rectangles, and a pixel's level is the mean over its square, exactly: overlaps along u times those along v.
    No code of the tracker or of its renderer is used."""
    family = vision.TagFamily("tag36h11")
    cells = np.where(np.asarray(family.bitmap(tag)) > 0, 220.0, 30.0)  # with its white border
    f = 0.5 * WIDTH / math.tan(math.radians(FOV_DEG) / 2)
    cell_px = f * SIZE_M / family.cells_at_border / range_m
    edges = (np.arange(len(cells) + 1) - len(cells) / 2) * cell_px
    u = _overlaps(edges + f * right_m / range_m + (WIDTH - 1) / 2, WIDTH)
    v = _overlaps(edges + (HEIGHT - 1) / 2, HEIGHT)
    image = v @ (cells - 150.0) @ u.T + 150.0
    noise = np.random.default_rng(1).normal(0, 1.5, image.shape)
    return np.clip(np.round(image + noise), 0, 255).astype(np.uint8)


def _overlaps(edges, pixels):
    """(pixels, cells): how much of each pixel, which is one wide around its centre, each cell covers."""
    left = np.arange(pixels)[:, None] - 0.5
    return np.clip(np.minimum(left + 1, edges[1:]) - np.maximum(left, edges[:-1]), 0, None)


@pytest.mark.parametrize("range_m", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("tag", [0, 7, 586])
def test_any_one_tag_is_measured_at_its_range_with_the_field_of_view_it_was_taken_with(range_m, tag):
    camera = assumed_camera(WIDTH, HEIGHT, FOV_DEG)
    seen = OneTag(SIZE_M).look(core.Frame(tag_picture(range_m, tag=tag, right_m=0.1), utime=1), camera)
    assert (seen["detected"], [one["id"] for one in seen["tags"]]) == (True, [tag])
    # 0.16 m at 2 m is 44 px wide: sides that are found to 0.02 px on either end give 0.1 % of the range
    assert np.asarray(seen["camera_from_leader"])[:, 3] == pytest.approx([0.1, 0.0, range_m], abs=1e-3 * range_m)


def test_a_tag_that_is_taken_away_is_forgotten_and_another_one_followed():
    camera, follower = assumed_camera(WIDTH, HEIGHT, FOV_DEG), OneTag(SIZE_M)
    nothing = np.random.default_rng(0).integers(120, 130, (HEIGHT, WIDTH), dtype=np.uint8)
    shown = [tag_picture(1.0, tag=3)] * 3 + [nothing] * 20 + [tag_picture(1.0, tag=4)] * 3
    seen = [follower.look(core.Frame(image, utime=33_333 * k), camera) for k, image in enumerate(shown, 1)]
    assert [s["tags"][0]["id"] if s["detected"] else None for s in seen] == [3] * 3 + [None] * 20 + [4] * 3


def test_the_assumed_lens_is_as_wide_as_it_says():
    camera = assumed_camera(1280, 720, 90.0)
    assert camera.fx == camera.fy == pytest.approx(640.0)  # tan(45 deg) = 1: f is half the width
    edge = camera.project(np.array([1.0, 0.0, 1.0]))  # 45 deg to the right
    assert edge[0] == pytest.approx(1279.5)  # the right edge of the last pixel


def test_the_page_shows_a_cameras_tag_and_says_that_its_lens_is_assumed(tmp_path, browser):
    folder = tmp_path / "pictures"
    folder.mkdir()
    for k in range(4):
        Image.fromarray(tag_picture(1.0 + 0.001 * k)).save(folder / f"{k}.png")
    options = ["--camera", f"images:{folder}", "--tag-size", str(SIZE_M)]
    with serving(tmp_path, *options) as server:
        page = browser.open(server.address)
        page.wait_for_selector("#picture[data-tags='7']")
        wait_for_text(page, "#headline", "Tag 7")
        wait_for_text(page, "#lines", "not calibrated: 60° wide is assumed")
        assert re.fullmatch(r"1\.00\d", text(page, "#value-range"))
        # One quantity, one unit: tile, curve, picture and reason say the same.
        wait_for_text(page, ".now[data-column=range_m]", "1.00")
        assert re.fullmatch(r"1\.00\d m", text(page, ".now[data-column=range_m]"))
        assert re.fullmatch(r"1\.00\d m", text(page, "#picture-note"))
        assert re.fullmatch(r"1\.00\d m away", text(page, "#why"))
        # The noise's ± would be a promise about a distance that hangs on an assumption.
        assert text(page, "#tiles > div:first-child small") == "if 60° wide"
        assert "±" not in text(page, "#tiles")
        assert page.is_hidden("#stop")
        assert page.is_hidden("#law-card")
        assert server.post("/api/robots/camera/stop", {})[0] == 404
        assert browser.complaints == []


def test_a_usb_camera_is_opened_while_a_page_watches_and_released_afterwards(tmp_path, browser):
    camera = leader_camera(tmp_path)
    options = ["--camera", str(NUMBER), "--tag-size", "0.16"]
    with serving(tmp_path, *options, prefix=camera.prefix()) as server:
        assert (camera.opens, camera.closes) == (1, 1)  # it was looked whether it can be opened
        page = browser.open(server.address)
        page.wait_for_selector("#picture[data-tags='0'], #picture[data-tags='1'], #picture[data-tags='2']")
        assert (camera.opens, camera.closes) == (2, 1)
        page.close()
        server.child.wait_until(lambda: camera.closes == 2, 10.0, "the camera is released")


def test_a_calibration_is_used_instead_of_an_assumption(tmp_path):
    Image.fromarray(tag_picture(1.0)).save(tmp_path / "0.png")
    file = data.path("calibrations/sim_640x480.yaml")
    feeds = [
        CameraFeed(open_source(f"images:{tmp_path}", camera_file=calibration, fov_deg=None, size="640x480"), SIZE_M)
        for calibration in (file, None)
    ]
    assert [feed.hello()["assumed_fov_deg"] for feed in feeds] == [None, 60.0]
    assert feeds[0]._camera == load_calibration(file)


def test_a_picture_of_another_size_than_the_calibrations_is_said_with_both_sizes():
    seen = OneTag(SIZE_M).look(core.Frame(tag_picture(1.0), utime=1), assumed_camera(1280, 720, FOV_DEG))
    assert (seen["detected"], seen["text"]) == (False, "picture 640 x 480, calibration 1280 x 720")


def test_a_calibration_of_another_size_is_the_headline_with_what_mends_it(tmp_path, browser):
    folder = tmp_path / "pictures"
    folder.mkdir()
    Image.fromarray(tag_picture(1.0)[:360]).save(folder / "0.png")
    calibration = data.path("calibrations/sim_640x480.yaml")
    options = ["--camera", f"images:{folder}", "--tag-size", str(SIZE_M), "--camera-file", calibration]
    with serving(tmp_path, *options) as server:
        page = browser.open(server.address)
        wait_for_text(page, "#headline", "The calibration is of another picture size")
        assert text(page, "#why") == "picture 640 x 360, calibration 640 x 480"
        said = text(page, "#lines")
        assert "pilotfish calibrate camera PICTURES_OF_A_BOARD --board board.yaml --out camera.yaml" in said
        assert "calibrated" not in said  # that it is calibrated would be the opposite

"""`pilotfish leader show` and `check`."""

from __future__ import annotations

import itertools
import math
import re

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image
from typer.testing import CliRunner

from pilotfish import data as shipped
from pilotfish.cli import app
from pilotfish.leader import look_all_round
from pilotfish.plots.leader_picture import draw_leader
from pilotfish.printing import folded_screen

THREE_FACES = shipped.path("leaders/three_faces.yaml")
CONFIG = shipped.path("config/coordinator.yaml")
CALIBRATION = shipped.path("calibrations/sim_640x480.yaml")


def run(*arguments):
    result = CliRunner().invoke(app, ["leader", *(str(argument) for argument in arguments)])
    said = re.sub(r"\x1b\[[0-9;]*m", "", result.output)
    return result, re.sub(r"[\s│]+", " ", said)


@pytest.mark.parametrize(("suffix", "magic"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")])
def test_the_picture_is_of_the_kind_that_its_name_says(tmp_path, suffix, magic):
    picture = tmp_path / "new" / f"leader{suffix}"
    result, said = run("show", THREE_FACES, "--config", CONFIG, "--out", picture)
    assert result.exit_code == 0, said
    assert picture.read_bytes().startswith(magic)
    assert f"wrote {picture}" in said


def test_the_picture_shows_the_tags_the_directions_and_the_words(tmp_path):
    assert run("show", THREE_FACES, "--out", tmp_path / "a.svg")[0].exit_code == 0
    assert run("show", THREE_FACES, "--out", tmp_path / "a.png")[0].exit_code == 0
    image = np.asarray(Image.open(tmp_path / "a.png").convert("RGB")).reshape(-1, 3)
    for colour in ("D55E00", "E69F00", "009E73"):  # no tag, one plane, two planes: each is a part of the ring
        rgb = np.array([int(colour[k : k + 2], 16) for k in (0, 2, 4)])
        assert (np.abs(image.astype(int) - rgb).max(axis=1) < 8).sum() > 500
    # The black cells of tags 0 and 1, seen from the left behind, are the largest dark part of it.
    assert (image.max(axis=1) < 20).mean() > 0.02


def test_check_prints_places_sectors_and_distances_and_ends_with_0_for_a_good_leader():
    result, said = run("check", THREE_FACES, "--config", CONFIG)
    assert result.exit_code == 0
    assert "0 160 -0.200 0.000 0.250 180.0 0.0 0.0 112° to 248°" in said
    # Nearest to farthest: fx = 600 px, cells of 20 mm: 12 m of depth, 0.05 m of the camera and 0.2 m of the tag.
    assert re.search(r" 0 0\.\d\d 5\.2 12\.2 ", said)
    assert "note no tag is seen from 299° to 61°" in said
    assert "followed from" in said


def test_check_ends_with_1_if_something_is_wrong(tmp_path):
    text = THREE_FACES.read_text().replace("[-0.1196, 0.1675, 0.25]", "[-0.1996, 0.05, 0.25]")
    (tmp_path / "odd.yaml").write_text(text)
    result, said = run("check", tmp_path / "odd.yaml")
    assert result.exit_code == 1
    assert "error tags 0 and 1 overlap" in said


@pytest.mark.parametrize(
    ("pattern", "slip", "words"),
    [
        ("id: 2", "id: 1", "leader.tags[2].id: 1 is used twice"),
        ("id: 2", "id: 587", "leader.tags[2].id: 587; tag36h11 has the ids 0 to 586"),
        ("tag36h11", "tag36h12", "leader.family: 'tag36h12' is not a tag family"),
        ("size_m: 0.16", "size_m: 160", "size_m"),
        ("facing_deg: 180.0", "facing: 180.0", "facing_deg"),
        ("name: three_faces", "name: [", "odd.yaml"),
    ],
)
@pytest.mark.parametrize("command", ["check", "show"])
def test_a_file_that_cannot_be_used_ends_with_78_and_names_file_and_key(tmp_path, command, pattern, slip, words):
    (tmp_path / "odd.yaml").write_text(THREE_FACES.read_text().replace(pattern, slip))
    result, said = run(command, tmp_path / "odd.yaml")
    assert result.exit_code == 78
    assert words in said
    assert "odd.yaml" in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["odd.yaml"]


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["check", "nowhere.yaml"], 66, "nowhere.yaml"),
        (["check", THREE_FACES, "--config", CONFIG, "--camera", CALIBRATION], 64, "exclude each other"),
        (["check", THREE_FACES, "--config", CALIBRATION], 78, "sim_640x480.yaml"),
        (["check", THREE_FACES, "--camera", CONFIG], 78, "coordinator.yaml"),
        (["check", THREE_FACES, "--distance-m", "nan"], 64, "nan is not a number from 0.1 to 100 m"),
        (["check", THREE_FACES, "--height-m", "-1"], 64, "-1.0 is not a number from 0 to 10 m"),
        (["show", THREE_FACES, "--out", "leader.gif"], 64, "'leader.gif' ends in none of .png, .svg, .pdf"),
        (["show", THREE_FACES, "--out", f"{THREE_FACES}/a.png"], 74, "Not a directory"),
    ],
)
def test_a_slip_is_named(arguments, code, words):
    result, said = run(*arguments)
    assert result.exit_code == code
    assert words in said


@pytest.mark.parametrize("command", ["show", "check"])
def test_the_help_has_examples_to_copy(command):
    result, said = run(command, "--help")
    assert result.exit_code == 0
    assert f"pilotfish leader {command} data/leaders/three_faces.yaml" in said


def test_a_file_from_elsewhere_cannot_command_the_terminal(tmp_path):
    evil = r"\x1b]0;owned\x07\x9b31m\u202e"  # sets the title, colours, writes from right to left
    (tmp_path / "evil.yaml").write_text(THREE_FACES.read_text().replace("name: three_faces", f'name: "{evil}"'))
    for command in (["check"], ["show", "--out", tmp_path / "a.png"]):
        result = CliRunner().invoke(app, ["leader", command[0], str(tmp_path / "evil.yaml"), *map(str, command[1:])])
        assert not set("\x1b\x07\x9b\u202e") & set(result.output)
        assert r"\x1b]0;owned" in result.output
        assert r"\u202e" in result.output


def words_of(axes):
    """What stands in and around it, with its box in pixels; without the titles of axes, which are turned."""
    FigureCanvasAgg(axes.figure).draw()
    ticks = []
    for axis in axes._axis_map.values():
        low, high = axis.get_view_interval()
        # As they were drawn: get_ticklabels() would place them anew, and in space elsewhere. Others are not drawn.
        ticks += [tick.label1 for tick in axis.majorTicks if low <= tick.get_loc() <= high]
    named = axes.get_legend().get_texts() if axes.get_legend() else []
    texts = [text for text in [*axes.texts, *ticks, *named] if text.get_visible() and text.get_text()]
    return [(text.get_text(), text.get_window_extent()) for text in texts]


@pytest.mark.parametrize("size_m", [0.06, 0.16])
@pytest.mark.parametrize("faces", [1, 3])
def test_no_two_words_of_a_picture_meet(faces, size_m):
    """Of leaders as `pilotfish tags --faces` prints them: small ones before the axes' origin hid its names."""
    body = folded_screen(list(range(faces)), size_m, math.radians(45.0), position_m=(-0.20, 0.0, 0.25))
    for axes in draw_leader(body, look_all_round(body, distance_m=1.1, height_m=0.25)).axes[:2]:
        for (one, box), (other, its_box) in itertools.combinations(words_of(axes), 2):
            assert not box.overlaps(its_box), (one, other)

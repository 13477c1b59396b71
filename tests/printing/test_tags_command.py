"""The command `pilotfish tags`: what it writes, and what it says when something is wrong."""

from __future__ import annotations

import math
import os
import sys

import pytest
from rasters import pages_of, run, words_of

from pilotfish import coordinator
from pilotfish import data as shipped
from pilotfish.printing.paper import parse_paper
from pilotfish.printing.quantities import parse_ids, parse_length_m

THREE_FACES = shipped.path("leaders/three_faces.yaml")


def test_tags_of_several_ids_are_printed(tmp_path):
    result, said = run("tags", "--ids", "0-2,5", "--size", "160mm", "--out", tmp_path / "new" / "tags.pdf")
    assert result.exit_code == 0, said
    assert "4 tags of 160 mm on 4 pages of A4" in said
    assert len(pages_of(tmp_path / "new" / "tags.pdf", 50)) == 4


def test_a_shipped_leader_is_printed(tmp_path):
    result, said = run("tags", "--body", THREE_FACES, "--paper", "letter", "--out", tmp_path / "body.pdf")
    assert result.exit_code == 0, said
    assert "three_faces: 3 tags on 3 pages of Letter" in said
    assert [f"id {k}" in words for k, words in enumerate(words_of(tmp_path / "body.pdf"))] == [True] * 3


def test_a_single_tag_comes_with_its_leader(tmp_path):
    leader = tmp_path / "robot.yaml"
    place = ["--position", "-0.3", "0", "0.4", "--facing-deg", "180", "--tilt-deg", "15"]
    result, said = run("tags", "--ids", "7", "--size", "0.12", "--leader", leader, "--out", tmp_path / "a.pdf", *place)
    assert result.exit_code == 0, said
    body = coordinator.load_leader_body(str(leader))
    (tag,) = body.tags
    assert (body.name, body.family, tag.id, tag.size_m) == ("robot", "tag36h11", 7, 0.12)
    assert tag.position_m == pytest.approx([-0.3, 0, 0.4])
    assert math.degrees(tag.tilt_rad) == pytest.approx(15)
    assert leader.read_text().startswith("# Made by `pilotfish tags` with a.pdf.")


def test_the_written_leader_is_what_a_coordinator_drives_by(tmp_path):
    """The shipped configuration with this leader in place of its own."""
    leader = tmp_path / "robot.yaml"
    assert (
        run("tags", "--faces", "3", "--size", "60mm", "--leader", leader, "--out", tmp_path / "r.pdf")[0].exit_code == 0
    )
    config = shipped.path("config/coordinator.yaml").read_text()
    config = config.replace("../leaders/three_faces.yaml", str(leader))
    config = config.replace("../", f"{shipped.path('config').parent}/")
    (tmp_path / "coordinator.yaml").write_text(config)
    follower = coordinator.Coordinator(coordinator.load_coordinator(str(tmp_path / "coordinator.yaml")).coordinator)
    assert follower is not None
    assert [tag.id for tag in coordinator.load_leader_body(str(leader)).tags] == [0, 1, 2]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "what is to be printed? --ids, --body, --faces or --board"),
        (["--ids", "0-2,x"], "--ids: 'x' in '0-2,x' is neither an id nor a range; write 0-2,5"),
        (["--ids", "5-2"], "--ids: '5-2' runs backward; write 2-5"),
        (["--ids", "1,0-2"], "has id 1 twice"),
        (["--ids", "0-99999"], "more than 2000 tags"),
        (["--ids", ""], "'' in '' is neither an id nor a range"),
        (
            ["--ids", "0", "--size", "0,16"],
            "--size: '0,16' is not a length; a decimal point is '.'; write metres as 0.16, or 160mm",
        ),
        (["--ids", "0", "--size", "160"], "'160' is 160 m; allowed are 0.005 to 5 m; did you mean 160mm?"),
        (["--ids", "0", "--size", "nan"], "--size: 'nan' is not a length"),
        (["--ids", "0", "--size", "1.6.0"], "'1.6.0' is not a length"),
        (["--ids", "0", "--paper", "A9"], "--paper: 'A9' is no paper; known are A4, Letter, A5"),
        (["--ids", "0", "--paper", "50x50mm"], "each side of the paper may have 140 to 5000 mm"),
        (["--ids", "0", "--border-cells", "0.5"], "0.5 is not a number from 1 to 8 cells"),
        (["--ids", "0", "--border-cells", "nan"], "nan is not a number from 1 to 8 cells"),
        (["--ids", "0", "--out", "tags.png"], "--out: 'tags.png' does not end in .pdf"),
        (["--ids", "0", "--leader", "robot.txt"], "--leader: 'robot.txt' ends neither in .yaml"),
        (["--ids", "0,1", "--leader", "robot.yaml"], "where do 2 tags sit? --faces 2 puts them on one folded sheet"),
        (["--ids", "0,1", "--faces", "3"], "--faces 3 needs 3 ids, --ids 0,1 has 2"),
        (["--ids", "0", "--angle-deg", "30"], "--angle-deg cannot be used with --ids without"),
        (["--ids", "0", "--tilt-deg", "30"], "--tilt-deg cannot be used with --ids without --leader"),
        (["--ids", "0", "--square", "30mm"], "--square cannot be used"),
        (["--faces", "13"], "13 is not a number from 1 to 12 faces"),
        (["--faces", "3", "--angle-deg", "200"], "200.0 is not a number from 0 to 180 degrees"),
        (
            ["--faces", "3", "--position", "0", "nan", "0"],
            "--position: (0.0, nan, 0.0) is not three lengths of -10 to 10 m",
        ),
        (["--faces", "3", "--board", "charuco"], "--faces and --board exclude each other"),
        (["--body", str(THREE_FACES), "--size", "0.1"], "--size cannot be used with --body"),
    ],
)
def test_a_wrong_command_line_ends_with_64_and_says_what_is_meant(tmp_path, monkeypatch, options, said):
    monkeypatch.chdir(tmp_path)
    result, printed = run("tags", *options)
    assert result.exit_code == 64
    assert said in printed
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--ids", "0", "--size", "0.2"], "the largest that does is 168 mm. Larger paper: --paper A3"),
        (["--ids", "600"], "has ids 0 to 586, not 600"),
        (["--ids", "0", "--family", "tag1"], "'tag1' is not a tag family; known are tag36h11"),
        (["--faces", "3", "--size", "0.2"], "does not fit on A4"),
        (["--faces", "4", "--angle-deg", "100"], "4 faces can be folded by 0 to 90 degrees each"),
    ],
)
def test_what_cannot_be_printed_ends_with_64_and_says_what_can(tmp_path, monkeypatch, options, said):
    monkeypatch.chdir(tmp_path)
    result, printed = run("tags", *options)
    assert result.exit_code == 64
    assert said in printed
    assert not list(tmp_path.iterdir())


def test_a_leader_file_with_a_slip_is_named(tmp_path):
    text = THREE_FACES.read_text()
    for slip, said in (
        (text.replace("id: 2", "id: 1"), "is used twice"),
        (text.replace("id: 2", "id: 587"), "0 to 586"),
    ):
        (tmp_path / "odd.yaml").write_text(slip)
        result, printed = run("tags", "--body", tmp_path / "odd.yaml", "--out", tmp_path / "a.pdf")
        assert result.exit_code == 78
        assert "leader.tags[2].id: " in printed
        assert "odd.yaml" in printed
        assert said in printed


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written_ends_with_74(tmp_path):
    (tmp_path / "locked").mkdir(mode=0o500)
    result, said = run("tags", "--ids", "0", "--out", tmp_path / "locked" / "a.pdf")
    assert result.exit_code == 74
    assert "Permission denied" in said


def test_a_file_in_the_place_of_a_folder_ends_with_74(tmp_path):
    (tmp_path / "file").write_text("")
    result, said = run("tags", "--ids", "0", "--out", tmp_path / "file" / "a.pdf")
    assert result.exit_code == 74
    assert "Not a directory" in said


def test_without_reportlab_it_says_what_to_install(tmp_path, monkeypatch):
    for module in [name for name in sys.modules if name.split(".")[0] == "reportlab"]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "reportlab", None)
    result, said = run("tags", "--ids", "0", "--out", tmp_path / "a.pdf")
    assert result.exit_code == 69
    assert "pip install 'pilotfish[tags]'" in said


def test_without_opencv_a_charuco_board_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "cv2", None)
    result, said = run("tags", "--board", "charuco", "--out", tmp_path / "a.pdf")
    assert result.exit_code == 69
    assert "pip install 'pilotfish[calibrate]'" in said
    assert run("tags", "--board", "chessboard", "--out", tmp_path / "a.pdf")[0].exit_code == 0


def test_the_help_has_examples_to_copy():
    result, said = run("tags", "--help")
    assert result.exit_code == 0
    for example in ("--ids 0-2,5 --size 0.16", "--body data/leaders/three_faces.yaml", "--faces 3", "--board charuco"):
        assert f"pilotfish tags {example}" in said


@pytest.mark.parametrize("text", ["0.16", "160mm", "16cm", " 0.16 m ", "1.6e-1"])
def test_a_length_can_be_said_in_metres_centimetres_and_millimetres(text):
    assert parse_length_m(text, 0.005, 5.0) == pytest.approx(0.16)


def test_ids_are_read_in_their_order():
    assert parse_ids("5, 0-2 ,9") == [5, 0, 1, 2, 9]


def test_a_paper_is_known_by_its_name_or_its_size():
    assert (parse_paper("a4").width_m, parse_paper("LETTER").height_m) == (0.210, 0.2794)
    assert (parse_paper("600 x 300 mm").width_m, parse_paper("600x300mm").height_m) == (0.6, 0.3)

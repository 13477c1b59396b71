"""Sheets that are folded into a leader: what is on paper, folded by hand, is what the leader's file says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from rasters import PIXEL_MM, dark_spans_mm, find_tags, pages_of, rim, ruler_mm, run, square_mm, words_of

from pilotfish import coordinator, core
from pilotfish import data as shipped
from pilotfish.errors import ConfigError
from pilotfish.printing import body_pages, folded_screen, parse_paper, write_pdf

THREE_FACES = shipped.path("leaders/three_faces.yaml")


def tag(tag_id, size_m, position_m, facing_deg, tilt_deg=0.0, roll_deg=0.0):
    angles = {"facing_rad": facing_deg, "tilt_rad": tilt_deg, "roll_rad": roll_deg}
    radians = {key: math.radians(value) for key, value in angles.items()}
    return core.BodyTag(id=tag_id, size_m=size_m, position_m=position_m, **radians)


def printed(tmp_path, body, paper="A4", **options):
    write_pdf(body_pages(body, parse_paper(paper), **options), tmp_path / "body.pdf", title="body")
    return pages_of(tmp_path / "body.pdf")


def corners_mm(page, corners):
    """(4, 2), bottom left first, of an upright tag, measured to a hundredth of a millimetre."""
    left, top, right, bottom = square_mm(page, corners)
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]])


def fold_lines_mm(page, squares):
    """Where dashed lines cross the gaps between squares that lie side by side: their dashes fill the column
    somewhere."""
    ordered = sorted(squares.values(), key=lambda corners: corners[0, 0])
    found = []
    for left, right in zip(ordered, ordered[1:], strict=False):
        low, high = round((left[1, 0] + 0.5) / PIXEL_MM), round((right[0, 0] - 0.5) / PIXEL_MM)
        # Beside their upper quarters: there are words at the middle.
        top, bottom = round(left[2, 1] / PIXEL_MM), round((0.75 * left[2, 1] + 0.25 * left[1, 1]) / PIXEL_MM)
        (line,) = dark_spans_mm(page[top:bottom, low:high].min(axis=0)) + low * PIXEL_MM
        found.append(line.mean())
    return found


def folded(points_mm, lines_mm, angle_rad):
    """(N, 3) [mm]: flat points (x right, y down) after the sheet was folded back (z away from the reader) at vertical
    lines.

    The part left of the first line stays. At each line, everything to its right is turned back about it by the angle,
    the rightmost line first, so that every line is still where it was printed."""
    points = np.column_stack([points_mm, np.zeros(len(points_mm))])
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    turn = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])  # x towards z
    for line in sorted(lines_mm, reverse=True):
        right = points_mm[:, 0] > line
        axis = np.array([line, 0, 0])
        points[right] = (points[right] - axis) @ turn.T + axis
    return points


def rigid_distance_mm(points, others):
    """The largest distance that remains between two sets of points when one is moved onto the other, without a mirror
    (Kabsch)."""
    a, b = points - points.mean(axis=0), others - others.mean(axis=0)
    u, _, vt = np.linalg.svd(a.T @ b)
    mirror = np.diag([1.0, 1.0, np.sign(np.linalg.det(vt.T @ u.T))])
    return np.linalg.norm(a @ (vt.T @ mirror @ u.T).T - b, axis=1).max()


@pytest.mark.parametrize(
    ("faces", "angle_deg", "size_m", "paper"),
    [
        (2, 40, 0.10, "A4"),
        (3, 45, 0.06, "A4"),
        (3, 30, 0.06, "Letter"),
        (4, 90, 0.05, "A4"),
        (5, 72, 0.04, "Letter"),
        (3, 0, 0.05, "A4"),
    ],
)
def test_the_folded_sheet_is_what_the_leader_s_file_says(tmp_path, faces, angle_deg, size_m, paper):
    leader, pdf = tmp_path / "leader.yaml", tmp_path / "leader.pdf"
    options = ["--faces", faces, "--angle-deg", angle_deg, "--size", size_m, "--paper", paper]
    place = ["--position", "-0.15", "0.02", "0.3", "--facing-deg", "170", "--tilt-deg", "10"]
    result, said = run("tags", *options, *place, "--leader", leader, "--out", pdf)
    assert result.exit_code == 0, said
    (page,) = pages_of(pdf)
    squares = {tag_id: corners_mm(page, corners) for tag_id, corners in find_tags(page).items()}
    assert sorted(squares) == list(range(faces))
    lines = fold_lines_mm(page, squares) if angle_deg else []
    assert len(lines) == (faces - 1 if angle_deg else 0)
    body = coordinator.load_leader_body(str(leader))
    on_paper = np.concatenate([squares[tag.id] for tag in body.tags])
    on_leader_mm = np.concatenate([tag.corners_m for tag in body.tags]) * 1e3
    assert rigid_distance_mm(folded(on_paper, lines, math.radians(angle_deg)), on_leader_mm) < 0.1
    # And it sits where it was said to: the middle tag, or the middle fold, half way between the inner edges of its two
    # tags.
    tags = body.tags
    if faces % 2:
        middle = tags[faces // 2]
        assert middle.position_m == pytest.approx([-0.15, 0.02, 0.3], abs=2e-5)
        assert np.degrees([middle.facing_rad, middle.tilt_rad]) == pytest.approx([170, 10], abs=2e-3)
    else:
        a, b = tags[faces // 2 - 1], tags[faces // 2]
        # The fold is a white border (a cell, size / 8) beyond the black square's right edge on a, and its left edge on
        # b.
        ends = [np.mean(side, axis=0) for side in (a.corners_m[1:3], b.corners_m[[0, 3]])]
        a_end, b_end = (
            end + sign * size_m / 8 * t.oMt[:3, 0] for end, sign, t in zip(ends, (1, -1), (a, b), strict=True)
        )
        assert a_end == pytest.approx([-0.15, 0.02, 0.3], abs=5e-5)
        assert b_end == pytest.approx([-0.15, 0.02, 0.3], abs=5e-5)


def test_the_shipped_leader_unfolds_onto_one_large_sheet(tmp_path):
    """three_faces.yaml is folded by 50 degrees."""
    body = coordinator.load_leader_body(str(THREE_FACES))
    (page,) = printed(tmp_path, body, "640x260mm")
    squares = {tag_id: corners_mm(page, corners) for tag_id, corners in find_tags(page).items()}
    on_paper = np.concatenate([squares[tag.id] for tag in body.tags])
    sheet = folded(on_paper, fold_lines_mm(page, squares), math.radians(50))
    # The file is rounded to 0.1 mm.
    assert rigid_distance_mm(sheet, np.concatenate([tag.corners_m for tag in body.tags]) * 1e3) < 0.2
    assert words_of(tmp_path / "body.pdf")[0].count("50.0° to the back") == 2


def test_a_sheet_that_is_too_large_is_cut_where_its_faces_meet(tmp_path):
    """Tag 0 is in the plane x = -0.2, tag 1 at (-0.1196, 0.1675) looks to 130 degrees, so its plane runs along (sin
    130, -cos 130) = (0.766, 0.643). It meets x = -0.2 after 0.0804 / 0.766 = 0.1050 m, at y = 0.1675 - 0.643 * 0.1050 =
    0.1000: 105 mm to the right of tag 1's centre, 100 mm to the left of tag 0's."""
    pages = printed(tmp_path, coordinator.load_leader_body(str(THREE_FACES)))
    assert len(pages) == 3
    reaches = {}
    for page in pages:
        ((tag_id, corners),) = find_tags(page).items()
        left, top, right, _ = square_mm(page, corners)
        spans = dark_spans_mm(page[round((top + 5) / PIXEL_MM)])
        centre = (left + right) / 2
        reaches[tag_id] = centre - spans[0, 0], spans[-1, 1] - centre
        assert (rim(page) == 255).all()
        assert ruler_mm(page) == pytest.approx(100, abs=0.1)
    # Outer sides are cut where the paper ends, if anywhere: on A4 there is no room for a line.
    assert reaches[0] == pytest.approx((100.0, 100.0), abs=0.15)
    assert reaches[1][1] == pytest.approx(105.0, abs=0.15)
    assert reaches[2][0] == pytest.approx(105.0, abs=0.15)
    said = words_of(tmp_path / "body.pdf")
    assert "edge A: meets id 1, 50.0° to the back" in said[0]
    assert "edge B: meets id 2, 50.0° to the back" in said[0]
    assert "edge A: meets id 0" in said[1]
    assert "edge B: meets id 0" in said[2]


def test_cut_leaves_every_face_on_a_sheet_of_its_own(tmp_path):
    body = folded_screen([3, 4, 5], 0.05, math.radians(60))
    assert len(printed(tmp_path, body)) == 1
    assert [sorted(find_tags(page)) for page in printed(tmp_path, body, fold=False)] == [[3], [4], [5]]


def test_a_closed_box_has_one_edge_that_is_glued(tmp_path):
    printed(tmp_path, folded_screen([0, 1, 2, 3], 0.05, math.radians(90)))
    (said,) = words_of(tmp_path / "body.pdf")
    assert said.count("90.0° to the back") == 3 + 2  # three folds, and both sides of the edge
    assert "edge A: meets id 3" in said
    assert "edge A: meets id 0" in said


def test_a_fold_towards_the_reader_says_so(tmp_path):
    """Two faces of a corner seen from inside: 60 mm tags need 75 mm, so the fold is 37.5 mm from each centre."""
    body = core.LeaderBody([tag(0, 0.06, [0.0375, 0, 0.2], 90), tag(1, 0.06, [0, 0.0375, 0.2], 0)])
    (page,) = printed(tmp_path, body)
    squares = {tag_id: corners_mm(page, corners) for tag_id, corners in find_tags(page).items()}
    assert "90.0° to the front" in words_of(tmp_path / "body.pdf")[0]
    on_paper = np.concatenate([squares[each.id] for each in body.tags])
    bent = folded(on_paper, fold_lines_mm(page, squares), math.radians(-90))
    assert rigid_distance_mm(bent, np.concatenate([each.corners_m for each in body.tags]) * 1e3) < 0.1


def test_tags_in_one_plane_keep_their_distance_on_paper(tmp_path):
    """Side by side with 7 mm between their borders; the second hangs 4 mm lower and is turned by a quarter."""
    body = core.LeaderBody(
        [tag(0, 0.06, [-0.2, 0.041, 0.3], 180), tag(1, 0.06, [-0.2, -0.041, 0.296], 180, roll_deg=90)]
    )
    (page,) = printed(tmp_path, body)
    found = find_tags(page)
    first, second = (np.array(square_mm(page, found[k])).reshape(2, 2).mean(axis=0) for k in (0, 1))
    assert second - first == pytest.approx([82.0, 4.0], abs=0.1)
    # Clockwise as one reads it: what was its bottom left corner is now at the top left.
    assert found[1][0] == pytest.approx(found[1].min(axis=0), abs=0.3)
    assert "°" not in words_of(tmp_path / "body.pdf")[0]


def test_faces_above_each_other_fold_too(tmp_path):
    """A 60 mm tag needs 37.5 mm to its fold. One looks to the rear, the one above it is folded back by 30 degrees."""
    up = 0.25 + 0.0375 + 0.0375 * math.cos(math.radians(30))
    behind = -0.2 + 0.0375 * math.sin(math.radians(30))
    body = core.LeaderBody([tag(0, 0.06, [-0.2, 0, 0.25], 180), tag(1, 0.06, [behind, 0, up], 180, tilt_deg=30)])
    (page,) = printed(tmp_path, body)
    squares = {tag_id: corners_mm(page, corners) for tag_id, corners in find_tags(page).items()}
    assert squares[0].mean(axis=0) - squares[1].mean(axis=0) == pytest.approx([0, 75], abs=0.1)
    assert "30.0° to the back" in words_of(tmp_path / "body.pdf")[0]


def test_beside_a_smaller_face_the_rest_of_the_larger_one_s_side_is_cut(tmp_path):
    """Sheets of 100 and of 50 mm, folded by 90 degrees at 50 and 25 mm from their centres: the larger one's side is
    solid from its top for 25 mm, then dashed for 50 mm, then solid again."""
    body = core.LeaderBody([tag(0, 0.08, [-0.2, 0, 0.25], 180), tag(1, 0.04, [-0.175, 0.05, 0.25], 90)])
    (page,) = printed(tmp_path, body)
    squares = {tag_id: corners_mm(page, corners) for tag_id, corners in find_tags(page).items()}
    (line,) = fold_lines_mm(page, {0: squares[0], 1: squares[1]})
    assert line == pytest.approx(squares[0][0, 0] - 10, abs=0.1)
    spans = dark_spans_mm(page[:, round((line + 0.08) / PIXEL_MM)])  # beside the middle: cut lines are inside the sheet
    spans = spans[spans[:, 1] - spans[:, 0] > 5]
    top = squares[0][2, 1] - 10
    assert spans.ravel() == pytest.approx([top, top + 25, top + 75, top + 100], abs=0.3)


def test_tags_that_do_not_adjoin_are_on_sheets_of_their_own(tmp_path):
    body = core.LeaderBody([tag(0, 0.06, [-0.2, 0, 0.25], 180), tag(1, 0.06, [0, 0.2, 0.25], 90)])
    assert [sorted(find_tags(page)) for page in printed(tmp_path, body)] == [[0], [1]]


@pytest.mark.parametrize("paper", ["A4", "Letter"])
@pytest.mark.parametrize(("faces", "size_m"), [(1, 0.15), (3, 0.06), (3, 0.12), (6, 0.02)])
def test_nothing_is_printed_where_printers_cannot(tmp_path, paper, faces, size_m):
    for page in printed(tmp_path, folded_screen(range(faces), size_m, math.radians(40)), paper):
        assert (rim(page) == 255).all()


@pytest.mark.parametrize("paper", ["140x140mm", "A4"])
@pytest.mark.parametrize("size_m", [0.005, 0.02])
def test_a_long_name_and_small_tags_do_not_run_off_the_page(tmp_path, paper, size_m):
    """And words of neighbours do not meet: each of the twelve labels can be read as a word of its own."""
    body = folded_screen(range(100, 112), size_m, math.radians(20), name="a leader with a name that is too long " * 9)
    for page in printed(tmp_path, body, paper):
        assert (rim(page) == 255).all()
    said = " ".join(words_of(tmp_path / "body.pdf")).split()
    assert [word for word in said if word in {str(k) for k in range(100, 112)}] != []
    assert all(str(k) in said for k in range(100, 112))


def test_a_tag_that_is_larger_than_the_paper_is_refused_with_the_largest():
    with pytest.raises(ConfigError, match=r"size_m of tag 0: its sheet of 250 mm .* A4; the largest .* is 168 mm"):
        body_pages(folded_screen([0], 0.2, 0.0), parse_paper("A4"))


@pytest.mark.parametrize(
    ("faces", "angle_deg", "said"),
    [
        (13, 10, "faces: 13; a leader has 1 to 12"),
        (0, 10, "faces: 0"),
        (5, 73, "0 to 72 degrees each"),
        (2, -1, "-1; 2 faces"),
    ],
)
def test_a_sheet_that_cannot_be_folded_is_refused(faces, angle_deg, said):
    with pytest.raises(ConfigError, match=said):
        folded_screen(range(faces), 0.05, math.radians(angle_deg))

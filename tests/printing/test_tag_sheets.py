"""Sheets of loose tags: printed at true scale, the right patterns, nothing lost at the paper's edge."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from rasters import PIXEL_MM, bits, dark_spans_mm, find_tags, pages_of, rim, ruler_mm, square_mm, words_of

from pilotfish.core import BodyTag, CameraModel, LeaderBody
from pilotfish.errors import ConfigError
from pilotfish.printing import loose_tag_pages, parse_paper, write_pdf
from pilotfish.printing.outline import outline
from pilotfish.printing.tag_sheets import largest_tag_m
from pilotfish.vision import TagFamily, TagMeasurement, TagTracker
from tag_families import FAMILIES


def printed(tmp_path, ids, size_m, paper="A4", **options):
    file = tmp_path / "tags.pdf"
    write_pdf(loose_tag_pages(ids, size_m, parse_paper(paper), **options), file, title="tags")
    return file


@pytest.mark.parametrize("paper", ["A4", "Letter"])
@pytest.mark.parametrize(("ids", "size_mm"), [([0, 5], 160), (range(3), 100), (range(20), 30), (range(6), 33.3)])
def test_a_printed_tag_measures_its_true_size(tmp_path, paper, ids, size_mm):
    seen = []
    for page in pages_of(printed(tmp_path, ids, size_mm / 1e3, paper)):
        for tag_id, corners in find_tags(page).items():
            left, top, right, bottom = square_mm(page, corners)
            assert right - left == pytest.approx(size_mm, abs=0.1)
            assert bottom - top == pytest.approx(size_mm, abs=0.1)
            seen.append(tag_id)
    assert sorted(seen) == list(ids)


@pytest.mark.parametrize("paper", ["A4", "Letter"])
def test_the_ruler_measures_a_hundred_millimetres(tmp_path, paper):
    (page,) = pages_of(printed(tmp_path, [0], 0.05, paper))
    assert ruler_mm(page) == pytest.approx(100.0, abs=0.1)
    assert "This bar is 100.0 mm. If it is not, print at 100 %" in words_of(tmp_path / "tags.pdf")[0]


@pytest.mark.parametrize(
    ("paper", "size_mm"), [("A4", (210, 297)), ("Letter", (215.9, 279.4)), ("600x300mm", (600, 300))]
)
def test_the_page_is_as_large_as_the_paper(tmp_path, paper, size_mm):
    (page,) = pages_of(printed(tmp_path, [0], 0.05, paper))
    assert np.array(page.shape[::-1]) * PIXEL_MM == pytest.approx(np.array(size_mm), abs=1.01 * PIXEL_MM)


@pytest.mark.parametrize("first", [0, 60, 527])
def test_the_bits_are_those_of_the_family(tmp_path, first):
    """The first of 36h11's 587 ids, and its last; compared with libapriltag's own bitmap without its white ring."""
    ids, family = range(first, first + 60), TagFamily("tag36h11")
    seen = set()
    for page in pages_of(printed(tmp_path, ids, 0.02)):
        for tag_id, corners in find_tags(page).items():
            np.testing.assert_array_equal(bits(page, corners), family.bitmap(tag_id)[1:-1, 1:-1] == 0)
            seen.add(tag_id)
    assert seen == set(ids)


@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_is_read_upright_and_at_its_size(tmp_path, family):
    """The detected square of a tag as one reads it: bottom left corner at the bottom left."""
    (page,) = pages_of(printed(tmp_path, [0, 1, 2], 0.025, family=family))
    found = find_tags(page, family)
    assert sorted(found) == [0, 1, 2]
    for corners in found.values():
        # libapriltag's corners are within half a pixel of 150 dpi: 0.08 mm.
        upright = corners[0] + np.array([[0, 0], [25, 0], [25, -25], [0, -25]])
        np.testing.assert_allclose(corners, upright, atol=0.2)


def test_opencv_reads_the_same_ids(tmp_path):
    cv2 = pytest.importorskip("cv2")
    (page,) = pages_of(printed(tmp_path, [3, 14, 15, 92, 65, 358], 0.05), dpi=150)
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11))
    _, ids, _ = detector.detectMarkers(page)
    assert sorted(ids.ravel()) == [3, 14, 15, 65, 92, 358]


def test_the_tracker_fits_its_template_to_the_printed_page(tmp_path):
    """A page is a picture by a camera that looks at it squarely: f = 1000 px at 150 dpi is a distance of 169.3 mm."""
    (page,) = pages_of(printed(tmp_path, [7], 0.08), dpi=150)
    corners = find_tags(np.kron(page, np.ones((4, 4), np.uint8)))[7] * 150 / 25.4 - 0.5
    camera = CameraModel(width=page.shape[1], height=page.shape[0], fx=1000, fy=1000, cx=620, cy=877)
    tracker = TagTracker(camera=camera, body=LeaderBody([BodyTag(id=7, size_m=0.08)]))
    measured = tracker.track(page, tracker.predict_at(7, corners_px=corners))
    assert isinstance(measured, TagMeasurement)
    # The renderer stretches a page of 1240.2 x 1753.9 pixels to whole ones.
    corners_mm = measured.tag.corners_px * np.array([210, 297]) / page.shape[::-1]
    assert np.linalg.norm(np.diff(corners_mm, axis=0), axis=1) == pytest.approx(80.0, abs=0.02)


@pytest.mark.parametrize(
    ("paper", "size_m"),
    [(paper, size_m) for paper in ("A4", "Letter") for size_m in (0.005, 0.03, 0.08, 0.16, 0.168)]
    + [("140x140mm", 0.06), ("A5", 0.1), ("5000x150mm", 0.08)],
)
def test_nothing_is_printed_where_printers_cannot(tmp_path, paper, size_m):
    dpi = 150  # a line of a fiftieth of a millimetre makes a pixel an eighth darker
    for page in pages_of(printed(tmp_path, range(3), size_m, paper), dpi):
        assert (rim(page, dpi=dpi) == 255).all()


@pytest.mark.parametrize("size_m", [0.005, 0.03, 0.16])
def test_every_tag_says_its_id(tmp_path, size_m):
    said = " ".join(words_of(printed(tmp_path, range(40, 46), size_m)))
    for tag_id in range(40, 46):
        assert f"id {tag_id}" in said
    assert f"black squares of {size_m * 1e3:g} mm" in said


def test_the_white_border_is_left_white_and_the_marks_are_where_it_ends(tmp_path):
    """A 40 mm square has cells of 5 mm: with a border of two cells it ends 10 mm outside of the square."""
    (page,) = pages_of(printed(tmp_path, [0], 0.04, border_cells=2.0))
    left, top, right, bottom = square_mm(page, find_tags(page)[0])
    whole = np.round(np.array([left - 9.9, top - 9.9, right + 9.9, bottom + 9.9]) / PIXEL_MM).astype(int)
    black = np.round(np.array([left - 0.1, top - 0.1, right + 0.1, bottom + 0.1]) / PIXEL_MM).astype(int)
    border = page.copy()
    border[black[1] : black[3], black[0] : black[2]] = 255
    assert (border[whole[1] : whole[3], whole[0] : whole[2]] == 255).all()
    # The marks' outer edges are the cut: 3 mm above the border's end for the vertical ones, beside it for the others.
    above = dark_spans_mm(page[round((top - 12.5) / PIXEL_MM)])
    assert above[0, 0] == pytest.approx(left - 10, abs=0.05)
    assert above[-1, 1] == pytest.approx(right + 10, abs=0.05)
    # Those below are under the strip of 5 mm for the id.
    below = dark_spans_mm(page[round((bottom + 10 + 5 + 2.5) / PIXEL_MM)])
    assert below[0, 0] == pytest.approx(left - 10, abs=0.05)
    assert below[-1, 1] == pytest.approx(right + 10, abs=0.05)
    beside = dark_spans_mm(page[:, round((left - 12.5) / PIXEL_MM)])
    beside = beside[(beside[:, 0] > top - 11) & (beside[:, 1] < bottom + 11)]
    assert beside[0, 0] == pytest.approx(top - 10, abs=0.05)
    assert beside[1, 1] == pytest.approx(bottom + 10, abs=0.05)


@pytest.mark.parametrize("paper", ["A4", "Letter", "A3", "150x400mm", "400x150mm"])
@pytest.mark.parametrize("family", ["tag36h11", "tagStandard41h12"])
@pytest.mark.parametrize("border_cells", [1.0, 2.5])
def test_the_largest_tag_fits_and_a_millimetre_more_is_refused_with_it(paper, family, border_cells):
    sheet, options = parse_paper(paper), {"family": family, "border_cells": border_cells}
    largest = largest_tag_m(family, border_cells, sheet)
    assert len(loose_tag_pages([0], largest, sheet, **options)) == 1
    with pytest.raises(ConfigError, match=rf"does not fit on .*; the largest that does is {largest * 1e3:g} mm"):
        loose_tag_pages([0], largest + 0.001, sheet, **options)


def test_the_largest_tag_of_a4_is_the_paper_s_width():
    """210 mm are ten cells, of which the square has eight."""
    assert largest_tag_m("tag36h11", 1.0, parse_paper("A4")) == pytest.approx(0.168)


@pytest.mark.parametrize(
    ("ids", "family", "said"),
    [([587], "tag36h11", "has ids 0 to 586, not 587"), ([0], "tag37h1", "'tag37h1' is not a tag family; known are")],
)
def test_ids_and_families_that_there_are_not_are_refused(ids, family, said):
    with pytest.raises(ConfigError, match=said):
        loose_tag_pages(ids, 0.05, parse_paper("A4"), family=family)


def test_the_same_sheet_is_the_same_file(tmp_path):
    first = printed(tmp_path, range(4), 0.05).read_bytes()
    assert printed(tmp_path, range(4), 0.05).read_bytes() == first


@settings(max_examples=200, deadline=None)
@given(arrays.arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9))))
def test_inside_the_outline_is_what_is_black(black):
    """A ray from the middle of each cell to the left crosses the outline an odd number of times if the cell is
    black."""
    loops = outline(black)
    for row, column in np.ndindex(*black.shape):
        crossings = 0
        for loop in loops:
            for (x0, y0), (x1, y1) in zip(loop, np.roll(loop, -1, axis=0), strict=True):
                assert x0 == x1 or y0 == y1
                crossings += x0 == x1 and x0 < column + 0.5 and min(y0, y1) < row + 0.5 < max(y0, y1)
        assert crossings % 2 == black[row, column]

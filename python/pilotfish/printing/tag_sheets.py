"""Loose tags: as many on a page as fit, each with marks to cut along and its id beside it.

A tag that is larger than the paper is refused. Printing it in parts would join two sheets in the middle of a pattern,
and a joint that is off by half a millimetre is a larger error than the tracker's own; a larger paper has none.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pilotfish.errors import UsageError
from pilotfish.printing.page import (
    FOOTER_M,
    HEADER_M,
    LINE_M,
    TEXT_M,
    Line,
    Page,
    Shape,
    Text,
    cut_line,
    furniture,
    printable_m,
)
from pilotfish.printing.paper import MARGIN_M, Paper
from pilotfish.printing.quantities import millimetres
from pilotfish.printing.tag_art import TagArt, largest_size_m, shape_at, tag_art
from pilotfish.printing.text import first_that_fits

LABEL_M = 0.005  # the strip below a tag for its id
_MARK_M, _MARK_GAP_M = 0.003, 0.001
_GAP_M = 2 * (_MARK_M + _MARK_GAP_M)  # between neighbours: room for both's marks
_UPRIGHT = np.eye(2)


def loose_tag_pages(
    ids: Sequence[int], size_m: float, paper: Paper, *, family: str = "tag36h11", border_cells: float = 1.0
) -> list[Page]:
    """Sheets with these tags, side of the black square size_m, in rows. UsageError if one does not fit on the paper
    (with the largest that does), the family is unknown or does not have an id."""
    arts = [tag_art(family, tag_id, size_m, border_cells) for tag_id in ids]
    if not arts:
        return []
    columns, rows = _grid(arts[0], paper)
    count = columns * rows
    columns = min(columns, len(arts))
    title = f"{family}, black squares of {millimetres(size_m)}"
    if border_cells != 1.0:
        title += f", white border of {border_cells:g} cells"
    groups = [arts[first : first + count] for first in range(0, len(arts), count)]
    return [_page(group, columns, rows, paper, title, f"{k} / {len(groups)}") for k, group in enumerate(groups, 1)]


def _grid(art: TagArt, paper: Paper) -> tuple[int, int]:
    """Columns and rows. The white border may reach into the margin, the ink may not."""
    _, top, _, bottom = _area(paper)
    rows = _count(bottom - top, art.side_m + LABEL_M)
    columns = _count(paper.width_m - 2 * (MARGIN_M + _GAP_M / 2), art.side_m)
    if columns == 0 and art.side_m <= paper.width_m + 1e-9 and art.ink_m <= paper.width_m - 2 * MARGIN_M + 1e-9:
        columns = 1
    if columns * rows == 0:
        raise UsageError(_too_large(art, paper))
    return columns, rows


def _count(room_m: float, side_m: float) -> int:
    return max(int((room_m + _GAP_M + 1e-9) / (side_m + _GAP_M)), 0)


def _too_large(art: TagArt, paper: Paper) -> str:
    largest = largest_tag_m(art.family, art.border_cells, paper)
    return (
        f"--size: a tag of {millimetres(art.size_m)} needs {millimetres(art.side_m)} with its white border and does not"
        f" fit on {paper.name}; the largest that does is {millimetres(largest)}. Larger paper: --paper A3, A2, or"
        f" a size such as --paper 600x600mm for a print shop"
    )


def largest_tag_m(family: str, border_cells: float, paper: Paper) -> float:
    """The largest tag that fits on this paper, to whole millimetres."""
    _, top, _, bottom = _area(paper)
    side_m = min(paper.width_m, bottom - top - LABEL_M)
    return largest_size_m(family, border_cells, side_m, paper.width_m - 2 * MARGIN_M)


def _area(paper: Paper) -> tuple[float, float, float, float]:
    """Where tags may lie, with the room that marks need above and below."""
    left, top, right, bottom = printable_m(paper)
    return left, top + HEADER_M + _GAP_M / 2, right, bottom - FOOTER_M - _GAP_M / 2


def _page(arts: Sequence[TagArt], columns: int, rows: int, paper: Paper, title: str, number: str) -> Page:
    items = furniture(paper, title=title, number=number)
    side = arts[0].side_m
    _, top, _, _ = _area(paper)
    first_x = (paper.width_m - columns * side - (columns - 1) * _GAP_M) / 2
    for k, art in enumerate(arts):
        x, y = first_x + k % columns * (side + _GAP_M), top + k // columns * (side + LABEL_M + _GAP_M)
        items += _tile(art, np.array([x, y]), paper)
    return Page(paper, items)


def _tile(art: TagArt, corner: np.ndarray, paper: Paper) -> list[Shape | Line | Text]:
    """A tag whose white border has its top left corner there, its label below it, its marks around it."""
    side = art.side_m
    middle = corner + side / 2
    items: list[Shape | Line | Text] = [shape_at(art, middle, _UPRIGHT)]
    left = max(corner[0], printable_m(paper)[0])
    label, size = label_text(art, 0.9 * side)
    base = corner[1] + side + LABEL_M / 2 + size / 3
    items.append(Text((float(left + 0.001 if side > 0.03 else left), float(base)), label, size))
    return items + _marks(corner, side, paper)


def label_text(art: TagArt, width_m: float) -> tuple[str, float]:
    """What stands beside a tag, in this width, and its font size."""
    return first_that_fits([f"id {art.id}   {art.family}   {millimetres(art.size_m)}", f"id {art.id}"], TEXT_M, width_m)


def _marks(corner: np.ndarray, side: float, paper: Paper) -> list[Line]:
    """Marks at the corners of the tag with its label, and one more on either side between the two, so that the label
    can be kept or cut off. Where there is no room beside the tag, lines to cut along."""
    left, right = corner[0], corner[0] + side
    heights = corner[1], corner[1] + side, corner[1] + side + LABEL_M
    has_room = left - _MARK_GAP_M - _MARK_M >= MARGIN_M - 1e-9
    lines: list[Line] = []
    down, up = np.array([0.0, 1.0]), np.array([0.0, -1.0])
    for y, inward in zip(heights, (down, up, up), strict=True):
        if not has_room:
            lines += cut_line(paper, np.array([left, y]), np.array([right, y]), inward)
            continue
        for x, outward in ((left, -1), (right, 1)):
            near, far = x + outward * _MARK_GAP_M, x + outward * (_MARK_GAP_M + _MARK_M)
            lines += cut_line(paper, np.array([near, y]), np.array([far, y]), inward)
    for x, inward in ((left, np.array([1.0, 0.0])), (right, np.array([-1.0, 0.0]))):
        for y, outward in ((heights[0], -1), (heights[2], 1)):
            near, far = y + outward * _MARK_GAP_M, y + outward * (_MARK_GAP_M + _MARK_M)
            lines += cut_line(paper, np.array([x, near]), np.array([x, far]), inward)
    return [Line(line.start_m, line.end_m, LINE_M) for line in lines]

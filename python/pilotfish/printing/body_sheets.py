"""The tags of a leader on sheets that fold, or that meet edge to edge, exactly as its file says.

Neighbouring faces stay on one sheet as long as it fits on the paper. Where it does not, each part is cut along the line
in which the faces meet, and the letters on both sides of such a line say which edges belong together.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pilotfish.core import LeaderBody
from pilotfish.errors import UsageError
from pilotfish.printing.folding import SIDES, Joint, Net, Panel, make_nets
from pilotfish.printing.page import (
    FOOTER_M,
    HEADER_M,
    SLACK_M,
    TEXT_M,
    Line,
    Page,
    Text,
    cut_line,
    furniture,
    printable_m,
)
from pilotfish.printing.paper import Paper
from pilotfish.printing.quantities import millimetres
from pilotfish.printing.tag_art import TagArt, shape_at, tag_art
from pilotfish.printing.tag_sheets import LABEL_M, label_text, largest_tag_m
from pilotfish.printing.text import first_that_fits

_SMALLEST_WORDS_M = 0.0012
_LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


def body_pages(body: LeaderBody, paper: Paper, *, border_cells: float = 1.0, fold: bool = True) -> list[Page]:
    """One page a sheet. UsageError if a tag does not fit on the paper, or the family does not have an id.

    fold: False for one sheet a face, cut where the faces meet.
    """
    arts = [tag_art(body.family, tag.id, tag.size_m, border_cells) for tag in body.tags]
    papers = (paper, paper.turned)
    nets = make_nets(
        [tag.oMt for tag in body.tags],
        [art.side_m / 2 for art in arts],
        lambda net: any(_fits(net, arts, turned) for turned in papers),
        join=fold,
    )
    edges = {id(joint): joint for net in nets for joint in net.edges}
    letters = {key: _LETTERS[k % len(_LETTERS)] for k, key in enumerate(edges)}
    pages = []
    for k, net in enumerate(nets, 1):
        on = next((turned for turned in papers if _fits(net, arts, turned)), None)
        if on is None:
            raise UsageError(_too_large(body, arts, net, border_cells, paper))
        pages.append(_page(body, net, arts, on, letters, f"{k} / {len(nets)}"))
    return pages


def _too_large(body: LeaderBody, arts: Sequence[TagArt], net: Net, border_cells: float, paper: Paper) -> str:
    art = arts[net.panels[0].tag]
    largest = millimetres(largest_tag_m(body.family, border_cells, paper))
    return (
        f"size_m of tag {art.id}: its sheet of {millimetres(art.side_m)} with its white border does not fit on"
        f" {paper.name}; the largest tag that does, by itself, is {largest}. Larger paper: --paper A3, A2, or a size"
        f" such as --paper 600x300mm"
    )


def _boxes(net: Net, arts: Sequence[TagArt]) -> tuple[np.ndarray, np.ndarray]:
    """(2, 2) each, low and high corner: of the whole sheet, and of what must have ink."""
    corners = np.concatenate([panel.corners_m() for panel in net.panels])
    ink = [panel.centre_m + sign * arts[panel.tag].ink_m / 2 for panel in net.panels for sign in (-1, 1)]
    ink += [_label_place(net, panel, arts[panel.tag])[0] for panel in net.panels]
    outside = [joint for joint in net.folds if _border_words_m(arts[joint.a]) < _SMALLEST_WORDS_M]
    places = [_beyond_an_end(net, joint) for joint in outside if joint.angle_rad != 0.0]
    ink += [place[0] for place in places if place is not None]
    return np.array([corners.min(axis=0), corners.max(axis=0)]), np.array([np.min(ink, axis=0), np.max(ink, axis=0)])


def _area(paper: Paper) -> np.ndarray:
    left, top, right, bottom = printable_m(paper)
    return np.array([[left, top + HEADER_M], [right, bottom - FOOTER_M]])


def _fits(net: Net, arts: Sequence[TagArt], paper: Paper) -> bool:
    return _origin(net, arts, paper) is not None


def _origin(net: Net, arts: Sequence[TagArt], paper: Paper) -> np.ndarray | None:
    """Where the net's origin lies on the paper; None if it does not fit.

    In the middle of the printable area if the whole sheet fits there. Else, across the paper, the white border may
    reach into the margin, as far as all ink and those edges that meet another sheet stay out of it: their cut must be
    exact.
    """
    area = _area(paper)
    sheet, ink = _boxes(net, arts)
    must = [ink, *(panel.side_m(side) for panel, side in _meeting_sides(net))]
    must_low = np.min([box.min(axis=0) for box in must], axis=0)
    must_high = np.max([box.max(axis=0) for box in must], axis=0)
    paper_size = np.array([paper.width_m, paper.height_m])
    origin = np.zeros(2)
    for k in range(2):
        low, high = area[0, k] - must_low[k], area[1, k] - must_high[k]
        if k == 0:
            low, high = max(low, -sheet[0, k]), min(high, paper_size[k] - sheet[1, k])
        else:
            low, high = max(low, area[0, k] - sheet[0, k]), min(high, area[1, k] - sheet[1, k])
        if low > high + SLACK_M:
            return None
        middle = (area[0, k] + area[1, k] - sheet[0, k] - sheet[1, k]) / 2
        origin[k] = min(max(middle, min(low, high)), max(low, high))
    return origin


def _meeting_sides(net: Net) -> list[tuple[Panel, int]]:
    found = []
    for panel in net.panels:
        for joint in net.edges:
            if joint.a == panel.tag:
                found.append((panel, joint.side_a))
            if joint.b == panel.tag:
                found.append((panel, joint.side_b))
    return found


def _joined_sides(net: Net, panel: Panel) -> set[int]:
    return {joint.side_a for joint in net.folds if joint.a == panel.tag} | {
        joint.side_b for joint in net.folds if joint.b == panel.tag
    }


def _label_place(net: Net, panel: Panel, art: TagArt) -> tuple[np.ndarray, float]:
    """Where a tag's label starts, outside of the sheet: below it as one reads it, or at the next side that is free. And
    the direction of its text: an angle counter-clockwise, in degrees."""
    joined = _joined_sides(net, panel)
    side = next((side for side in (1, 0, 2, 3) if side not in joined), 1)
    outward = panel.axes @ SIDES[side]
    # Text runs to the right of who looks along -outward at its feet: for the side below, outward is down, text to the
    # right.
    along = np.array([outward[1], -outward[0]])
    at = panel.centre_m + outward * (panel.reach_m[side] + LABEL_M * 0.75)
    at = at - along * art.ink_m / 2
    return at, math.degrees(math.atan2(-along[1], along[0]))


def _page(
    body: LeaderBody, net: Net, arts: Sequence[TagArt], paper: Paper, letters: dict[int, str], number: str
) -> Page:
    origin = _origin(net, arts, paper)
    assert origin is not None
    ids = ", ".join(str(arts[panel.tag].id) for panel in net.panels)
    title = f"{body.name}: {body.family}, id {ids}. Cut along gray lines"
    if net.folds:
        title += ", fold along dashed ones"
    items = furniture(paper, title=title, number=number)
    for panel in net.panels:
        art = arts[panel.tag]
        items.append(shape_at(art, origin + panel.centre_m, panel.axes))
        at, turned = _label_place(net, panel, art)
        text, size = label_text(art, art.ink_m)
        items.append(Text(_pair(origin + at), text, size, turned_deg=turned))
        items += _outline(net, panel, origin, paper)
    for joint in net.folds:
        items += _fold(net, joint, origin, arts)
    for joint in net.edges:
        items += _edge_words(net, joint, origin, arts, letters[id(joint)])
    return Page(paper, items)


def _outline(net: Net, panel: Panel, origin: np.ndarray, paper: Paper) -> list[Line]:
    """Lines to cut along, at the sides that are not joined; beside a shorter neighbour, along the rest of the side."""
    joined = _joined_sides(net, panel)
    lines = []
    for side in range(4):
        ends = panel.side_m(side)
        inward = -panel.axes @ SIDES[side]
        for start, end in _uncovered(ends, _neighbour_ends(net, panel, side)) if side in joined else [ends]:
            lines += cut_line(paper, origin + start, origin + end, inward)
    return lines


def _neighbour_ends(net: Net, panel: Panel, side: int) -> np.ndarray:
    for joint in net.folds:
        if (joint.a, joint.side_a) == (panel.tag, side):
            other, its = joint.b, joint.side_b
        elif (joint.b, joint.side_b) == (panel.tag, side):
            other, its = joint.a, joint.side_a
        else:
            continue
        return _panel(net, other).side_m(its)
    raise AssertionError("no neighbour there")


def _shared(ends: np.ndarray, others: np.ndarray) -> tuple[float, float]:
    """The part of a side that it shares with its neighbour's, from 0 to 1."""
    along = ends[1] - ends[0]
    shares = sorted(float((point - ends[0]) @ along / (along @ along)) for point in others)
    return max(shares[0], 0.0), min(shares[1], 1.0)


def _uncovered(ends: np.ndarray, others: np.ndarray) -> list[np.ndarray]:
    first, last = _shared(ends, others)
    pieces = [(0.0, first), (last, 1.0)]
    return [ends[0] + np.outer(piece, ends[1] - ends[0]) for piece in pieces if piece[1] - piece[0] > 1e-3]


def _fold(net: Net, joint: Joint, origin: np.ndarray, arts: Sequence[TagArt]) -> list[Line | Text]:
    """A dashed line, and beside it by how much and to which side it is folded. Nothing between tags in one plane."""
    if joint.angle_rad == 0.0:
        return []
    start, end = _shared_ends(net, joint)
    items: list[Line | Text] = [Line(_pair(origin + start), _pair(origin + end), dashed=True)]
    size = _border_words_m(arts[joint.a])
    if size >= _SMALLEST_WORDS_M:
        items.append(_along(_panel(net, joint.a), joint.side_a, (start + end) / 2, _angle(joint), size, origin))
    elif (place := _beyond_an_end(net, joint)) is not None:
        # Between the middles of both faces, so that the words of neighbouring folds do not meet.
        words, size = first_that_fits([_angle(joint), _angle(joint).split()[0]], TEXT_M, 0.9 * joint.gap_m)
        items.append(Text(_pair(origin + place[0]), words, size, "middle", place[1]))
    return items


def _border_words_m(art: TagArt) -> float:
    """Font size of words in the outer third of a tag's white border; of the border the tag needs the inner half."""
    return min(TEXT_M, 0.25 * art.border_cells * art.cell_m)


def _along(panel: Panel, side: int, at: np.ndarray, text: str, size: float, origin: np.ndarray) -> Text:
    """Words just inside of a side, around a point of it."""
    ends = panel.side_m(side)
    along = ends[1] - ends[0]
    inward = -panel.axes @ SIDES[side]
    turned = math.degrees(math.atan2(-along[1], along[0]))
    return Text(_pair(origin + at + inward * size * 1.1), text, size, "middle", turned)


def _panel(net: Net, tag: int) -> Panel:
    return next(panel for panel in net.panels if panel.tag == tag)


def _angle(joint: Joint) -> str:
    return f"{abs(math.degrees(joint.angle_rad)):.1f}° to the {'back' if joint.angle_rad > 0 else 'front'}"


def _shared_ends(net: Net, joint: Joint) -> tuple[np.ndarray, np.ndarray]:
    panel = _panel(net, joint.a)
    ends = panel.side_m(joint.side_a)
    first, last = (
        ends[0] + share * (ends[1] - ends[0]) for share in _shared(ends, _neighbour_ends(net, panel, joint.side_a))
    )
    return first, last


def _beyond_an_end(net: Net, joint: Joint) -> tuple[np.ndarray, float] | None:
    """Where the words of a fold stand: outside of the sheet at the fold's upper (or left) end, or at the other; None if
    there are panels at both. And the direction of the text, across the fold: an angle counter-clockwise, in degrees."""
    ends = sorted(_shared_ends(net, joint), key=lambda end: tuple(np.round(end[::-1], 6)))
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    is_upright = abs(along[1]) > 0.5
    for end, outward in ((ends[0], -along), (ends[1], along)):
        if any(_contains(panel, end + 0.003 * outward) for panel in net.panels):
            continue
        # Letters stand on the base line: away from the sheet where they point out of it, else a letter's height
        # farther.
        points_outward = outward[1] < -0.5 or outward[0] < -0.5
        return end + outward * (0.0012 if points_outward else 0.0012 + 0.8 * TEXT_M), 0.0 if is_upright else 90.0
    return None


def _contains(panel: Panel, point: np.ndarray) -> bool:
    corners = panel.corners_m()
    return bool((corners.min(axis=0) < point).all() and (point < corners.max(axis=0)).all())


def _edge_words(net: Net, joint: Joint, origin: np.ndarray, arts: Sequence[TagArt], letter: str) -> list[Text]:
    """At an edge that meets another: which, and by which angle; in a narrow border the letter alone."""
    texts = []
    on_net = {panel.tag for panel in net.panels}
    for tag, side, other in ((joint.a, joint.side_a, joint.b), (joint.b, joint.side_b, joint.a)):
        if tag not in on_net:
            continue
        panel, size = _panel(net, tag), _border_words_m(arts[tag])
        text = f"edge {letter}: meets id {arts[other].id}, {_angle(joint)}"
        if size < _SMALLEST_WORDS_M:
            text, size = letter, max(size, 0.001)
        texts.append(_along(panel, side, panel.side_m(side).mean(axis=0), text, size, origin))
    return texts


def _pair(point: np.ndarray) -> tuple[float, float]:
    return float(point[0]), float(point[1])

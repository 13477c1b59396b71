"""A page as data: what is drawn where. Coordinates in metres from the paper's top left corner, x right, y down."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pilotfish.printing.paper import MARGIN_M, Paper
from pilotfish.printing.text import shortened

LINE_M = 0.00015
SLACK_M = 0.0001  # leader files are rounded: an edge may lie so far outside of the printable area
TEXT_M = 0.0026  # font size: 7.4 points
RULER_M = 0.100
_CAPTION = ("This bar is 100.0 mm.", "If it is not, print at", "100 % (actual size).")
_CAPTION_M = 0.0023
_NUMBER_M = 0.020  # room for the page's number beside the title
HEADER_M, FOOTER_M = 0.005, 0.009  # heights of the title and of the ruler, inside the margins


@dataclass(frozen=True)
class Shape:
    """A black area: closed polygons, each (N, 2) [m]; inside is where an odd number of them is (even-odd rule)."""

    loops: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Line:
    """A straight stroke of ``width_m``."""

    start_m: tuple[float, float]
    end_m: tuple[float, float]
    width_m: float = LINE_M
    dashed: bool = False
    gray: float = 0.0  # 0 black, 1 white


@dataclass(frozen=True)
class Text:
    """One line of text; at_m is on its base line, at its left, middle or right end. turned_deg: counter-clockwise."""

    at_m: tuple[float, float]
    text: str
    size_m: float = TEXT_M
    align: Literal["left", "middle", "right"] = "left"
    turned_deg: float = 0.0


@dataclass(frozen=True)
class Page:
    """One sheet of paper."""

    paper: Paper
    items: Sequence[Shape | Line | Text]


def printable_m(paper: Paper) -> tuple[float, float, float, float]:
    """Left, top, right, bottom of what may get ink."""
    return MARGIN_M, MARGIN_M, paper.width_m - MARGIN_M, paper.height_m - MARGIN_M


def furniture(paper: Paper, *, title: str = "", subtitle: str = "", number: str = "") -> list[Shape | Line | Text]:
    """The ruler's bar at the bottom with its caption, a title and the page's number at the top, a subtitle above the
    bar.

    The bar's ends are where its end strokes end, so its length is measured from outside to outside.
    """
    left, top, right, bottom = printable_m(paper)
    y = bottom - 0.003
    half = 0.0002 / 2
    items: list[Shape | Line | Text] = [Line((left, y), (left + RULER_M, y), 0.0004)]
    for mm in range(0, 101, 10):
        tall = 0.003 if mm % 50 == 0 else 0.0018
        x = min(max(left + mm / 1e3, left + half), left + RULER_M - half)
        items.append(Line((x, y - tall), (x, y + (0.003 if mm in (0, 100) else 0.0)), 0.0002))
    beside = left + RULER_M + 0.003
    for lower, line in zip((-0.0032, -0.0004, 0.0024), _CAPTION, strict=True):
        items.append(Text((beside, y + lower), line, _CAPTION_M))
    if title:
        items.append(Text((left, top + TEXT_M), shortened(title, TEXT_M, right - left - _NUMBER_M)))
    if subtitle:
        items.append(Text((left, y - 0.0056), shortened(subtitle, TEXT_M, right - left)))
    if number:
        items.append(Text((right, top + TEXT_M), number, align="right"))
    return items


def cut_line(paper: Paper, start_m: np.ndarray, end_m: np.ndarray, inward: np.ndarray) -> list[Line]:
    """A line to cut along, whose outer edge is the cut, as far as it can be printed: nothing where it cannot.

    start_m, end_m: (2,), parallel to the paper's edges; inward: (2,), unit, towards what is kept.
    """
    left, top, right, bottom = printable_m(paper)
    low, high = np.array([left, top]), np.array([right, bottom])
    along = int(abs(end_m[1] - start_m[1]) > abs(end_m[0] - start_m[0]))
    across = 1 - along
    if not low[across] - SLACK_M <= start_m[across] <= high[across] + SLACK_M:
        return []
    low[across] += LINE_M / 2
    high[across] -= LINE_M / 2
    a, b = (np.clip(point + inward * LINE_M / 2, low, high) for point in (start_m, end_m))
    if abs(b[along] - a[along]) < 1e-4:
        return []
    return [Line((float(a[0]), float(a[1])), (float(b[0]), float(b[1])), gray=0.4)]

"""A page as data: what is drawn where. Coordinates in metres from the paper's top left corner, x right, y down."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pilotfish.printing.paper import MARGIN_M, Paper

LINE_M = 0.00015
SLACK_M = 0.0001  # leader files are rounded: an edge may lie so far outside of the printable area
TEXT_M = 0.0026  # font size: 7.4 points
RULER_M = 0.100
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


def furniture(paper: Paper, titles: Sequence[str]) -> list[Line | Text]:
    """The ruler's bar at the bottom, its caption beside it, and the titles: the first at the top, others in the
    caption.

    The bar's ends are where its end strokes end, so its length is measured from outside to outside.
    """
    left, top, _, bottom = printable_m(paper)
    y = bottom - 0.003
    half = 0.0002 / 2
    items: list[Line | Text] = [Line((left, y), (left + RULER_M, y), 0.0004)]
    for mm in range(0, 101, 10):
        tall = 0.003 if mm % 50 == 0 else 0.0018
        x = min(max(left + mm / 1e3, left + half), left + RULER_M - half)
        items.append(Line((x, y - tall), (x, y + (0.003 if mm in (0, 100) else 0.0)), 0.0002))
    beside = left + RULER_M + 0.003
    items += [
        Text((beside, y - 0.0012), "This bar is 100.0 mm."),
        Text((beside, y + 0.0022), "If it is not, print at 100 % (actual size)."),
    ]
    items += [Text((left, top + TEXT_M), title) for title in titles[:1] if title]
    items += [Text((left, y - 0.0045 - 0.0034 * k), title) for k, title in enumerate(reversed(titles[1:]))]
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

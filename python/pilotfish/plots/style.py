"""One look for all pictures: colours that colour-blind readers can tell apart, sizes, how files are
written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

# Okabe and Ito's palette.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, VERMILLION, PURPLE = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#F0E442",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)
LEADER, FOLLOWER, SETPOINT, STANDING = VERMILLION, BLUE, "#555555", GREEN
TERMS = (BLUE, SKY, GREEN, BLACK, YELLOW, ORANGE, VERMILLION, PURPLE)

DPI = 150
# What stands in an SVG for the colours of the page around it; see inline_svg.py.
PAGE_INK, PAGE_GRID = "#0a0b0c", "#0d0e0f"


@dataclass(frozen=True)
class Theme:
    """What is drawn on what."""

    ink: str  # text, axes, zero lines
    ground: str
    grid: str
    lines: tuple[str, ...]  # one after the other, for curves that are compared


LIGHT = Theme(BLACK, "#FFFFFF", "#DDDDDD", (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY))
DARK = Theme("#E6E6E6", "#16181D", "#3A3D45", (SKY, "#FF8A4C", "#3DDC97", PURPLE, ORANGE, YELLOW))
ON_PAGE = Theme(PAGE_INK, "none", PAGE_GRID, LIGHT.lines)
_SETTINGS = {
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "figure.constrained_layout.use": True,
}


@contextmanager
def style(theme: Theme = LIGHT) -> Iterator[None]:
    """Draw inside ``with style():``; the caller's own settings of matplotlib are left alone."""
    inked = ("text.color", "axes.labelcolor", "axes.edgecolor", "axes.titlecolor", "xtick.color", "ytick.color")
    grounds = ("figure.facecolor", "axes.facecolor", "savefig.facecolor")
    colours = dict.fromkeys(inked, theme.ink) | dict.fromkeys(grounds, theme.ground) | {"grid.color": theme.grid}
    with mpl.rc_context(_SETTINGS | colours):
        yield


def save(figure: Figure, file: str | Path) -> Path:
    """Writes the figure (the suffix says the format) and returns where."""
    file = Path(file)
    file.parent.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context({"savefig.facecolor": "auto"}):  # the figure's own
        figure.savefig(file, dpi=DPI)
    return file

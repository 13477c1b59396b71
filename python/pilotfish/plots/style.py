"""One look for all pictures: colours that colour-blind readers can tell apart, sizes, how files are
written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
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
_SETTINGS = {
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "figure.constrained_layout.use": True,
}


@contextmanager
def style() -> Iterator[None]:
    """Draw inside ``with style():``; the caller's own settings of matplotlib are left alone."""
    with mpl.rc_context(_SETTINGS):
        yield


def save(figure: Figure, file: str | Path) -> Path:
    """Writes the figure (the suffix says the format) and returns where."""
    file = Path(file)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=DPI)
    return file

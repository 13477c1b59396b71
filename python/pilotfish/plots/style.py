"""One style for all pictures: what each colour means, sizes, how files are written.

A colour has one meaning in all pictures of Pilotfish. The eight are Okabe's and Ito's, which colour-blind readers can
tell apart; in gray, and where lines meet, the dash patterns of ``plots/laws.py`` tell them apart.

=============  ==========================================================================================
colour         meaning
=============  ==========================================================================================
blue           law *anticipate*: its errors, its commands, the path of a robot it drives; our trackers likewise
purple         law *paper*, likewise
green          *ViSP's servo* (law ``pbvs``), likewise; ViSP's trackers in the benchmark of vision
vermillion     *PID* (law ``pid``), likewise
sky            any other law, and a robot of whose law nothing is known
orange         what was measured by the camera: dots beside a true value, outlines of tags
ink            the leader, and the fuzzy law itself: what it answers, not what it did (black, white if dark)
gray           setpoints, bands, lines of sight: what is asked for or helps to read
dark to light  a normalised value from -1 to 1 (fuzzy sets, control surface), as its colour bar says
=============  ==========================================================================================
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.colors import Colormap, ListedColormap
from matplotlib.figure import Figure

from pilotfish.whole_files import written_whole

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
SETPOINT = "#555555"

FORMATS = ("png", "svg", "pdf")
DPI = 150


@dataclass(frozen=True)
class Theme:
    """The palette above, by meaning, for one ground; every colour as ``#RRGGBB``."""

    name: str
    ground: str
    ink: str  # text, axes, leader
    guide: str  # setpoints, bands, lines of sight
    grid: str
    anticipate: str
    paper: str
    pbvs: str
    pid: str
    other_law: str
    measured: str
    value_range: tuple[float, float]  # the part of matplotlib's cividis that stands out from the ground

    @property
    def lines(self) -> tuple[str, ...]:
        """Colours in turn, for curves that are compared and of which no law is known."""
        return (self.anticipate, self.pid, self.pbvs, self.paper, self.measured, self.other_law)

    @property
    def values(self) -> Colormap:
        """Colours of normalised values, -1 to 1 as 0 to 1."""
        low, high = self.value_range
        colours = mpl.colormaps["cividis"](low + (high - low) * np.arange(256) / 255)
        return ListedColormap(colours, f"values {self.name}")

    @property
    def settings(self) -> dict[str, object]:
        """matplotlib's settings."""
        texts = ("text.color", "axes.labelcolor", "axes.edgecolor", "xtick.color", "ytick.color")
        grounds = ("figure.facecolor", "axes.facecolor")
        colours = dict.fromkeys(texts, self.ink) | dict.fromkeys(grounds, self.ground)
        return _SETTINGS | colours | {"grid.color": self.grid}


LIGHT = Theme(
    name="light",
    ground="#FFFFFF",
    ink="#000000",
    guide=SETPOINT,
    grid="#DDDDDD",
    anticipate=BLUE,
    paper=PURPLE,
    pbvs=GREEN,
    pid=VERMILLION,
    other_law=SKY,
    measured=ORANGE,
    value_range=(0.0, 0.82),
)
# The same hues, lighter: on #14171A each has a contrast of at least 4.5 to 1 (tested).
DARK = Theme(
    name="dark",
    ground="#14171A",
    ink="#F2F2F2",
    guide="#8A9095",
    grid="#33383D",
    anticipate="#3D9BE0",
    paper="#E39CC6",
    pbvs="#1FC796",
    pid="#FF7A33",
    other_law="#A6DCFF",
    measured="#F5B82E",
    value_range=(0.42, 1.0),
)

# What stands in an SVG for the ink and the grid of the page around it, which replaces them.
PAGE_INK, PAGE_GRID = "#0a0b0c", "#0d0e0f"
ON_PAGE = replace(LIGHT, name="on page", ground="none", ink=PAGE_INK, grid=PAGE_GRID)

_SETTINGS: dict[str, object] = {
    "font.family": ["DejaVu Sans"],
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
    "savefig.facecolor": "auto",  # the figure's own
    "svg.fonttype": "none",  # text stays text: it can be searched, copied and edited
    "svg.hashsalt": "pilotfish",  # the same picture gives the same file
    "pdf.fonttype": 42,
}
_UNDATED = {"png": {}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}


@contextmanager
def style(theme: Theme = LIGHT) -> Iterator[None]:
    """Draw inside ``with style(theme):``; the caller's own settings of matplotlib are left alone."""
    with mpl.rc_context(theme.settings):
        yield


def save(figure: Figure, file: str | Path) -> Path:
    """Writes the figure (the suffix says the format) and returns where."""
    file = Path(file)
    kind = file.suffix[1:].lower()
    with written_whole(file) as partial, mpl.rc_context(_SETTINGS):
        figure.savefig(partial, format=kind, dpi=DPI, metadata=_UNDATED.get(kind))
    return file


def to_png(figure: Figure) -> bytes:
    """The bytes of a PNG file."""
    stream = BytesIO()
    with mpl.rc_context(_SETTINGS):
        figure.savefig(stream, format="png", dpi=DPI)
    return stream.getvalue()

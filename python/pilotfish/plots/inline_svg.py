"""A figure as SVG inside of a page of HTML: it takes over the page's colours, in the light as in the dark."""

from __future__ import annotations

import io
import re

import matplotlib as mpl
from matplotlib.figure import Figure

from pilotfish.plots.style import LIGHT, PAGE_GRID, PAGE_INK, Theme

_PROLOGUE = re.compile(r"^.*?(?=<svg)", re.DOTALL)
_METADATA = re.compile(r"<metadata>.*?</metadata>", re.DOTALL)
_SIZE = re.compile(r'(<svg[^>]*?) width="[^"]*"', re.DOTALL)
_HEIGHT = re.compile(r'(<svg[^>]*?) height="[^"]*"', re.DOTALL)
_LINES = ("anticipate", "paper", "pbvs", "pid", "other_law", "measured")  # colours of Theme
_NAMES = re.compile(r'(\bid="|url\(#|href="#)')


def page_colours(theme: Theme) -> str:
    """The lines' colours as properties of the page's style: what is dark enough on white is not light enough in the
    dark."""
    return " ".join(f"--{line}: {getattr(theme, line)};" for line in _LINES)


def inline_svg(figure: Figure, name: str) -> str:
    """The figure, drawn with ``style(ON_PAGE)``, as one <svg> element. ``name`` tells its ids from other figures'."""
    stream = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": name, "savefig.facecolor": "auto"}):
        figure.savefig(stream, format="svg", metadata={"Date": None})
    text = _METADATA.sub("", _PROLOGUE.sub("", stream.getvalue(), count=1))
    text = _HEIGHT.sub(r"\1", _SIZE.sub(r"\1", text, count=1), count=1)
    text = _NAMES.sub(rf"\g<1>{name}-", text)
    for line in _LINES:
        text = text.replace(getattr(LIGHT, line).lower(), f"var(--{line})")
    return text.replace(PAGE_INK, "currentColor").replace(PAGE_GRID, "var(--grid)").strip()

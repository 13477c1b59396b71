"""What a coordinator was doing, as a band of colours over time: the area of a colour is its share of the time.

A band has some hundred columns. Where one status lasts for a whole column it has all of the height; what is shorter
takes the part of the height that it has of the column's time. Drawn at full height, a gap of 10 ms would be widened to
a pixel, and a run that follows for 99.97 % of the time would look striped.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Rectangle

from pilotfish.logs.run import RobotRun
from pilotfish.plots.status_colours import STATUS_COLOURS, status_colour
from pilotfish.plots.thinned import BREAK_S

COLUMNS = 400  # some two or three pixels each, on a page and in a picture
_WHOLE = 1.0 - 1e-9
_WORDS_SHARE = 0.14  # of the band's width, that "no messages for 12.3 s" takes
_NUMBER_SHARE = 0.05  # and "12.3 s"

Stretch = tuple[float, float, str]  # from [s], to [s], status


@dataclass(frozen=True)
class Piece:
    """A rectangle of one colour; ``bottom`` and ``top`` are 0 to 1 of the band's height."""

    begin_s: float
    end_s: float
    bottom: float
    top: float
    status: str


def status_stretches(run: RobotRun) -> list[Stretch]:
    """(from, to, status): while the same status was sent. From commands, which are sent also when no frame comes."""
    table = run.commands if len(run.commands) else run.frames
    time_s, codes, words = table["t_s"], table["status"], table.words("status")
    if not len(time_s):
        return []
    breaks = (np.diff(codes) != 0) | (np.diff(time_s) > BREAK_S)
    firsts = np.concatenate([[0], np.flatnonzero(breaks) + 1])
    lasts = np.append(firsts[1:], len(time_s)) - 1
    stretches = []
    for first, last in zip(firsts, lasts, strict=True):
        after = min(last + 1, len(time_s) - 1)
        end_s = time_s[after] if time_s[after] - time_s[last] <= BREAK_S else time_s[last]
        stretches.append((float(time_s[first]), float(end_s), str(words[first])))
    return stretches


def band_pieces(stretches: Sequence[Stretch], begin_s: float, end_s: float, columns: int = COLUMNS) -> list[Piece]:
    """The band from ``begin_s`` to ``end_s``, which is cut into ``columns``. Stretches do not overlap.

    Tracking stands below, the others upon it in the protocol's order; a hole without data stays empty."""
    edges_s = np.linspace(begin_s, end_s, columns + 1)
    known = [*STATUS_COLOURS, *sorted({status for *_, status in stretches} - set(STATUS_COLOURS))]
    order = sorted(known, key=lambda status: status != "tracking")
    shares = {status: np.zeros(columns) for status in order}
    for from_s, to_s, status in stretches:
        first = max(0, int(np.searchsorted(edges_s, from_s, side="right")) - 1)
        last = min(columns, int(np.searchsorted(edges_s, to_s, side="left")))
        inside = np.minimum(edges_s[first + 1 : last + 1], to_s) - np.maximum(edges_s[first:last], from_s)
        shares[status][first:last] += np.maximum(inside, 0.0) / (edges_s[1] - edges_s[0])
    pieces: list[Piece] = []
    for column in range(columns):
        bottom = 0.0
        for status in order:
            share = float(shares[status][column])
            if share <= 0.0:
                continue
            top = 1.0 if bottom + share > _WHOLE else bottom + share
            piece = Piece(float(edges_s[column]), float(edges_s[column + 1]), bottom, top, status)
            _append(pieces, piece)
            bottom = top
    return pieces


def silences(stretches: Sequence[Stretch]) -> list[tuple[float, float]]:
    """(from, to): where nothing was sent between two stretches, or nothing of it recorded, for longer than BREAK_S.
    Stretches are in order and do not overlap."""
    return [
        (until_s, from_s)
        for (_, until_s, _), (from_s, _, _) in itertools.pairwise(stretches)
        if from_s - until_s > BREAK_S
    ]


def draw_status_band(
    axes: Axes, stretches: Sequence[Stretch], middle: float, height: float, span_s: tuple[float, float], ink: str
) -> None:
    """Around ``middle`` on the axis of y, from span_s[0] to span_s[1]. Silences are hatched in the colour ``ink``, and
    named where there is room for words."""
    pieces = band_pieces(stretches, *span_s)
    low = middle - height / 2
    corners = []
    for piece in pieces:
        bottom, top = low + height * piece.bottom, low + height * piece.top
        corners.append(
            [(piece.begin_s, bottom), (piece.end_s, bottom), (piece.end_s, top), (piece.begin_s, top)],
        )
    colours = [status_colour(piece.status) for piece in pieces]
    # Neighbours must touch without a seam, which smoothed edges would leave.
    axes.add_collection(PolyCollection(corners, facecolors=colours, linewidths=0, antialiaseds=False))
    for from_s, to_s in silences(stretches):
        _draw_silence(axes, from_s, to_s, low, height, ink, (to_s - from_s) / (span_s[1] - span_s[0]))


def silence_style(ink: str) -> dict[str, Any]:
    """How a patch looks that stands for no messages."""
    return {"facecolor": "none", "edgecolor": ink, "alpha": 0.45, "linewidth": 0.5, "hatch": "////"}


def _draw_silence(axes: Axes, from_s: float, to_s: float, low: float, height: float, ink: str, share: float) -> None:
    """Words instead of the hatching, where there is room: upon it they could not be read."""
    words = f"no messages for {to_s - from_s:.1f} s" if share >= _WORDS_SHARE else f"{to_s - from_s:.1f} s"
    look = silence_style(ink)
    if share >= _NUMBER_SHARE:
        look["hatch"] = None
        axes.text((from_s + to_s) / 2, low + height / 2, words, ha="center", va="center", fontsize=7, color=ink)
    axes.add_patch(Rectangle((from_s, low), to_s - from_s, height, **look))


def _append(pieces: list[Piece], piece: Piece) -> None:
    """Joined with the one before, if together they are one rectangle."""
    before = pieces[-1] if pieces else None
    if before is not None and replace(before, begin_s=before.end_s, end_s=piece.end_s) == piece:
        pieces[-1] = replace(before, end_s=piece.end_s)
        return
    pieces.append(piece)

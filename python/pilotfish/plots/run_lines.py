"""How runs that are compared are told apart: where they do the same, every one of them is seen."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import cycle

from pilotfish.plots.laws import Dashes
from pilotfish.plots.style import Theme

# The first is wide and drawn first; those upon it are narrower and have holes through which it is seen.
_SHAPES: tuple[tuple[Dashes, float], ...] = (
    ("-", 2.6),
    ((0.0, (5.0, 3.5)), 1.3),
    ((0.0, (1.5, 2.5)), 1.3),
    ((0.0, (7.0, 2.5, 1.5, 2.5)), 1.1),
)
_ALONE_PT = 1.2


def run_lines(names: Iterable[str], theme: Theme) -> dict[str, dict[str, object]]:
    """Arguments of Axes.plot by the run's name, in the given order."""
    names = list(names)
    shapes: Iterable[tuple[Dashes, float]] = cycle(_SHAPES) if len(names) > 1 else [("-", _ALONE_PT)]
    return {
        name: {"color": colour, "linestyle": dashes, "linewidth": width_pt}
        for name, colour, (dashes, width_pt) in zip(names, cycle(theme.lines), shapes, strict=False)
    }

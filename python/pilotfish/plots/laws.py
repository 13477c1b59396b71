"""How each law is named and drawn, in every picture alike."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from pilotfish.law_names import law_name
from pilotfish.plots.style import LIGHT, Theme

Dashes = tuple[float, tuple[float, ...]] | str

# Where two laws do the same their lines meet: the wide one is drawn first, the dashed ones upon it, the dots last.
_LINES: dict[str, tuple[Dashes, float, float]] = {
    "anticipate": ("-", 2.6, 2.1),
    "paper": ((0.0, (7.0, 2.0)), 1.8, 2.2),
    "pbvs": ((0.0, (6.0, 1.5, 1.5, 1.5)), 1.8, 2.3),
    "pid": ((0.0, (1.5, 1.5)), 1.6, 2.4),
}
_OTHER_DASHES: tuple[Dashes, ...] = ("-", (0.0, (4.0, 1.5)), (0.0, (2.5, 2.5)), (0.0, (8.0, 1.5, 1.5, 1.5, 1.5, 1.5)))


@dataclass(frozen=True)
class LawStyle:
    """One law's line."""

    label: str
    colour: str
    dashes: Dashes
    width_pt: float
    zorder: float

    def line(self, **changes: object) -> dict[str, object]:
        """Arguments of Axes.plot."""
        own = {"color": self.colour, "linestyle": self.dashes, "linewidth": self.width_pt, "zorder": self.zorder}
        return {**own, "label": self.label, **changes}


def law_colour(law: str, theme: Theme = LIGHT) -> str:
    """The law's colour; that of "any other" for a law that is not known."""
    return str(getattr(theme, law)) if law in _LINES else theme.other_law


def law_styles(laws: Iterable[str], theme: Theme = LIGHT) -> dict[str, LawStyle]:
    """By the law's name, in the given order; laws that are not known differ by their dashes."""
    laws = list(laws)
    others = [law for law in laws if law not in _LINES]
    lines = _LINES | {law: (_OTHER_DASHES[k % len(_OTHER_DASHES)], 1.8, 2.5) for k, law in enumerate(others)}
    return {law: LawStyle(law_name(law), law_colour(law, theme), *lines[law]) for law in laws}

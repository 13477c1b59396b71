"""One colour a status, on white and on dark grounds."""

from __future__ import annotations

from pilotfish.plots.style import GREEN, ORANGE, PURPLE, SKY, VERMILLION

STATUS_COLOURS = {
    "searching": SKY,
    "tracking": GREEN,
    "coasting": ORANGE,
    "lost": VERMILLION,
    "stopped": "#999999",
    "invalid_input": PURPLE,
}
_ON_DARK = {"tracking": "#3DDC97", "lost": "#FF8A4C"}


def status_colour(status: str, *, dark: bool = False) -> str:
    """Gray for a status that is not known."""
    colour = STATUS_COLOURS.get(status, "#BBBBBB")
    return _ON_DARK.get(status, colour) if dark else colour

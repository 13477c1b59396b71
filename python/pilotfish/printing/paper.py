"""Sizes of paper, and the border that no printer can print on."""

from __future__ import annotations

import re
from dataclasses import dataclass

MARGIN_M = 0.005  # kept white on all sides: what office printers cannot print on is 3 to 4.3 mm wide
_SMALLEST_M = 0.140  # so that the ruler's bar of 100 mm, its caption and the margins fit
_LARGEST_M = 5.0  # PDF readers stop at 14 400 points: 5.08 m


@dataclass(frozen=True)
class Paper:
    """A sheet, upright (portrait) or not: width_m, height_m."""

    name: str
    width_m: float
    height_m: float

    @property
    def turned(self) -> Paper:
        """The same sheet, turned by 90 degrees."""
        return Paper(self.name, self.height_m, self.width_m)


PAPERS = {
    "A4": Paper("A4", 0.210, 0.297),
    "Letter": Paper("Letter", 0.2159, 0.2794),
    "A5": Paper("A5", 0.148, 0.210),
    "A3": Paper("A3", 0.297, 0.420),
    "Tabloid": Paper("Tabloid", 0.2794, 0.4318),
    "A2": Paper("A2", 0.420, 0.594),
    "A1": Paper("A1", 0.594, 0.841),
    "A0": Paper("A0", 0.841, 1.189),
}


def parse_paper(text: str) -> Paper:
    """'A4', 'letter', or width x height as '600x300mm'. ValueError on others."""
    for name, paper in PAPERS.items():
        if name.lower() == text.strip().lower():
            return paper
    match = re.fullmatch(r"\s*([\d.]+)\s*x\s*([\d.]+)\s*mm\s*", text)
    try:
        width_m, height_m = (float(number) / 1e3 for number in match.groups()) if match else (0.0, 0.0)
    except ValueError:
        match = None
    if not match:
        raise ValueError(f"'{text}' is no paper; known are {', '.join(PAPERS)}, or a size as 600x300mm")
    if not (min(width_m, height_m) >= _SMALLEST_M and max(width_m, height_m) <= _LARGEST_M):
        low, high = _SMALLEST_M * 1e3, _LARGEST_M * 1e3
        raise ValueError(f"'{text}': each side of the paper may have {low:g} to {high:g} mm")
    return Paper(f"{width_m * 1e3:g} x {height_m * 1e3:g} mm", width_m, height_m)

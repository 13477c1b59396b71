"""Figures as text."""

from __future__ import annotations

import math


def mm(value: float, sign: str = "") -> str:
    return "-" if math.isnan(value) else f"{value:{sign}.2f} mm" if abs(value) < 10 else f"{value:{sign}.0f} mm"


def ms(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3f} ms" if value < 1 else f"{value:.1f} ms"


def percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{100 * share:.1f} %"


def fraction(ratio: float) -> str:
    """0.005 is "1/200": what is much smaller is read as a part."""
    if math.isnan(ratio):
        return "-"
    return f"1/{1 / ratio:.0f}" if 0 < ratio < 0.1 else f"{ratio:.2f}"

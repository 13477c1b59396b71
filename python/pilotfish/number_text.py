"""Numbers as tables and pictures show them."""

from __future__ import annotations


def signed(value: float, digits: int) -> str:
    """With its sign and so many decimals; what rounds to zero has no sign ("0.0", never "-0.0")."""
    text = f"{value:+.{digits}f}"
    return text[1:] if float(text) == 0.0 else text


def millimetres(value_m: float) -> str:
    """A length given in metres, as "+167 mm" or "-2.5 mm": tenths only where they matter."""
    value_mm = 1000.0 * value_m
    return f"{signed(value_mm, 0 if abs(value_mm) >= 10.0 else 1)} mm"

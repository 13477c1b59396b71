"""Lines of text: what the standard fonts of PDF can say, how wide it is, and what of it fits."""

from __future__ import annotations

from pilotfish.extras import require

FONT = "Helvetica"


def printable_text(text: str) -> str:
    """With '?' for what the standard fonts of PDF do not have."""
    return text.encode("cp1252", "replace").decode("cp1252")


def text_width_m(text: str, size_m: float) -> float:
    """Width of a line of text."""
    metrics = require("reportlab.pdfbase.pdfmetrics", "tags")
    return metrics.stringWidth(printable_text(text), FONT, size_m)


def shortened(text: str, size_m: float, width_m: float) -> str:
    """As much of it as fits, with '...' for the rest."""
    if text_width_m(text, size_m) <= width_m:
        return text
    while text and text_width_m(f"{text}...", size_m) > width_m:
        text = text[:-1]
    return f"{text.rstrip()}..."


def first_that_fits(texts: list[str], size_m: float, width_m: float) -> tuple[str, float]:
    """The first of several ways to say it that fits at this size, and the size; else the last one, as small as it
    needs."""
    for text in texts:
        if text_width_m(text, size_m) <= width_m:
            return text, size_m
    return texts[-1], size_m * width_m / text_width_m(texts[-1], size_m)

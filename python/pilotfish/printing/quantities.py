"""Lengths and lists of ids as people type them. ValueError says what is wrong and what is meant."""

from __future__ import annotations

import math
import re

_UNITS_M = {"": 1.0, "m": 1.0, "cm": 1e-2, "mm": 1e-3}
_MOST_IDS = 2000  # in one file


def parse_length_m(text: str, low_m: float, high_m: float) -> float:
    """'0.16', '0.16m', '16cm' and '160mm' are 0.16 metres; from low_m to high_m."""
    match = re.fullmatch(r"\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(m|cm|mm)?\s*", text)
    try:
        value_m = float(match[1]) * _UNITS_M[match[2] or ""] if match else math.nan
    except ValueError:
        value_m = math.nan
    if math.isnan(value_m):
        comma = "; a decimal point is '.'" if "," in text else ""
        raise ValueError(f"'{text}' is not a length{comma}; write metres as 0.16, or 160mm, or 16cm")
    if not low_m <= value_m <= high_m:
        note = f"; did you mean {text.strip()}mm?" if low_m <= value_m / 1000 <= high_m else ""
        raise ValueError(f"'{text}' is {value_m:g} m; allowed are {low_m:g} to {high_m:g} m{note}")
    return value_m


def parse_ids(text: str) -> list[int]:
    """'0-2,5' is [0, 1, 2, 5]; every id once."""
    ids: list[int] = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*(\d{1,6})\s*(?:-\s*(\d{1,6})\s*)?", part)
        if not match:
            raise ValueError(f"'{part.strip()}' in '{text}' is neither an id nor a range; write 0-2,5")
        first, last = int(match[1]), int(match[2] or match[1])
        if last < first:
            raise ValueError(f"'{part.strip()}' runs backward; write {last}-{first}")
        if len(ids) + last - first + 1 > _MOST_IDS:
            raise ValueError(f"'{text}' are more than {_MOST_IDS} tags; print them into several files")
        ids += range(first, last + 1)
    twice = sorted({tag_id for tag_id in ids if ids.count(tag_id) > 1})
    if twice:
        raise ValueError(f"'{text}' has id {twice[0]} twice; two tags of one id in one picture cannot be told apart")
    return ids


def millimetres(length_m: float) -> str:
    """0.16 is '160 mm', 0.0225 is '22.5 mm'."""
    return f"{round(length_m * 1e3, 3):g} mm"

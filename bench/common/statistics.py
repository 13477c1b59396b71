"""Figures of what was measured."""

from __future__ import annotations

import math


def quantile(values: list[float], share: float) -> float:
    """The least value that `share` of the values do not exceed; infinite without values."""
    ordered = sorted(values)
    return ordered[max(math.ceil(share * len(ordered)), 1) - 1] if ordered else math.inf

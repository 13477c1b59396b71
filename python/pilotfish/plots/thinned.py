"""Curves of any length with as many points as a picture can show, and broken where there is no data."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BREAK_S = 0.5  # a longer silence is not bridged by a line
BUCKETS = 1500


def thinned(time_s: FloatArray, values: FloatArray, buckets: int = BUCKETS) -> tuple[FloatArray, FloatArray]:
    """At most 2 ``buckets`` points and one NaN a break: of every bucket of samples the least and the greatest, in the
    order of time, so that no peak is lost. Shapes (N,) become (M,)."""
    time_s, values = np.asarray(time_s, float), np.asarray(values, float)
    known = np.isfinite(values)
    kept = _extremes(values, known, buckets) if len(values) > 2 * buckets else np.arange(len(values))
    # A break: NaN samples were between two kept ones, or nothing at all for too long.
    unknown = np.concatenate([[0], np.cumsum(~known)])
    kept = kept[known[kept]]
    silent = np.concatenate([[0], np.cumsum(np.diff(time_s) > BREAK_S)]) if len(time_s) else np.zeros(0)
    broken = (np.diff(unknown[kept]) > 0) | (np.diff(silent[kept]) > 0)
    at = np.flatnonzero(broken) + 1
    return np.insert(time_s[kept], at, np.nan), np.insert(values[kept], at, np.nan)


def alone(time_s: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Of a thinned curve the samples between two breaks, of which a line shows nothing: to be drawn as dots."""
    known = np.concatenate([[False], np.isfinite(values), [False]])
    single = known[1:-1] & ~known[:-2] & ~known[2:]
    return time_s[single], values[single]


def _extremes(values: FloatArray, known: NDArray[np.bool_], buckets: int) -> NDArray[np.intp]:
    edges = np.linspace(0, len(values), buckets + 1).astype(int)
    kept: set[int] = set()
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        inside = np.flatnonzero(known[begin:end])
        if inside.size:
            part = values[begin:end][inside]
            kept |= {int(begin + inside[part.argmin()]), int(begin + inside[part.argmax()])}
    return np.array(sorted(kept), dtype=np.intp)

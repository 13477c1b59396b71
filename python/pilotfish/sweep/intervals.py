"""Means with intervals of confidence, along a factor."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import stats

from pilotfish.sweep.results import Results

CONFIDENCE = 0.95
_RESAMPLES = 2000
_BINS, _MOST_VALUES = 12, 24


@dataclass(frozen=True)
class Interval:
    """A mean, and between which values that of very many runs lies with a confidence of 95 %; NaN if one run does not
    tell."""

    mean: float
    low: float
    high: float
    count: int


def t_interval(values: np.ndarray) -> Interval:
    """mean -+ t s / sqrt(n), with t of n - 1 degrees of freedom and s the sample's standard deviation: exact if the
    runs scatter normally, and near it for means of many."""
    count = len(values)
    if not count:
        return Interval(math.nan, math.nan, math.nan, 0)
    mean = float(values.mean())
    if count < 2:
        return Interval(mean, math.nan, math.nan, count)
    half = float(stats.t.ppf(0.5 + CONFIDENCE / 2, count - 1) * values.std(ddof=1) / math.sqrt(count))
    return Interval(mean, mean - half, mean + half, count)


def bootstrap_interval(values: np.ndarray) -> Interval:
    """Percentiles of the means of 2000 resamples (Efron), seeded: of any distribution, but too narrow for few runs."""
    count = len(values)
    if count < 2:
        return t_interval(values)
    random = np.random.default_rng(1)
    means = np.array([values[random.integers(0, count, count)].mean() for _ in range(_RESAMPLES)])
    low, high = np.quantile(means, [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2])
    return Interval(float(values.mean()), float(low), float(high), count)


INTERVALS: dict[str, Callable[[np.ndarray], Interval]] = {"t": t_interval, "bootstrap": bootstrap_interval}


@dataclass(frozen=True)
class Curve:
    """One line of a plot. ``x`` are numbers, or texts where the factor's values are."""

    name: str
    x: np.ndarray
    intervals: list[Interval]


def curves(results: Results, metric: str, over: str, by: str | None = None, interval: str = "t") -> list[Curve]:
    """A curve for each value of ``by``. A factor with many values (one that was sampled) is put together in twelve
    groups of equally many runs, each drawn at its mean. Runs without the figure do not count."""
    values = results.metric(metric)
    _, x = results.factor(over)
    groups = results.factor(by)[1] if by else np.full(len(results), "")
    numbers = x.dtype.kind in "fi"
    known = np.isfinite(values) & (np.isfinite(x) if numbers else True)
    edges = _edges(x[known]) if numbers else None
    drawn = []
    for group in dict.fromkeys(groups[known].tolist()):
        mask = known & (groups == group)
        place = np.digitize(x[mask], edges) if edges is not None else x[mask]
        kept = list(dict.fromkeys(place.tolist())) if not numbers else np.unique(place)
        at = [x[mask][place == each].mean() if numbers else each for each in kept]
        spread = [INTERVALS[interval](values[mask][place == each]) for each in kept]
        drawn.append(Curve(_text(group), np.array(at), spread))
    return drawn


def _edges(x: np.ndarray) -> np.ndarray | None:
    """Where a number's groups are cut; None: each value is a group."""
    if len(np.unique(x)) <= _MOST_VALUES:
        return None
    return np.quantile(x, np.arange(1, _BINS) / _BINS)


def _text(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)

"""Which sampled factors a figure depends on, by SALib; the method is the one that the design allows.

``sobol`` designs: variance-based indices (Saltelli 2010). The first-order index is the share of the figure's variance
that a factor explains alone, the total index that in which it takes part. Other samples: Borgonovo's delta, which is 0
if the figure's distribution does not depend on the factor and at most 1, and the first-order index estimated from it.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from pilotfish.errors import ConfigError
from pilotfish.extras import require
from pilotfish.sweep.design import unit_problem
from pilotfish.sweep.results import Results

RESAMPLES = 200
_FEWEST = 16  # base samples of Sobol's design
_FEWEST_GIVEN = 60  # samples of any other


@dataclass(frozen=True)
class Index:
    """Of one factor: an index, and half the width of its 95 % interval."""

    value: float
    half_width: float


@dataclass(frozen=True)
class Sensitivity:
    """Of a figure, in one group of runs. ``total`` has total indices, or deltas; see ``method``."""

    group: str
    method: str  # "sobol" or "delta"
    first: dict[str, Index]
    total: dict[str, Index]
    used: int  # points
    left_out: int  # points without the figure, and with Sobol's design those that belong to them


def sensitivities(results: Results, metric: str, by: str | None = None) -> list[Sensitivity]:
    """One for each value of ``by``, a listed factor. The figure of a sample is the mean over its runs and over the
    other listed factors. ConfigError if the design does not allow it or nothing varies."""
    names = [name for name, said in results.factors.items() if said["form"] == "Distributed"]
    sampling = results.identity["sampling"]
    if not names:
        raise ConfigError(
            "no factor of this campaign is sampled (uniform, log_uniform, normal), so there is no sensitivity to "
            "measure: `pilotfish sweep plot` shows listed factors"
        )
    if by in names:
        raise ConfigError(f"--by {by}: it is sampled; runs are told apart by a listed factor or one of levels")
    groups = results.factor(by)[1] if by else np.full(len(results), "")
    per_point = sampling["points"] * (len(names) + 2 if sampling["method"] == "sobol" else 1)
    sample = results.columns["point"] % per_point
    values = results.metric(metric)
    inputs = np.column_stack([results.columns[name] for name in names])
    found = []
    for group in dict.fromkeys(groups.tolist()):
        mask = groups == group
        figure, at = _means(values[mask], sample[mask], inputs[mask], per_point)
        label = f"{group:g}" if isinstance(group, float) else str(group)
        analyse = _sobol if sampling["method"] == "sobol" else _delta
        found.append(analyse(label, metric, names, figure, at))
    return found


def _means(values: np.ndarray, sample: np.ndarray, inputs: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The figure by sample (count,), NaN where no run has it, and the factors there (count, factors)."""
    known = np.isfinite(values)
    sums = np.bincount(sample[known], values[known], count)
    numbers = np.bincount(sample[known], minlength=count)
    with np.errstate(invalid="ignore"):
        means = sums / numbers
    at = np.full((count, inputs.shape[1]), np.nan)
    at[sample] = inputs
    return means, at


def _sobol(group: str, metric: str, names: list[str], figure: np.ndarray, _: np.ndarray) -> Sensitivity:
    """Each base sample has (factors + 2) points that belong together: where one is missing, none counts."""
    blocks = figure.reshape(-1, len(names) + 2)
    whole = blocks[np.isfinite(blocks).all(axis=1)]
    _check(whole, len(whole), _FEWEST, f"{group} {metric}", "base samples (sampling.points)")
    sobol = require("SALib.analyze.sobol", "sweep")
    with warnings.catch_warnings():  # of pandas, which SALib uses
        warnings.simplefilter("ignore")
        answer = sobol.analyze(
            unit_problem(names), whole.ravel(), calc_second_order=False, num_resamples=RESAMPLES, seed=1
        )
    return Sensitivity(
        group,
        "sobol",
        _indices(names, answer["S1"], answer["S1_conf"]),
        _indices(names, answer["ST"], answer["ST_conf"]),
        whole.size,
        figure.size - whole.size,
    )


def _delta(group: str, metric: str, names: list[str], figure: np.ndarray, at: np.ndarray) -> Sensitivity:
    known = np.isfinite(figure)
    _check(figure[known], int(known.sum()), _FEWEST_GIVEN, f"{group} {metric}", "points (sampling.points)")
    delta = require("SALib.analyze.delta", "sweep")
    problem = unit_problem(names)
    problem["bounds"] = [[float(column.min()), float(column.max())] for column in at[known].T]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        answer = delta.analyze(problem, at[known], figure[known], num_resamples=RESAMPLES, seed=1)
    return Sensitivity(
        group,
        "delta",
        _indices(names, answer["S1"], answer["S1_conf"]),
        _indices(names, answer["delta"], answer["delta_conf"]),
        int(known.sum()),
        int((~known).sum()),
    )


def _check(figure: np.ndarray, count: int, fewest: int, what: str, of: str) -> None:
    what = what.strip()
    if count < fewest:
        raise ConfigError(f"{what}: {count} {of} have the figure, at least {fewest} are needed: more points or runs")
    if np.ptp(figure) <= 1e-12 * max(1e-300, float(np.abs(figure).max())):
        raise ConfigError(f"{what} is the same in all runs: it depends on nothing that was varied")


def _indices(names: list[str], values: np.ndarray, half_widths: np.ndarray) -> dict[str, Index]:
    pairs = zip(names, values, half_widths, strict=True)
    return {name: Index(float(value), float(half)) for name, value, half in pairs}

"""Which sampled factors a figure depends on, by SALib; the method is the one that the design allows.

``sobol`` designs: variance-based indices (Saltelli 2010). The first-order index is the share of the figure's variance
that a factor explains alone, the total index that in which it takes part. Other samples: the PAWN index (Pianosi and
Wagener 2018), the median over ten slices of a factor's range of the largest distance between the figure's cumulative
distribution there and that of all runs: at most 1. What has no effect is not at 0: the fewer the runs, the higher.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from pilotfish.errors import ConfigError, UsageError
from pilotfish.extras import require
from pilotfish.sweep.design import unit_problem
from pilotfish.sweep.results import Results

RESAMPLES, PAWN_RESAMPLES = 200, 50
_SLICES = 10
_FEWEST = 16  # base samples of Sobol's design
_FEWEST_GIVEN = 60  # samples of any other


@dataclass(frozen=True)
class Index:
    """Of one factor: an index, and half the width of its 95 % interval."""

    value: float
    half_width: float


@dataclass(frozen=True)
class Sensitivity:
    """Of a figure, in one group of runs. ``total`` has total indices, or PAWN's; then ``first`` is empty."""

    group: str
    method: str  # "sobol" or "pawn"
    first: dict[str, Index]
    total: dict[str, Index]
    used: int  # points
    left_out: int  # points without the figure, and with Sobol's design those that belong to them


def sensitivities(results: Results, metric: str, by: str | None = None, logarithmic: bool = False) -> list[Sensitivity]:
    """One for each value of ``by``, a listed factor. The figure of a sample is the mean over its runs and over the
    other listed factors. ``logarithmic``: of the figure's logarithm, which a few very large values do not rule.
    ConfigError if the design does not allow it or nothing varies."""
    names = [name for name, said in results.factors.items() if said["form"] == "Distributed"]
    sampling = results.identity["sampling"]
    if not names:
        raise ConfigError(
            "no factor of this campaign is sampled (uniform, log_uniform, normal), so there is no sensitivity to "
            "measure: `pilotfish sweep plot` shows listed factors"
        )
    if by and results.factor(by)[0] in names:
        raise UsageError(f"--by {by}: it is sampled; runs are told apart by a listed factor or one of levels")
    groups = results.factor(by)[1] if by else np.full(len(results), "")
    per_point = sampling["points"] * (len(names) + 2 if sampling["method"] == "sobol" else 1)
    sample = results.columns["point"] % per_point
    results.check_has(metric)
    values = results.metric(metric)
    if logarithmic:
        if np.nanmin(values) <= 0.0:
            raise ConfigError(f"{metric} is not above 0 in all runs: it has no logarithm")
        values = np.log10(values)
    inputs = np.column_stack([results.columns[name] for name in names])
    found = []
    for group in dict.fromkeys(groups.tolist()):
        mask = groups == group
        figure, at = _means(values[mask], sample[mask], inputs[mask], per_point)
        label = f"{group:g}" if isinstance(group, float) else str(group)
        analyse = _sobol if sampling["method"] == "sobol" else _pawn
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


def _pawn(group: str, metric: str, names: list[str], figure: np.ndarray, at: np.ndarray) -> Sensitivity:
    """Intervals: 1.96 standard deviations of the index over resampled points, as SALib gives Sobol's indices theirs."""
    known = np.isfinite(figure)
    count = int(known.sum())
    _check(figure[known], count, _FEWEST_GIVEN, f"{group} {metric}", "points (sampling.points)")
    pawn = require("SALib.analyze.pawn", "sweep")
    x, y = at[known], figure[known]
    problem = unit_problem(names)
    problem["bounds"] = [[float(column.min()), float(column.max())] for column in x.T]
    random = np.random.default_rng(1)
    drawn = [np.arange(count), *(random.integers(0, count, count) for _ in range(PAWN_RESAMPLES))]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        medians = np.array([pawn.analyze(problem, x[rows], y[rows], S=_SLICES, seed=1)["median"] for rows in drawn])
    half_widths = 1.96 * medians[1:].std(axis=0, ddof=1)
    return Sensitivity(group, "pawn", {}, _indices(names, medians[0], half_widths), count, int((~known).sum()))


def _check(figure: np.ndarray, count: int, fewest: int, what: str, of: str) -> None:
    what = what.strip()
    if count < fewest:
        raise ConfigError(f"{what}: {count} {of} have the figure, at least {fewest} are needed: more points or runs")
    if np.ptp(figure) <= 1e-12 * max(1e-300, float(np.abs(figure).max())):
        raise ConfigError(f"{what} is the same in all runs: it depends on nothing that was varied")


def _indices(names: list[str], values: np.ndarray, half_widths: np.ndarray) -> dict[str, Index]:
    pairs = zip(names, values, half_widths, strict=True)
    return {name: Index(float(value), float(half)) for name, value, half in pairs}

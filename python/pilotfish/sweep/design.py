"""The points of a campaign: listed values crossed with each other, and with the samples of the distributions."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pilotfish.errors import ConfigError
from pilotfish.extras import require
from pilotfish.sweep.factors import Distributed, Factor, Value

METHODS = {
    "random": "independent",
    "latin_hypercube": "each factor's range is cut into as many equal parts as there are points, one point in each",
    "sobol": "Saltelli's design for Sobol indices: points x (factors + 2) samples, points a power of 2",
}
MAX_RUNS = 10_000_000


@dataclass(frozen=True)
class Sampling:
    """How distributions are sampled."""

    method: str = "latin_hypercube"
    points: int = 0


def samples(factors: Sequence[Distributed], sampling: Sampling, seed: int) -> np.ndarray:
    """Quantiles in [0, 1], shape (N, factors); (1, 0) if nothing is distributed. The same arguments give the same."""
    if not factors:
        return np.zeros((1, 0))
    if sampling.method == "random":
        return np.random.default_rng(np.random.SeedSequence([seed, 1])).random((sampling.points, len(factors)))
    problem = unit_problem([factor.name for factor in factors])
    if sampling.method == "latin_hypercube":
        return require("SALib.sample.latin", "sweep").sample(problem, sampling.points, seed=seed)
    sobol = require("SALib.sample.sobol", "sweep")
    return sobol.sample(problem, sampling.points, calc_second_order=False, seed=seed)


def unit_problem(names: Sequence[str]) -> dict[str, object]:
    """SALib's description of factors that are sampled as quantiles."""
    return {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}


def check_sampling(sampling: Sampling, factors: Sequence[Distributed]) -> None:
    """ConfigError if these cannot be sampled so."""
    if not factors:
        if sampling.points:
            raise ConfigError("sampling: no factor is distributed (uniform, log_uniform, normal): leave it out")
        return
    if not sampling.points:
        names = ", ".join(factor.name for factor in factors)
        raise ConfigError(f"sampling.points: is missing; {names} are distributed, so say how often they are sampled")
    if sampling.method == "sobol" and sampling.points & (sampling.points - 1):
        below = 1 << (sampling.points.bit_length() - 1)
        raise ConfigError(
            f"sampling.points: {sampling.points} is not a power of 2, as Sobol's sequence wants; "
            f"allowed near it: {below}, {2 * below}"
        )


def count_samples(factors: Sequence[Distributed], sampling: Sampling) -> int:
    """Rows of samples()."""
    if not factors:
        return 1
    return sampling.points * (len(factors) + 2 if sampling.method == "sobol" else 1)


def points(factors: Sequence[Factor], sampling: Sampling, seed: int) -> list[dict[str, Value]]:
    """Each point's values by the factors' names. Every combination of listed values has all samples, in order, one
    combination after the other."""
    distributed = [factor for factor in factors if isinstance(factor, Distributed)]
    listed = [factor for factor in factors if not isinstance(factor, Distributed)]
    quantiles = samples(distributed, sampling, seed)
    columns = [factor.at(quantiles[:, k]) for k, factor in enumerate(distributed)]
    sampled = [
        {factor.name: float(column[row]) for factor, column in zip(distributed, columns, strict=True)}
        for row in range(len(quantiles))
    ]
    crossed = itertools.product(*(factor.values for factor in listed))
    names = [factor.name for factor in factors]
    result = []
    for combination in crossed:
        fixed = dict(zip((factor.name for factor in listed), combination, strict=True))
        for drawn in sampled:
            both = fixed | drawn
            result.append({name: both[name] for name in names})
    return result

"""How far off fits of simulated drives are, and how honest their standard deviations.

`python tests/identify/accuracy.py [RUNS SEED]` (36 runs, some two minutes). Not a test."""

from __future__ import annotations

import sys

import numpy as np
from simulated_drives import simulated

from pilotfish.identify import evidence_from_recording, fit_drive

NAMES = ("latency_s", "lag_s", "linear_gain", "angular_gain")
SCENARIOS = {"square": 25.0, "stop_dead": 18.0, "circle": 25.0, "figure_eight": 25.0}


def main(runs: int, seed: int) -> None:
    """Latency 20 to 300 ms, lag 10 to 600 ms (logarithmic), gains 0.96 to 1.04."""
    random = np.random.default_rng(seed)
    errors, scores, seen = [], [], []
    for index in range(runs):
        scenario = list(SCENARIOS)[index % len(SCENARIOS)]
        truth = [random.uniform(0.02, 0.3), np.exp(random.uniform(np.log(0.01), np.log(0.6)))]
        truth += [random.uniform(0.96, 1.04), random.uniform(0.96, 1.04)]
        named = dict(zip(NAMES, truth, strict=True))
        fit = fit_drive(evidence_from_recording(simulated(scenario, 100 * seed + index, SCENARIOS[scenario], **named)))
        found = [getattr(fit, name) for name in NAMES]
        errors.append([one.value - true for one, true in zip(found, truth, strict=True)])
        scores.append([error / one.sigma for error, one in zip(errors[-1], found, strict=True)])
        errors[-1][1] /= truth[1]
        seen.append([one.observable for one in found])
        print(
            index,
            scenario,
            *(f"{true:.4f}: {one.value:.4f} +- {one.sigma:.4f}" for true, one in zip(truth, found, strict=True)),
        )
    where = np.array(seen)
    for column, (name, scale, unit) in enumerate(zip(NAMES, (1e3, 1e2, 1e2, 1e2), ("ms", "%", "%", "%"), strict=True)):
        error, score = (np.array(one)[where[:, column], column] for one in (errors, scores))
        print(
            f"{name:13s} observable {len(error)} of {runs}; error RMS {scale * np.sqrt(np.mean(error**2)):.2f} {unit}, "
            f"median {scale * np.median(np.abs(error)):.2f}, greatest {scale * np.max(np.abs(error)):.2f}; "
            f"z-scores RMS {np.sqrt(np.mean(score**2)):.2f}"
        )


if __name__ == "__main__":
    main(*[int(word) for word in sys.argv[1:]] or [36, 6])

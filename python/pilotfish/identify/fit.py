"""The drive that makes the leader's track most probable: a grid of delays, then Gauss-Newton, then honest errors.

Parameters: latency L, lag tau, gain of the speed, gain of the turn rate, and a nuisance, the angle between the camera's
forward and the robot's (a bearing that is off by b makes forward motion look sideways; a robot that veers looks the
same). Delays of an oscillating robot have several maxima, so a grid of latencies and lags comes first.

With e the whitened changes and J their derivatives, H = J^T J (+ weak priors) and the covariance is the sandwich

    H^-1 S H^-1,  S = sum over lags j of (1 - j/B) sum_k g_k g_{k+j}^T,  g_k = J_k e_k  (Newey and West, 1987),

which allows for residuals that are still correlated over B; it is not taken smaller than H^-1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.identify.evidence import Evidence, FloatArray
from pilotfish.identify.leader_track import (
    Differences,
    Noise,
    bands,
    cost_of,
    differences_of,
    factor,
    learn_noise,
    whitened,
)
from pilotfish.identify.own_path import SetValues, own_poses, set_values

NAMES = ("latency_s", "lag_s", "linear_gain", "angular_gain", "camera_yaw_rad")
PRIOR_MEAN = np.array([0.1, 0.1, 1.0, 1.0, 0.0])
PRIOR_SIGMA = np.array([0.3, 0.5, 0.1, 0.1, 0.05])
_LOW = np.array([0.0, 0.0, 0.5, 0.5, -0.5])
_HIGH = np.array([0.5, 1.5, 1.5, 1.5, 0.5])
_STEPS = np.array([1e-3, 1e-3, 1e-3, 1e-3, 1e-4])  # of the derivatives
_GRID_LATENCY_S = np.arange(0.01, 0.42, 0.02)
_GRID_LAG_S = (0.01, 0.05, 0.1, 0.18, 0.3, 0.45, 0.7)
_CANDIDATES, _STARTS = 12, 4
# What no record is long enough to go below: the grid of the own path has 2 ms, and drives are no exact first order.
_MODEL_SIGMA = np.array([2e-4, 3e-4, 5e-4, 5e-4, 0.0])
# Wheels that slip for a tenth of a second at a time are no white noise, and the loop answers them: the latency comes
# out 11 to 23 ms short (8 runs with data/hardware/nonideal.yaml). That is no scatter, so it is added.
STRAYING_M_PER_SQRT_S, _STRAYING_LATENCY_S = 1e-4, 0.016
_CORRELATED_S = 1.0  # B above


@dataclass(frozen=True)
class Estimate:
    """A value and its standard deviation; ``observable``: the run, not the prior, determines it."""

    value: float
    sigma: float
    observable: bool


@dataclass(frozen=True)
class DriveFit:
    """What was found. ``residuals``: whitened, (2, K), along and across the line of sight, at ``residual_time_s``.
    ``distance_noise_ratio`` and ``bearing_noise_ratio``: measured noise over what the coordinator states (1: right).
    ``straying``: random walk of the own place [m per sqrt(s)], at the mean speed while moving."""

    latency_s: Estimate
    lag_s: Estimate
    linear_gain: Estimate
    angular_gain: Estimate
    camera_yaw_rad: Estimate
    distance_noise_ratio: float
    bearing_noise_ratio: float
    distance_sigma_m: float
    bearing_sigma_rad: float
    straying_m_per_sqrt_s: float
    frames: int
    duration_s: float
    speed_change_mps: float  # standard deviation of the commanded speed, and of the turn rate
    turn_change_radps: float
    converged: bool
    residual_time_s: FloatArray
    residuals: FloatArray
    time_s: FloatArray
    fitted_speed_mps: FloatArray
    seen_speed_mps: FloatArray


@dataclass(frozen=True)
class _Problem:
    evidence: Evidence
    values: SetValues
    rows: Differences

    def changes(self, p: FloatArray) -> FloatArray:
        """(K, 2): along and across the line of sight."""
        e = self.evidence
        x, y, heading, _ = own_poses(self.values, e.time_s, *p[:4])
        sight = heading + e.bearing_rad - p[4]
        z = np.column_stack([x + e.distance_m * np.cos(sight), y + e.distance_m * np.sin(sight)])
        a = self.rows.of(z)
        along = sight[self.rows.middle]
        c, s = np.cos(along), np.sin(along)
        return np.column_stack([c * a[:, 0] + s * a[:, 1], c * a[:, 1] - s * a[:, 0]])

    def speed(self, p: FloatArray) -> FloatArray:
        return own_poses(self.values, self.evidence.time_s, *p[:4])[3]

    def sigmas(self) -> tuple[FloatArray, FloatArray]:
        e = self.evidence
        return e.distance_sigma_m, e.bearing_sigma_rad * e.distance_m


def fit_drive(evidence: Evidence, *, max_mps2: float = 1.0, max_radps2: float = 10.0) -> DriveFit:
    """``max_...``: the greatest accelerations of the wheels' driver (control.limits of the coordinator)."""
    problem = _Problem(evidence, set_values(evidence, max_mps2, max_radps2), differences_of(evidence.time_s))
    candidates = [_refined(problem, start, rounds=4) for start in _starts(problem)]
    _, p, noises, _ = min(candidates, key=lambda one: one[0])
    _, p, noises, converged = _refined(problem, p, rounds=6, noises=noises)
    return _result(problem, p, noises, converged)


def _starts(problem: _Problem) -> list[FloatArray]:
    """The best places of the grid that are not neighbours, ranked again with noise of their own, since one that is
    wrong makes the leader look wild. Robust: the logarithm bounds what an abrupt leader can say."""
    first = np.array([0.05, 0.1, 1.0, 1.0, 0.0])
    lowers = [factor(_bands(problem, first, c, _first_noise(problem.rows))) for c in (0, 1)]
    costs = np.empty((len(_GRID_LATENCY_S), len(_GRID_LAG_S)))
    for i, latency_s in enumerate(_GRID_LATENCY_S):
        for j, lag_s in enumerate(_GRID_LAG_S):
            a = problem.changes(np.array([latency_s, lag_s, 1.0, 1.0, 0.0]))
            e = [whitened(lowers[c], a[:, c]) for c in (0, 1)]
            costs[i, j] = sum(_robust(one) for one in e)
    chosen: list[tuple[int, int]] = []
    for at in np.argsort(costs, axis=None):
        i, j = divmod(int(at), len(_GRID_LAG_S))
        if all(abs(i - a) > 1 or abs(j - b) > 1 for a, b in chosen):
            chosen.append((i, j))
        if len(chosen) == _CANDIDATES:
            break
    places = [np.array([_GRID_LATENCY_S[i], _GRID_LAG_S[j], 1.0, 1.0, 0.0]) for i, j in chosen]
    places.sort(key=lambda p: _refined(problem, p, rounds=1, quick=True)[0])
    return places[:_STARTS]


def _robust(e: FloatArray) -> float:
    scale2 = float(np.median(e**2)) / 0.455 + 1e-12
    return float(len(e) * np.log(scale2) + 4.0 * np.sum(np.log1p(e**2 / (3.0 * scale2))))


def _first_noise(rows: Differences) -> Noise:
    return Noise(0.02, 1.0, 0.001, np.ones(len(rows.middle)))


def _bands(problem: _Problem, p: FloatArray, channel: int, noise: Noise) -> FloatArray:
    return bands(problem.rows, problem.sigmas()[channel], problem.speed(p), noise)


def _refined(
    problem: _Problem, p: FloatArray, rounds: int, noises: list[Noise] | None = None, *, quick: bool = False
) -> tuple[float, FloatArray, list[Noise], bool]:
    """Cost, parameters, noises. Noise and parameters in turn."""
    noises = noises or [_first_noise(problem.rows)] * 2
    moved = np.inf
    for turn in range(rounds):
        a, speed = problem.changes(p), problem.speed(p)
        noises = [
            learn_noise(
                problem.rows, problem.sigmas()[c], speed, a[:, c], noises[c], rounds=7 if turn == 0 and not quick else 1
            )
            for c in (0, 1)
        ]
        lowers = [factor(_bands(problem, p, c, noises[c])) for c in (0, 1)]
        before = p
        for _ in range(1 if quick else 3):
            p = _step(problem, p, lowers)
        moved = float(np.max(np.abs((p - before) / _STEPS)))
    lowers = [factor(_bands(problem, p, c, noises[c])) for c in (0, 1)]
    return _cost(problem, p, lowers), p, noises, moved < 3.0


def _cost(problem: _Problem, p: FloatArray, lowers: list[FloatArray]) -> float:
    a = problem.changes(p)
    prior = float(np.sum(((p - PRIOR_MEAN) / PRIOR_SIGMA) ** 2))
    return prior + sum(cost_of(lowers[c], a[:, c]) for c in (0, 1))


def _linearised(problem: _Problem, p: FloatArray, lowers: list[FloatArray]) -> tuple[FloatArray, FloatArray]:
    """e (2, K) and its derivatives (2, K, 5), whitened."""
    columns = [problem.changes(p)]
    for i, step in enumerate(_STEPS):
        up, down = p.copy(), p.copy()
        up[i], down[i] = p[i] + step, max(p[i] - step, _LOW[i])
        columns.append((problem.changes(up) - problem.changes(down)) / (up[i] - down[i]))
    stacked = np.stack(columns, axis=2)  # (K, 2, 6)
    white = np.stack([whitened(lowers[c], stacked[:, c, :]) for c in (0, 1)])
    return white[:, :, 0], white[:, :, 1:]


def _step(problem: _Problem, p: FloatArray, lowers: list[FloatArray]) -> FloatArray:
    """One step of Gauss-Newton within the bounds, halved until it is no worse."""
    e, jacobian = _linearised(problem, p, lowers)
    hessian = np.einsum("cki,ckj->ij", jacobian, jacobian) + np.diag(PRIOR_SIGMA**-2)
    slope = np.einsum("cki,ck->i", jacobian, e) + (p - PRIOR_MEAN) / PRIOR_SIGMA**2
    step = -np.linalg.solve(hessian, slope)
    here = _cost(problem, p, lowers)
    for _ in range(6):
        trial = np.clip(p + step, _LOW, _HIGH)
        if _cost(problem, trial, lowers) <= here:
            return trial
        step = step / 2
    return p


def _result(problem: _Problem, p: FloatArray, noises: list[Noise], converged: bool) -> DriveFit:
    evidence = problem.evidence
    lowers = [factor(_bands(problem, p, c, noises[c])) for c in (0, 1)]
    e, jacobian = _linearised(problem, p, lowers)
    information = np.einsum("cki,ckj->ij", jacobian, jacobian)
    inverse = np.linalg.inv(information + np.diag(PRIOR_SIGMA**-2))
    scores = np.einsum("cki,ck->ki", jacobian, e)
    sandwich = inverse @ _long_run(scores, problem.rows, evidence.time_s) @ inverse
    sigma = np.sqrt(np.maximum(sandwich.diagonal(), inverse.diagonal()) + _MODEL_SIGMA**2)
    speed = problem.speed(p)
    moving = np.abs(speed) > 0.02
    mean_speed = float(np.sqrt(np.mean(speed[moving] ** 2))) if moving.any() else 0.0
    straying = noises[0].straying * mean_speed
    if straying > STRAYING_M_PER_SQRT_S:
        sigma[0] = np.hypot(sigma[0], _STRAYING_LATENCY_S)
    bounds = np.array([0.03, max(0.04, 0.3 * p[1]), 0.03, 0.03, 0.03])
    found = [Estimate(float(v), float(s), bool(s < b)) for v, s, b in zip(p, sigma, bounds, strict=True)]
    ratios = [noise.camera for noise in noises]
    return DriveFit(
        **dict(zip(NAMES, found, strict=True)),
        distance_noise_ratio=ratios[0],
        bearing_noise_ratio=ratios[1],
        distance_sigma_m=ratios[0] * float(np.median(evidence.distance_sigma_m)),
        bearing_sigma_rad=ratios[1] * float(np.median(evidence.bearing_sigma_rad)),
        straying_m_per_sqrt_s=straying,
        frames=len(evidence.time_s),
        duration_s=float(evidence.time_s[-1] - evidence.time_s[0]),
        speed_change_mps=float(np.std(evidence.linear_mps)),
        turn_change_radps=float(np.std(evidence.angular_radps)),
        converged=converged,
        residual_time_s=evidence.time_s[problem.rows.middle],
        residuals=e,
        time_s=evidence.time_s,
        fitted_speed_mps=speed,
        seen_speed_mps=_seen_speed(problem, p, noises),
    )


def _seen_speed(problem: _Problem, p: FloatArray, noises: list[Noise]) -> FloatArray:
    """The own forward speed as sight has it, (N,): the leader's smoothed velocity less the change of where it is seen.
    The leader's is the fitted track's, averaged over half a second."""
    evidence = problem.evidence
    x, y, heading, _ = own_poses(problem.values, evidence.time_s, *p[:4])
    sight = heading + evidence.bearing_rad - p[4]
    z = np.column_stack([x + evidence.distance_m * np.cos(sight), y + evidence.distance_m * np.sin(sight)])
    r = np.column_stack([evidence.distance_m * np.cos(sight), evidence.distance_m * np.sin(sight)])
    width = max(1, round(0.5 / float(np.median(np.diff(evidence.time_s)))))
    kernel = np.ones(width) / width
    leader = np.gradient(z, evidence.time_s, axis=0)
    padded = np.pad(leader, ((width // 2, width - 1 - width // 2), (0, 0)), mode="edge")
    smooth = np.column_stack([np.convolve(padded[:, c], kernel, mode="valid") for c in (0, 1)])
    own = smooth - np.gradient(r, evidence.time_s, axis=0)
    return own[:, 0] * np.cos(heading) + own[:, 1] * np.sin(heading)


def _long_run(scores: FloatArray, rows: Differences, time_s: FloatArray) -> FloatArray:
    """S above."""
    reach = max(1, round(_CORRELATED_S / float(np.median(np.diff(time_s)))))
    reach = min(reach, len(scores) // 4)
    total = scores.T @ scores
    for lag in range(1, reach):
        product = scores[:-lag].T @ scores[lag:]
        total += (1 - lag / reach) * (product + product.T)
    return total

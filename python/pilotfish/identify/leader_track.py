"""How probable the leader's track is: its third differences, and their covariance.

In the odometry frame the leader is at z = p + R(phi) r: own place, own heading, r = d (cos theta, sin theta) as seen.
The third divided difference of four frames in a row, times 6, is its jerk,

    j_k = c0 z_k + c1 z_{k+1} + c2 z_{k+2} + c3 z_{k+3},    c_i = 6 / prod_{m != i} (t_i - t_m)

(at h apart: -1, 3, -3, 1 over h^3). It is zero for constant velocity and constant acceleration. Taken along and across
the line of sight of its second frame it is what the leader did (white jerk of density q^2), what the camera erred (r
times the stated standard deviation s), and what the wheels strayed (white velocity w times the own speed v: a random
walk of the place). All three are unknown in size, Gaussian and short in memory, so the covariance of all j_k has seven
diagonals, and marginalising the leader is one banded Cholesky factor:

    -2 ln p = ln |C| + j^T C^-1 j
    camera    sum_i c_i c'_i (r s_i)^2, over the frames that two rows share
    straying  sum_i e_i e'_i (w v)^2 h_i, over the steps that they share, with e_i = c_i + ... + c_3
    leader    q^2 / (120 h) (66, 26, 1, 0): the quintic B-spline's values, since a third difference of a triple integral
              of white noise is that noise seen through a quadratic B-spline

Where the leader's part is far out, it has done something abrupt (stopped dead, turned a corner): q^2 is multiplied
there by how far out it is, so that one event says little about the drive. The factor is lower triangular: it whitens
each row by those before. So the measurements' noise, which the commands answer in closed loop, does not bias the fit
(prediction error method; Ljung, System Identification, section 13.4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky_banded, solve_banded
from scipy.optimize import minimize

from pilotfish.identify.evidence import FloatArray

_GAP = 1.6  # a longer step than so many periods is a gap, over which nothing is compared
_SPLINE = (66 / 120, 26 / 120, 1 / 120)
_PRIOR_LOG = np.log([0.05, 1.0, 0.001])
_ABRUPT = 2.5  # standard deviations of what the leader does


@dataclass(frozen=True)
class Differences:
    """Rows of third differences: the first of their four frames (K,), coefficients (K, 4), the times between them
    (K, 3), and whether the next row, the one behind it and the third share frames with it ((K,), each)."""

    first: np.ndarray
    coefficients: FloatArray
    steps_s: FloatArray
    shares: tuple[np.ndarray, np.ndarray, np.ndarray]

    def of(self, values: FloatArray) -> FloatArray:
        """j_k of values at the frames (N, C): (K, C)."""
        return sum(self.coefficients[:, i : i + 1] * values[self.first + i] for i in range(4))

    @property
    def middle(self) -> np.ndarray:
        """The frame in whose line of sight a row is taken."""
        return self.first + 1


def differences_of(time_s: FloatArray) -> Differences:
    """All that do not reach over a gap."""
    step_s = np.diff(time_s)
    near = step_s < _GAP * np.median(step_s)
    first = np.flatnonzero(near[2:] & near[1:-1] & near[:-2])
    t = np.stack([time_s[first + i] for i in range(4)], axis=1)
    c = np.stack([6.0 / np.prod([t[:, i] - t[:, m] for m in range(4) if m != i], axis=0) for i in range(4)], axis=1)
    shares = tuple(np.append(first[lag:] - first[:-lag] == lag, [False] * lag) for lag in (1, 2, 3))
    return Differences(first, c, np.diff(t, axis=1), shares)


@dataclass(frozen=True)
class Noise:
    """Of one channel: q [m/s^3 per sqrt(Hz)], r (1: as stated), s [m per sqrt(s), per m/s]; and where the leader was
    abrupt (K,), 1 elsewhere."""

    leader: float
    camera: float
    straying: float
    abrupt: FloatArray


def bands(rows: Differences, sigma_m: FloatArray, speed: FloatArray, noise: Noise) -> FloatArray:
    """C as cholesky_banded(lower=True) takes it, (4, K)."""
    k, c, h = rows.first, rows.coefficients, rows.steps_s
    s2 = (noise.camera * sigma_m) ** 2
    w2 = noise.straying**2 * (speed**2 + 1e-6)
    e = np.cumsum(c[:, ::-1], axis=1)[:, ::-1]  # e_i, i = 0 to 3; e_0 = 0
    q = noise.leader**2 * noise.abrupt
    out = np.zeros((4, len(k)))
    for lag in range(4):
        n = len(k) - lag
        total = np.zeros(n)
        for i in range(lag, 4):
            total += c[:n, i] * c[lag:, i - lag] * s2[k[:n] + i]
        for i in range(lag + 1, 4):
            total += e[:n, i] * e[lag:, i - lag] * w2[k[:n] + i] * h[:n, i - 1]
        if lag < 3:
            total += _SPLINE[lag] * np.minimum(q[:n], q[lag:]) / h[:n].mean(axis=1)
        out[lag, :n] = total if lag == 0 else np.where(rows.shares[lag - 1][:n], total, 0.0)
    return out


def factor(matrix: FloatArray) -> FloatArray:
    """The lower Cholesky factor of seven diagonals; a trace of jitter keeps it definite."""
    matrix = matrix.copy()
    matrix[0] *= 1 + 1e-9
    return cholesky_banded(matrix, lower=True, check_finite=False)


def whitened(lower: FloatArray, values: FloatArray) -> FloatArray:
    """L^-1 values."""
    return solve_banded((3, 0), lower, values, check_finite=False)


def cost_of(lower: FloatArray, values: FloatArray) -> float:
    """-2 ln p, without the constant."""
    return float(2 * np.sum(np.log(lower[0])) + np.sum(whitened(lower, values) ** 2))


def learn_noise(
    rows: Differences, sigma_m: FloatArray, speed: FloatArray, changes: FloatArray, start: Noise, rounds: int
) -> Noise:
    """The most probable sizes of leader, camera and straying, for these rows (K,), and where the leader was abrupt."""
    noise = start
    for turn in range(rounds):
        where = noise.abrupt
        x0 = np.log([noise.leader, noise.camera, noise.straying])
        known = x0[2:] if turn < rounds - 1 else x0[:0]  # straying would explain what was abrupt: find that first

        def cost(x: FloatArray, where: FloatArray = where, known: FloatArray = known) -> float:
            x = np.concatenate([x, known])
            trial = Noise(*np.exp(np.clip(x, -16, 6)), where)
            # broad priors, so that what is not observable stays where it is
            return cost_of(factor(bands(rows, sigma_m, speed, trial)), changes) + float(
                np.sum(((x - _PRIOR_LOG) / 4.0) ** 2)
            )

        best = minimize(
            cost, x0[: 3 - len(known)], method="Nelder-Mead", options={"maxfev": 90, "xatol": 0.02, "fatol": 0.05}
        )
        noise = Noise(*np.exp(np.clip(np.concatenate([best.x, known]), -16, 6)), where)
        lower = factor(bands(rows, sigma_m, speed, noise))
        # the leader's part of each change: Q C^-1 a, in its own standard deviations
        solved = solve_banded((0, 3), _upper(lower), whitened(lower, changes), check_finite=False)
        variance = _SPLINE[0] * noise.leader**2 / rows.steps_s.mean(axis=1)
        part, sigma = variance * noise.abrupt * solved, np.sqrt(variance)
        noise = Noise(noise.leader, noise.camera, noise.straying, np.maximum(1.0, (part / (_ABRUPT * sigma)) ** 2))
    return noise


def _upper(lower: FloatArray) -> FloatArray:
    """L^T in the form of solve_banded((0, 3), ...)."""
    upper = np.zeros_like(lower)
    for lag in range(4):
        upper[3 - lag, lag:] = lower[lag, : lower.shape[1] - lag]
    return upper

"""How probable the leader's track is: its changes of velocity, and their covariance.

In the odometry frame the leader is at z = p + R(phi) r: own place, own heading, and r = d (cos theta, sin theta) as seen.
Its change of velocity at frame k, with h1 and h2 the times to the neighbours,

    a_k = (z_{k+1} - z_k) / h2 - (z_k - z_{k-1}) / h1,

taken along and across the line of sight of the frame in the middle, is what the leader did (white acceleration, q), what
the camera erred (r times the stated standard deviation), and what the wheels strayed (white velocity, s times the own
speed). All three are unknown in size, Gaussian and short in memory, so the covariance of all a_k is a matrix with five
diagonals, and marginalising the leader is one banded Cholesky factor:

    -2 ln p = ln |C| + a^T C^-1 a
    C_kk    = camera: (s1/h1)^2 + (s2 (1/h1 + 1/h2))^2 + (s3/h2)^2,  leader: q (h1 + h2) / 3,  straying: s^2 (1/h1 + 1/h2)

Where the factor's whitened change is far out, the leader has done something abrupt (stopped dead, turned a corner): q
is multiplied there by how far out it is, so that one event says little about the drive. The factor is lower triangular:
it whitens each change by those before. So the measurements' noise, which the commands answer in closed loop, does not
bias the fit (prediction error method; Ljung, System Identification, section 13.4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cholesky_banded, solve_banded
from scipy.optimize import minimize

from pilotfish.identify.evidence import FloatArray

_GAP = 1.6  # a longer step than so many periods is a gap, over which nothing is compared
_ABRUPT = 2.5  # standard deviations of what the leader does


@dataclass(frozen=True)
class Differences:
    """Rows of second differences (K,): the frame in the middle, the times around it, whether the next row follows."""

    middle: np.ndarray
    before_s: FloatArray
    after_s: FloatArray
    joined: np.ndarray  # (K - 1,)
    joined2: np.ndarray  # (K - 2,)

    def of(self, values: FloatArray) -> FloatArray:
        """a_k of values at the frames (N, ...)."""
        m, shape = self.middle, (-1,) + (1,) * (values.ndim - 1)
        after, before = self.after_s.reshape(shape), self.before_s.reshape(shape)
        return (values[m + 1] - values[m]) / after - (values[m] - values[m - 1]) / before


def differences_of(time_s: FloatArray) -> Differences:
    """All that do not reach over a gap."""
    step_s = np.diff(time_s)
    near = step_s < _GAP * np.median(step_s)
    middle = np.flatnonzero(near[1:] & near[:-1]) + 1
    joined = np.diff(middle) == 1
    return Differences(middle, step_s[middle - 1], step_s[middle], joined, joined[1:] & joined[:-1])


@dataclass(frozen=True)
class Noise:
    """Of one channel: q [m/s^2 per sqrt(Hz)], r (1: as stated), s [m per sqrt(s), per m/s]; and where the leader was
    abrupt (K,), 1 elsewhere."""

    leader: float
    camera: float
    straying: float
    abrupt: FloatArray


def bands(rows: Differences, sigma_m: FloatArray, speed: FloatArray, noise: Noise) -> FloatArray:
    """C as cholesky_banded(lower=True) takes it, (3, K)."""
    m, h1, h2 = rows.middle, rows.before_s, rows.after_s
    s2 = (noise.camera * sigma_m) ** 2
    w2 = noise.straying**2 * (speed**2 + 1e-6)
    q = noise.leader**2 * noise.abrupt
    out = np.zeros((3, len(m)))
    middle = -(1 / h1 + 1 / h2)
    out[0] = s2[m - 1] / h1**2 + s2[m] * middle**2 + s2[m + 1] / h2**2 + q * (h1 + h2) / 3
    out[0] += w2[m] * (1 / h1 + 1 / h2)
    shared = np.minimum(q[1:], q[:-1])
    next_ = middle[:-1] / h1[1:] * s2[m[:-1]] + middle[1:] / h2[:-1] * s2[m[:-1] + 1] + shared * h2[:-1] / 6
    next_ -= np.minimum(w2[m[1:]], w2[m[:-1]]) / h2[:-1]
    out[1, :-1] = np.where(rows.joined, next_, 0.0)
    out[2, :-2] = np.where(rows.joined2, s2[m[:-2] + 1] / (h2[:-2] * h1[2:]), 0.0)
    return out


def factor(matrix: FloatArray) -> FloatArray:
    """The lower Cholesky factor of five diagonals; a trace of jitter keeps it definite."""
    matrix = matrix.copy()
    matrix[0] *= 1 + 1e-9
    return cholesky_banded(matrix, lower=True, check_finite=False)


def whitened(lower: FloatArray, values: FloatArray) -> FloatArray:
    """L^-1 values."""
    return solve_banded((2, 0), lower, values, check_finite=False)


def cost_of(lower: FloatArray, values: FloatArray) -> float:
    """-2 ln p, without the constant."""
    return float(2 * np.sum(np.log(lower[0])) + np.sum(whitened(lower, values) ** 2))


def learn_noise(
    rows: Differences, sigma_m: FloatArray, speed: FloatArray, changes: FloatArray, start: Noise, rounds: int
) -> Noise:
    """The most probable sizes of leader, camera and straying, for these changes (K,), and where the leader was abrupt."""
    noise = start
    for _ in range(rounds):
        where = noise.abrupt
        x0 = np.log([noise.leader, noise.camera, noise.straying])

        def cost(x: FloatArray, where: FloatArray = where) -> float:
            trial = Noise(*np.exp(np.clip(x, -16, 6)), where)
            # broad priors, so that what is not observable stays where it is
            return cost_of(factor(bands(rows, sigma_m, speed, trial)), changes) + float(
                np.sum(((x - _PRIOR_LOG) / 4.0) ** 2)
            )

        best = minimize(cost, x0, method="Nelder-Mead", options={"maxfev": 90, "xatol": 0.02, "fatol": 0.05})
        noise = Noise(*np.exp(np.clip(best.x, -16, 6)), where)
        lower = factor(bands(rows, sigma_m, speed, noise))
        # the leader's part of each change: Q C^-1 a, in its own standard deviations
        solved = solve_banded((0, 2), _upper(lower), whitened(lower, changes), check_finite=False)
        part = noise.leader**2 * noise.abrupt * (rows.before_s + rows.after_s) / 3 * solved
        sigma = noise.leader * np.sqrt((rows.before_s + rows.after_s) / 3)
        noise = Noise(noise.leader, noise.camera, noise.straying, np.maximum(1.0, (part / (_ABRUPT * sigma)) ** 2))
    return noise


_PRIOR_LOG = np.log([0.02, 1.0, 0.001])


def _upper(lower: FloatArray) -> FloatArray:
    """L^T in the form of solve_banded((0, 2), ...)."""
    upper = np.zeros_like(lower)
    upper[2] = lower[0]
    upper[1, 1:] = lower[1, :-1]
    upper[0, 2:] = lower[2, :-2]
    return upper

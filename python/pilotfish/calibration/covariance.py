"""How well shared parameters are known when every block of measurements has unknowns of its own (a view its pose).

With residuals e_b and derivatives A_b by what is shared and B_b by what is the block's own, the own unknowns drop out
by projecting on what B_b cannot explain, P_b = I - Q_b Q_b^T (Q_b an orthonormal base of B_b's columns):

    S_b = A_b^T P_b A_b,    s_b = A_b^T P_b e_b,    S = sum S_b           (at the minimum sum s_b = 0)

- Independent noise of one variance: covariance = (sum e^2 / degrees of freedom) S^-1, the one of least squares.
- Noise that blocks have in common (a board that is not flat, a robot that slips): leave one block out. To first order
  the estimate then moves by d_b = (S - S_b)^-1 s_b, and (G - 1) / G sum d_b d_b^T over the G blocks is the jackknife's
  covariance (Efron and Stein 1981; CR3 of MacKinnon and White 1985), whatever the noise looks like within a block.

The jackknife is rather too large with few blocks, least squares too small if its assumption does not hold: the larger
of the two standard deviations is what is reported.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Block:
    """One block: ``residuals`` (R,), ``shared`` (R, S) and ``own`` (R, O), O may be 0."""

    residuals: np.ndarray
    shared: np.ndarray
    own: np.ndarray


@dataclass(frozen=True)
class Uncertainty:
    """Of the S shared parameters: both covariances (S, S), and the residuals' standard deviation."""

    least_squares: np.ndarray
    jackknife: np.ndarray
    residual_sigma: float

    @property
    def sigma(self) -> np.ndarray:
        """(S,): one standard deviation each, the larger of the two."""
        return np.sqrt(np.maximum(np.diag(self.least_squares), np.diag(self.jackknife)))


def uncertainty_of(blocks: Sequence[Block]) -> Uncertainty:
    """Both covariances at a minimum of the squared residuals. Infinite where a parameter is not determined."""
    shared = blocks[0].shared.shape[1]
    scale = np.sqrt(sum((block.shared**2).sum(axis=0) for block in blocks))
    scale[scale == 0.0] = 1.0
    information, scores, squares, count = [], [], 0.0, 0
    for block in blocks:
        A, e = block.shared / scale, block.residuals
        if block.own.shape[1]:
            Q, _ = np.linalg.qr(block.own)
            A = A - Q @ (Q.T @ A)
            e = e - Q @ (Q.T @ e)
        information.append(A.T @ A)
        scores.append(A.T @ e)
        squares += float(block.residuals @ block.residuals)
        count += len(block.residuals) - block.own.shape[1]
    S = np.sum(information, axis=0)
    variance = squares / max(count - shared, 1)
    infinite = np.full((shared, shared), np.inf)
    if np.linalg.cond(S) > 1e13 or count <= shared:
        return Uncertainty(infinite, infinite, float(np.sqrt(variance)))
    outer = np.outer(scale, scale)
    jackknife = np.zeros((shared, shared))
    for S_b, s_b in zip(information, scores, strict=True):
        rest = S - S_b
        if np.linalg.cond(rest) > 1e13:  # this block alone determines something: nothing speaks for it or against it
            return Uncertainty(variance * np.linalg.inv(S) / outer, infinite, float(np.sqrt(variance)))
        moved = np.linalg.solve(rest, s_b)
        jackknife += np.outer(moved, moved)
    jackknife *= (len(blocks) - 1) / len(blocks)
    return Uncertainty(variance * np.linalg.inv(S) / outer, jackknife / outer, float(np.sqrt(variance)))

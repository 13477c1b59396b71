"""Levenberg and Marquardt's method on sparse normal equations.

Most unknowns here belong to one picture, so that J^T J is nearly block diagonal: factoring it as a sparse matrix takes
milliseconds where SciPy's dense steps (a singular value decomposition each) take a second, and minutes on a busy
computer whose cores its threads contend for.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import splu

MAX_STEPS = 40
_ENOUGH = 1e-9  # relative decrease of the cost, in two steps running


def minimise(
    residuals: Callable[[np.ndarray], np.ndarray],
    jacobian: Callable[[np.ndarray], csc_array],
    unknowns: int,
    *,
    robust_scale: float | None = None,
) -> np.ndarray:
    """The x (unknowns,), from 0 on, that minimises half the sum of squared residuals; with ``robust_scale`` s the sum
    of 2 s^2 (sqrt(1 + r^2 / s^2) - 1) (soft L1), by reweighting: w = 1 / sqrt(1 + r^2 / s^2)."""
    x, damping, settled = np.zeros(unknowns), 1e-4, 0
    r = residuals(x)
    cost = _cost(r, robust_scale)
    for _ in range(MAX_STEPS):
        weights = np.ones_like(r) if robust_scale is None else 1.0 / np.sqrt(1.0 + (r / robust_scale) ** 2)
        J = jacobian(x)
        weighted = diags_array(weights) @ J
        normal, gradient = csc_array(J.T @ weighted), weighted.T @ r
        scale = np.maximum(normal.diagonal(), 1e-12)
        for _ in range(10):
            step = -splu(csc_array(normal + diags_array(damping * scale))).solve(gradient)
            r_next = residuals(x + step)
            cost_next = _cost(r_next, robust_scale)
            if cost_next <= cost:
                break
            damping *= 10.0
        else:
            return x
        decrease = (cost - cost_next) / max(cost, 1e-300)
        x, r, cost, damping = x + step, r_next, cost_next, max(damping / 10.0, 1e-12)
        settled = settled + 1 if decrease < _ENOUGH else 0
        if settled == 2 or cost < 1e-20:
            break
    return x


def _cost(r: np.ndarray, robust_scale: float | None) -> float:
    if robust_scale is None:
        return 0.5 * float(r @ r)
    return float(robust_scale**2 * (np.sqrt(1.0 + (r / robust_scale) ** 2) - 1.0).sum())

"""Where four squares meet, to hundredths of a pixel: a blurred crossing of two edges, fitted to the gray levels there.

OpenCV's corners are good to a tenth of a pixel; fitting what the camera really saw is some ten times better in
renders, and says how blurred it was. With n_1, n_2 the unit normals of the two edges through the corner p, and the lens
and the sensor blurring each by a Gaussian of s_1, s_2, the gray level at q is

    g(q) = m + c E_1 E_2,    E_i = erf(d_i / (sqrt(2) s_i)),    d_i = n_i . (q - p),    n_i = (cos a_i, sin a_i)

Eight unknowns a corner: p (2), a_1, a_2, log s_1, log s_2, m, c. With G_i = dE_i / dd_i = sqrt(2 / pi) / s_i
exp(-d_i^2 / (2 s_i^2)), the derivatives are

    dg/dp = -c (G_1 E_2 n_1 + E_1 G_2 n_2)           dg/dm = 1        dg/dc = E_1 E_2
    dg/da_1 = c G_1 E_2 (n_1' . (q - p))             dg/dlog s_1 = -c G_1 E_2 d_1        likewise for 2

The model changes only its sign under q - p -> p - q, but for m: blur that is not Gaussian, and edges that do not cross
at a right angle, shift no corner. A lens that bends the edges does, by (curvature) (window)^2 / 6, hence a small
window.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import erf

WINDOW_SHARE = 0.4  # of a square's side: half the window's
MAX_WINDOW_PX = 10
MIN_WINDOW_PX = 3
MAX_SHIFT_PX = 2.0  # from OpenCV's corner: farther, and it is another corner
MIN_CONTRAST = 8.0  # |c| in gray levels, half the difference of black and white
MAX_SIGMA_PX = 6.0
_ITERATIONS = 12
_SIGMA_START_PX = 0.9


@dataclass(frozen=True)
class FittedCorners:
    """Of N corners: where they are, how sharp, and whether the fit came out.

    ``corners_px`` (N, 2); ``sigma_px`` (N, 2): blur across either edge; ``fitted`` (N,) bool.
    """

    corners_px: np.ndarray
    sigma_px: np.ndarray
    fitted: np.ndarray


def fit_corners(
    image: np.ndarray, starts_px: np.ndarray, edges_px: np.ndarray, clear_share: float = WINDOW_SHARE
) -> FittedCorners:
    """Fits every corner of (H, W) uint8 ``image`` from ``starts_px`` (N, 2).

    ``edges_px`` (N, 2, 2): along the board's x and y, one square long each, as rows [px]. ``clear_share``: how far from
    an edge nothing is printed in a white square, of a square's side (the marker begins there).
    """
    count = len(starts_px)
    if not count:
        return FittedCorners(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, dtype=bool))
    offsets, gray, weights, whole = _windows(image, starts_px, edges_px, clear_share)
    along = edges_px / np.linalg.norm(edges_px, axis=2, keepdims=True)
    angles = np.arctan2(along[:, :, 0], -along[:, :, 1])  # the normal of an edge, a quarter turn from it
    x = np.concatenate([np.zeros((count, 2)), angles, np.full((count, 2), np.log(_SIGMA_START_PX))], axis=1)
    m, c = _levels(x, offsets, gray, weights)
    x = np.column_stack([x, m, c])
    damping = np.full(count, 1e-3)
    residuals, jacobian = _model(x, offsets, gray)
    cost = (weights * residuals**2).sum(axis=1)
    for _ in range(_ITERATIONS):
        weighted = jacobian * weights[..., None]
        normal = np.einsum("npa,npb->nab", weighted, jacobian)
        gradient = np.einsum("npa,np->na", weighted, residuals)
        diagonal = np.einsum("naa->na", normal) + 1e-9
        step = np.linalg.solve(normal + np.eye(8) * (damping[:, None] * diagonal)[:, None, :], gradient[..., None])
        candidate = x - step[..., 0]
        candidate[:, 4:6] = np.clip(candidate[:, 4:6], np.log(0.2), np.log(2 * MAX_SIGMA_PX))
        new_residuals, new_jacobian = _model(candidate, offsets, gray)
        new_cost = (weights * new_residuals**2).sum(axis=1)
        better = new_cost < cost
        x[better], cost[better] = candidate[better], new_cost[better]
        residuals[better], jacobian[better] = new_residuals[better], new_jacobian[better]
        damping = np.where(better, damping / 5.0, damping * 8.0).clip(1e-9, 1e6)
    sigma_px = np.exp(x[:, 4:6])
    near = np.linalg.norm(x[:, :2], axis=1) < MAX_SHIFT_PX
    explained = cost < 0.25 * (weights * (gray - x[:, 6:7]) ** 2).sum(axis=1)
    sharp = (sigma_px < MAX_SIGMA_PX).all(axis=1)
    fitted = whole & near & explained & sharp & (np.abs(x[:, 7]) > MIN_CONTRAST)
    return FittedCorners(starts_px + x[:, :2], sigma_px, fitted)


def _windows(
    image: np.ndarray, starts_px: np.ndarray, edges_px: np.ndarray, clear_share: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Offsets from the start (N, P, 2), gray levels (N, P), weights 0 or 1 (N, P), and whether enough of it is
    there."""
    height, width = image.shape
    grid = np.arange(-MAX_WINDOW_PX, MAX_WINDOW_PX + 1)
    dx, dy = (each.ravel() for each in np.meshgrid(grid, grid))
    base = np.rint(starts_px).astype(int)
    u, v = base[:, :1] + dx, base[:, 1:] + dy
    inside = (u >= 0) & (v >= 0) & (u < width) & (v < height)
    gray = image[v.clip(0, height - 1), u.clip(0, width - 1)].astype(float)
    offsets = np.stack([u, v], axis=-1) - starts_px[:, None]
    # In the board's own directions, in squares: q - p = a edge_x + b edge_y.
    squares = np.abs(np.einsum("npi,nij->npj", offsets, np.linalg.inv(edges_px)))
    side_px = np.linalg.norm(edges_px, axis=2).min(axis=1)
    share = np.minimum(WINDOW_SHARE, MAX_WINDOW_PX / side_px)
    share = np.maximum(share, np.minimum(MIN_WINDOW_PX / side_px, 0.5))
    blur_share = 1.5 / side_px  # what a marker's edge spreads
    clear = np.maximum(clear_share - blur_share, 1.0 / side_px)
    weights = inside & (squares.max(axis=2) < share[:, None])
    if clear_share < WINDOW_SHARE:  # the marker's corner lies where both are beyond the clear strip
        weights &= squares.min(axis=2) < clear[:, None]
    expected = (2 * np.minimum(share * side_px, MAX_WINDOW_PX)) ** 2
    whole = inside.mean(axis=1) > 0.6
    return offsets, gray, weights.astype(float), whole & (weights.sum(axis=1) > np.minimum(20, 0.3 * expected))


def _levels(x: np.ndarray, offsets: np.ndarray, gray: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """m and c that fit best where the edges start: a line through (E_1 E_2, gray)."""
    d = np.einsum("npi,nki->npk", offsets - x[:, None, :2], _normals(x))
    shape = erf(d / (np.sqrt(2.0) * np.exp(x[:, None, 4:6]))).prod(axis=2)
    total = weights.sum(axis=1) + 1e-9
    mean_s, mean_g = (weights * shape).sum(axis=1) / total, (weights * gray).sum(axis=1) / total
    shape_c = shape - mean_s[:, None]
    c = (weights * shape_c * gray).sum(axis=1) / ((weights * shape_c**2).sum(axis=1) + 1e-9)
    return mean_g - c * mean_s, c


def _normals(x: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(x[:, 2:4]), np.sin(x[:, 2:4])], axis=-1)


def _model(x: np.ndarray, offsets: np.ndarray, gray: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residuals g - gray (N, P) and their derivative (N, P, 8)."""
    n = _normals(x)
    q = offsets - x[:, None, :2]
    sigma = np.exp(x[:, None, 4:6])
    d = np.einsum("npi,nki->npk", q, n)
    E = erf(d / (np.sqrt(2.0) * sigma))
    G = np.sqrt(2.0 / np.pi) / sigma * np.exp(-(d**2) / (2.0 * sigma**2))
    c = x[:, None, 7:8]
    across = c * G * E[..., ::-1]  # dg/dd_i
    turned = np.stack([-n[..., 1], n[..., 0]], axis=-1)
    jacobian = np.concatenate(
        [
            -np.einsum("npk,nki->npi", across, n),
            across * np.einsum("npi,nki->npk", q, turned),
            -across * d,
            np.ones((*gray.shape, 1)),
            E.prod(axis=2, keepdims=True),
        ],
        axis=-1,
    )
    return x[:, 6:7] + x[:, 7:8] * E.prod(axis=2) - gray, jacobian

"""The law once more, in plain NumPy and PyYAML, sharing no code with the library: an oracle.

The centroid is adaptive quadrature of the clipped union between its knees: it knows no closed form.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import yaml

DATA = Path(__file__).parents[2] / "data" / "fuzzy" / "coordination.yaml"


def read(path: Path = DATA) -> dict:
    return yaml.safe_load(path.read_text())


def degree(spec: dict, x):
    """Membership of x in {triangle: [...]}, {trapezoid: [...]} or {gaussian: {...}}, by the textbook."""
    ((shape, p),) = spec.items()
    x = np.asarray(x, dtype=float)
    if shape == "gaussian":
        return np.exp(-((x - p["mean"]) ** 2) / (2 * p["sigma"] ** 2))
    a, b, c, d = (p[0], p[1], p[1], p[2]) if shape == "triangle" else p
    rise = np.where(x >= b, 1.0, (x - a) / (b - a) if a < b else 0.0)
    fall = np.where(x <= c, 1.0, (d - x) / (d - c) if c < d else 0.0)
    return np.clip(np.minimum(rise, fall), 0.0, 1.0)


def clipped_union(specs: list[dict], term_strengths, u):
    return np.max([np.minimum(h, degree(spec, u)) for spec, h in zip(specs, term_strengths, strict=True)], axis=0)


def knees(spec: dict, height: float) -> list[float]:
    """Where a set clipped at a height has corners."""
    ((shape, p),) = spec.items()
    if shape == "gaussian":
        r = p["sigma"] * np.sqrt(-2 * np.log(height)) if height > 0 else 0.0
        return [p["mean"] - r, p["mean"] + r]
    a, b, c, d = (p[0], p[1], p[1], p[2]) if shape == "triangle" else p
    sides = [a + height * (b - a) if a < b else a, d - height * (d - c) if c < d else d]
    return [x for x in [a, d, *sides] if np.isfinite(x)]


def crossings(specs: list[dict], term_strengths, lo: float, hi: float) -> list[float]:
    """Where two of the clipped sets cross, by bisection of every change of sign on a grid, or meet on the grid itself.
    One that is missed may cost more than time: a panel does not see a kink behind its last node."""
    corners = [
        x for spec, height in zip(specs, term_strengths, strict=True) for x in knees(spec, height) if lo < x < hi
    ]
    grid = np.unique([*np.linspace(lo, hi, 401), *corners])  # two straight sides cross once between corners
    values = [np.minimum(h, degree(s, grid)) for s, h in zip(specs, term_strengths, strict=True)]
    found = []
    for i in range(len(specs)):
        for k in range(i + 1, len(specs)):
            difference = values[i] - values[k]
            zero = difference == 0
            found += grid[1:-1][zero[1:-1] & ~(zero[:-2] & zero[2:])].tolist()
            for j in np.flatnonzero(difference[:-1] * difference[1:] < 0):
                left, right = grid[j], grid[j + 1]
                for _ in range(60):
                    middle = 0.5 * (left + right)
                    d = min(term_strengths[i], degree(specs[i], middle)) - min(
                        term_strengths[k], degree(specs[k], middle)
                    )
                    if d * difference[j] > 0:
                        left = middle
                    else:
                        right = middle
                found.append(0.5 * (left + right))
    return found


def integrate(f, a: float, b: float, depth: int = 0) -> np.ndarray:
    """Adaptive Gauss-Legendre quadrature: a panel is halved until its halves agree with it to 1e-15."""
    whole = panel(f, a, b)
    middle = 0.5 * (a + b)
    halves = panel(f, a, middle) + panel(f, middle, b)
    if depth == 40 or np.all(np.abs(whole - halves) < 1e-15):
        return halves
    return integrate(f, a, middle, depth + 1) + integrate(f, middle, b, depth + 1)


NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


def panel(f, a: float, b: float) -> np.ndarray:
    u = 0.5 * (a + b) + 0.5 * (b - a) * NODES
    return 0.5 * (b - a) * (f(u) @ WEIGHTS)


def moments(specs: list[dict], term_strengths, lo: float = -1.0, hi: float = 1.0) -> np.ndarray:
    """Area and first moment of the clipped union over [lo, hi], to about 1e-14."""

    def both(u):
        y = clipped_union(specs, term_strengths, u)
        return np.array([y, u * y])

    cuts = [lo, hi, *crossings(specs, term_strengths, lo, hi)]
    for spec, height in zip(specs, term_strengths, strict=True):
        cuts += [x for x in knees(spec, height) if lo < x < hi]
    return sum((integrate(both, a, b) for a, b in pairwise(sorted(cuts))), start=np.zeros(2))


def term_strengths(data: dict, e: float, ec: float) -> np.ndarray:
    """Equations (4) to (6) for singletons, straight from the file's table: one height for each term of U."""
    labels = list(data["U"]["terms"])
    result = np.zeros(len(labels))
    e, ec = np.clip([e, ec], -1.0, 1.0)
    for row, row_set in data["E"]["terms"].items():
        for column, cell in zip(data["rules"]["columns"], data["rules"][row], strict=True):
            strength = min(degree(row_set, e), degree(data["EC"]["terms"][column], ec))
            k = labels.index(cell)
            result[k] = max(result[k], strength)
    return result


def output(data: dict, e: float, ec: float) -> float:
    area, first = moments(list(data["U"]["terms"].values()), term_strengths(data, e, ec))
    return first / area

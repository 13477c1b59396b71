"""What a fuzzy controller does as a whole: its curve u(e, 0), its surface, its rules; and what looks wrong there."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pilotfish import fuzzy
from pilotfish.errors import ConfigError

CELLS = 200  # of the grid over which the surface is looked at, along each axis
_TINY = 1e-9  # of a universe: a step aside
_SILENT = 1e-6  # of the reach: no output


@dataclass(frozen=True)
class Jump:
    """A place where the surface is not continuous: a set with a vertical side."""

    variable: str
    at: float
    size: float  # the greatest change of u across it


@dataclass(frozen=True)
class Report:
    """Everything in the controller's own, normalised units."""

    slope_at_zero: tuple[float, float]  # du/de of u(e, 0), just left and just right of e = 0
    dead_zone: tuple[float, float]  # the interval around e = 0 in which u(e, 0) stays zero; a point if there is none
    range: tuple[float, float]  # least and greatest output over the whole surface
    ripple: tuple[float, float]  # the most that u rises again along e, and along ec, where it had fallen
    steepest: tuple[float, float]  # the greatest |du/de| and |du/dec| between neighbours of the grid, away from jumps
    jumps: list[Jump]
    never_fires: list[str]  # rules, in words, that no input fires
    never_decides: list[str]  # rules that at every input another rule with the same conclusion outdoes

    @property
    def findings(self) -> list[str]:
        """What a designer will not have wanted, in words; empty if there is nothing."""
        found = []
        lo, hi = self.dead_zone
        if hi > lo:
            found.append(f"dead zone: u(e, 0) stays zero from e = {lo:.4g} to {hi:.4g}")
        found += [f"discontinuity: u jumps by {j.size:.3g} at {j.variable} = {j.at:.4g}" for j in self.jumps]
        found += [f"rule that never fires: {rule}" for rule in self.never_fires]
        return found


def load(file: Path) -> fuzzy.Controller:
    """Our YAML or fuzzylite's FLL; ConfigError that names the file and the place."""
    try:
        return fuzzy.load_controller(file)
    except ValueError as error:
        raise ConfigError(str(error) if str(file) in str(error) else f"{error} (in {file})") from error


def analyse(controller: fuzzy.Controller) -> Report:
    """Looks at the curve, the surface over a grid, and every vertical side."""
    error, change = controller.error, controller.error_change
    e, ec = _axis(error), _axis(change)
    grid_e, grid_ec = (x.ravel() for x in np.meshgrid(e, ec, indexing="ij"))
    outputs, strengths = fuzzy.infer_batch(controller, grid_e, grid_ec)
    surface = outputs.reshape(len(e), len(ec))
    jumps = [*_jumps(controller, error, ec, along_error=True), *_jumps(controller, change, e, along_error=False)]
    return Report(
        slope_at_zero=_slopes_at_zero(controller),
        dead_zone=_dead_zone(controller, _SILENT * float(np.abs(outputs).max())),
        range=(float(outputs.min()), float(outputs.max())),
        ripple=(_ripple(surface, 0), _ripple(surface, 1)),
        steepest=(
            _steepest(surface, e, [j.at for j in jumps if j.variable == error.name], 0),
            _steepest(surface, ec, [j.at for j in jumps if j.variable == change.name], 1),
        ),
        jumps=jumps,
        never_fires=[fuzzy.describe_rule(controller, int(r)) for r in np.flatnonzero(strengths.max(axis=0) <= 0)],
        never_decides=[fuzzy.describe_rule(controller, rule) for rule in _never_decides(controller, strengths)],
    )


def _axis(variable: fuzzy.LinguisticVariable) -> np.ndarray:
    """A grid over the universe that has the peak of every set among its points."""
    peaks = [x for term in variable.terms for x in fuzzy.level_cut(term.set, 1.0)]
    inside = [x for x in peaks if variable.min <= x <= variable.max]
    return np.unique([*np.linspace(variable.min, variable.max, CELLS + 1), *inside])


def _curve(controller: fuzzy.Controller, e: np.ndarray) -> np.ndarray:
    return fuzzy.infer_outputs(controller, e, np.zeros(len(e)))


def _slopes_at_zero(controller: fuzzy.Controller) -> tuple[float, float]:
    step = 1e-6 * (controller.error.max - controller.error.min)
    left, middle, right = _curve(controller, np.array([-step, 0.0, step]))
    return float(middle - left) / step, float(right - middle) / step


def _dead_zone(controller: fuzzy.Controller, silent: float) -> tuple[float, float]:
    """From e = 0 outwards to where |u(e, 0)| first exceeds `silent`; the place by halving."""
    edges = []
    for end in (controller.error.min, controller.error.max):
        outwards = np.linspace(0.0, end, 4001)
        loud = np.flatnonzero(np.abs(_curve(controller, outwards)) > silent)
        if loud.size == 0:
            edges.append(float(end))
        elif loud[0] == 0:
            edges.append(0.0)
        else:
            inner, outer = outwards[loud[0] - 1], outwards[loud[0]]
            for _ in range(50):
                middle = 0.5 * (inner + outer)
                if abs(_curve(controller, np.array([middle]))[0]) > silent:
                    outer = middle
                else:
                    inner = middle
            edges.append(float(inner))
    narrow = edges[1] - edges[0] < 1e-5 * (controller.error.max - controller.error.min)
    return (0.0, 0.0) if narrow else (edges[0], edges[1])


def _jumps(
    controller: fuzzy.Controller, variable: fuzzy.LinguisticVariable, other: np.ndarray, *, along_error: bool
) -> list[Jump]:
    """u is a continuous function of the degrees of its inputs, so it can jump only where a degree does."""
    step = _TINY * (variable.max - variable.min)
    sides = {x for term in variable.terms for x in fuzzy.level_cut(term.set, 1.0) if variable.min < x < variable.max}
    found = []
    for at in sorted(sides):
        before, behind = (np.full(len(other), at + d) for d in (-step, step))
        pairs = [(x, other) if along_error else (other, x) for x in (before, behind)]
        size = float(np.abs(np.subtract(*(fuzzy.infer_outputs(controller, *pair) for pair in pairs))).max())
        if size > 1e-4:
            found.append(Jump(variable.name, float(at), size))
    return found


def _ripple(surface: np.ndarray, axis: int) -> float:
    """Against the direction in which the surface falls as a whole."""
    falling = surface if np.diff(surface, axis=axis).sum() <= 0 else -surface
    return float((falling - np.minimum.accumulate(falling, axis=axis)).max())


def _steepest(surface: np.ndarray, axis_values: np.ndarray, jumps: list[float], axis: int) -> float:
    steps = np.diff(axis_values)
    slopes = np.abs(np.diff(surface, axis=axis)).max(axis=1 - axis) / steps
    across = [any(a <= at <= b for at in jumps) for a, b in zip(axis_values[:-1], axis_values[1:], strict=True)]
    return float(slopes[~np.array(across)].max())


def _never_decides(controller: fuzzy.Controller, strengths: np.ndarray) -> list[int]:
    conclusions = controller.rules.consequents.ravel()
    idle = []
    for rule, conclusion in enumerate(conclusions):
        rivals = np.flatnonzero(conclusions == conclusion)
        rivals = rivals[rivals != rule]
        best = strengths[:, rivals].max(axis=1) if rivals.size else np.zeros(len(strengths))
        if np.all(strengths[:, rule] <= best):
            idle.append(rule)
    return idle

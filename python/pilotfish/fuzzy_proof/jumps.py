"""Where the surface is not continuous: at vertical sides of the input sets, and only there."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pilotfish import fuzzy
from pilotfish.fuzzy_proof.strips import corners_of

_SAMPLES = 2001
_CONTINUOUS = 1e-6  # a smaller change between neighbouring doubles is not called a jump


@dataclass(frozen=True)
class Jump:
    """A pair of inputs that are neighbouring doubles, and the change of u between them: no Lipschitz constant bounds
    it."""

    variable: str
    one: tuple[float, float]  # (e, ec)
    other: tuple[float, float]
    change: float


@dataclass(frozen=True)
class Continuity:
    """u is a continuous function of the degrees of its inputs, so it is continuous where they are.

    ``proved``: no set has a vertical side inside its universe. Otherwise ``jumps`` has a pair for each side across
    which u was found to jump; a side without one may do no harm, but that is not proved.
    """

    proved: bool
    jumps: tuple[Jump, ...]


def prove_continuity(controller: fuzzy.Controller) -> Continuity:
    """Of u over all inputs. The jumps are evaluated with the compiled law."""
    found, sides = [], 0
    for variable, other, along_error in (
        (controller.error, controller.error_change, True),
        (controller.error_change, controller.error, False),
    ):
        for at in _vertical_sides(variable):
            sides += 1
            jump = _across(controller, variable, other, at, along_error=along_error)
            if abs(jump.change) > _CONTINUOUS:
                found.append(jump)
    return Continuity(sides == 0, tuple(found))


def _vertical_sides(variable: fuzzy.LinguisticVariable) -> list[float]:
    found = set()
    for a, b, c, d in corners_of(variable):
        # At an end of the universe a side that faces outward is never crossed.
        if a == b and math.isfinite(a) and variable.min < a <= variable.max:
            found.add(a)
        if c == d and math.isfinite(d) and variable.min <= d < variable.max:
            found.add(d)
    return sorted(found)


def _across(
    controller: fuzzy.Controller,
    variable: fuzzy.LinguisticVariable,
    other: fuzzy.LinguisticVariable,
    at: float,
    *,
    along_error: bool,
) -> Jump:
    """The greatest change from ``at`` to the next double on either side, over samples of the other input."""
    samples = np.linspace(other.min, other.max, _SAMPLES)

    def outputs(x: float) -> np.ndarray:
        inputs = (np.full(_SAMPLES, x), samples) if along_error else (samples, np.full(_SAMPLES, x))
        return fuzzy.infer_outputs(controller, *inputs)

    here = outputs(at)
    best = Jump(variable.name, (at, at), (at, at), 0.0)
    for beside in (float(np.nextafter(at, -np.inf)), float(np.nextafter(at, np.inf))):
        if not variable.min <= beside <= variable.max:
            continue
        change = outputs(beside) - here
        i = int(np.argmax(np.abs(change)))
        if abs(change[i]) > abs(best.change):
            y = float(samples[i])
            one, two = ((at, y), (beside, y)) if along_error else ((y, at), (y, beside))
            best = Jump(variable.name, one, two, float(change[i]))
    return best

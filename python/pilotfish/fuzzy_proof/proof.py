"""All that is proved of a fuzzy file, as one value."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pilotfish import fuzzy
from pilotfish.fuzzy_proof.boxes import Boxes
from pilotfish.fuzzy_proof.branch import OnShare, Optimum
from pilotfish.fuzzy_proof.enclosure import Encloser
from pilotfish.fuzzy_proof.facts import (
    Range,
    prove_range,
    prove_sign,
    prove_steepest_rise,
    prove_steepness,
)
from pilotfish.fuzzy_proof.following import Invariant, largest_speed, least_setpoint, prove_invariant
from pilotfish.fuzzy_proof.interval import Interval
from pilotfish.fuzzy_proof.jumps import Continuity, prove_continuity
from pilotfish.fuzzy_proof.model import Following
from pilotfish.fuzzy_proof.pieces import Surface, surface_of
from pilotfish.fuzzy_proof.rises import prove_greatest_rise
from pilotfish.fuzzy_proof.table import GreatestOver, bound_cells
from pilotfish.fuzzy_proof.worst_case import Counterexample, find_counterexample

SIGN_WITHIN = 0.5  # of the universe of e: by then the sign must be right, by default
TOLERANCE = 1e-4  # of bounds, in units of the universes
_STEEPNESS_TOLERANCE = 0.01  # relative
_RISE_TOLERANCE = 0.01  # of the universe of u

OnStage = Callable[[str, float], None]  # what is being proved, and the share of all that is done


@dataclass(frozen=True)
class Proof:
    """Numbers in units of the universes, but for ``following``. An Optimum has the proved bound and what is reached.

    Of ``range.low`` the bound is below what is reached; of all others above it."""

    name: str
    pieces: int
    sign_within: float
    continuity: Continuity
    range: Range
    steepest_e: Optimum  # |du/de|, away from jumps
    steepest_ec: Optimum  # |du/dec|
    steepest_rise: Optimum  # du/de
    greatest_rise: Optimum | None  # u(e2) - u(e1), e1 < e2; None: only of a continuous surface
    too_close: Optimum  # x so that u <= 0 for e >= x
    too_far: Optimum  # x so that u >= 0 for e <= -x
    following: Following
    invariant: Invariant
    largest_speed_mps: float | None  # at which the invariant is proved; None: at none
    least_setpoint_m: float | None
    counterexample: Counterexample | None

    @property
    def statements(self) -> dict[str, bool]:
        """What must hold, by name, and whether it is proved."""
        return {
            "continuous": self.continuity.proved,
            "sign_when_too_close": self.too_close.bound <= self.sign_within,
            "sign_when_too_far": self.too_far.bound <= self.sign_within,
            "invariant": self.invariant.holds,
        }

    @property
    def holds(self) -> bool:
        """Everything is proved."""
        return all(self.statements.values())

    def as_dict(self) -> dict[str, Any]:
        """For JSON: no infinities and no NaN, which become None."""
        return _plain({"holds": self.holds, "statements": self.statements, **asdict(self)})


def prove(
    controller: fuzzy.Controller,
    following: Following | None = None,
    *,
    tolerance: float = TOLERANCE,
    sign_within: float = SIGN_WITHIN,
    on_stage: OnStage | None = None,
) -> Proof:
    """Proves what can be proved, bounds the rest, and looks for a counterexample where the invariant is not proved.

    ConfigError if a set is a Gaussian. ``tolerance``: of the range and of the signs, in units of the universes.
    """
    model = following or Following()
    stage = _Stages(on_stage)
    surface = stage("the surface in pieces", 2, lambda share: surface_of(controller))
    encloser, vertices = Encloser(surface), corners_of_pieces(surface)
    continuity = prove_continuity(controller)
    range_ = stage("the range of u", 2, lambda share: prove_range(encloser, tolerance, share))
    steepest_e, steepest_ec = (
        stage(
            f"the steepness along {name}",
            1,
            lambda share, along_e=along_e: prove_steepness(
                encloser, vertices, _STEEPNESS_TOLERANCE, along_e=along_e, on_share=share
            ),
        )
        for name, along_e in ((controller.error.name, True), (controller.error_change.name, False))
    )
    rise = stage(
        "the slope along e",
        2,
        lambda share: prove_steepest_rise(encloser, vertices, _STEEPNESS_TOLERANCE * steepest_e.reached, share),
    )
    greatest_rise = None
    if continuity.proved:
        greatest_rise = stage(
            "monotony along e",
            12,
            lambda share: prove_greatest_rise(encloser, controller, _RISE_TOLERANCE, share),
        )
    too_close, too_far = (
        stage(
            f"the sign when too {'close' if close else 'far'}",
            4,
            lambda share, close=close: prove_sign(encloser, vertices, tolerance, too_close=close, on_share=share),
        )
        for close in (True, False)
    )
    grid = stage("u over a grid", 6, lambda share: bound_cells(encloser, on_share=share))
    greatest = GreatestOver(grid)
    invariant, speed_mps, setpoint_m = stage(
        "the invariant of following", 8, lambda share: _follow(model, greatest, share)
    )
    counterexample = None
    if not invariant.holds:
        counterexample = stage("a counterexample", 2, lambda share: find_counterexample(controller, model))
    stage.end()
    return Proof(
        name=controller.name,
        pieces=len(surface.pieces),
        sign_within=sign_within,
        continuity=continuity,
        range=range_,
        steepest_e=steepest_e,
        steepest_ec=steepest_ec,
        steepest_rise=rise,
        greatest_rise=greatest_rise,
        too_close=too_close,
        too_far=too_far,
        following=model,
        invariant=invariant,
        largest_speed_mps=speed_mps,
        least_setpoint_m=setpoint_m,
        counterexample=counterexample,
    )


def corners_of_pieces(surface: Surface) -> Boxes:
    """Every corner of every piece, as a point: rounded, which is enough for values that are to be reached."""
    corners = [(i, float(e), float(ec)) for i, piece in enumerate(surface.pieces) for e, ec in piece.vertices]
    piece, e, ec = (np.array(column) for column in zip(*corners, strict=True))
    return Boxes(piece, Interval.point(e), Interval.point(ec))


def highest_tried_m(model: Following) -> float:
    """The setpoint from which the least one is looked for where the model's own is not proved: about twice as far."""
    return min(2.0 * model.setpoint_m + 1.0, 20.0)


def _follow(model: Following, greatest: GreatestOver, share: OnShare) -> tuple[Invariant, float | None, float | None]:
    invariant = prove_invariant(model, greatest)
    share(0.1)
    speed_mps = model.speed_limit_mps if invariant.holds else largest_speed(model, greatest)
    share(0.4)
    highest_m = model.setpoint_m if invariant.holds else highest_tried_m(model)
    return invariant, speed_mps, least_setpoint(model, greatest, highest_m)


class _Stages:
    """Tells what is done, by weights that are about seconds."""

    _ALL = 2 + 2 + 1 + 1 + 2 + 12 + 4 + 4 + 6 + 8

    def __init__(self, on_stage: OnStage | None) -> None:
        self._on_stage, self._done = on_stage, 0.0

    def __call__(self, label: str, weight: float, work: Callable[[OnShare], Any]) -> Any:
        begin = self._done

        def share(part: float) -> None:
            if self._on_stage:
                self._on_stage(label, min(1.0, (begin + weight * part) / self._ALL))

        share(0.0)
        result = work(share)
        self._done = begin + weight
        return result

    def end(self) -> None:
        if self._on_stage:
            self._on_stage("done", 1.0)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value

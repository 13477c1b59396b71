"""Boxes of inputs, each a part of one piece of the surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pilotfish.fuzzy_proof.interval import FloatArray, Interval


@dataclass(frozen=True)
class Boxes:
    """``piece``: which one, shape (N,); ``e``, ``ec``: closed intervals, shape (N,)."""

    piece: NDArray[np.int64]
    e: Interval
    ec: Interval

    def __len__(self) -> int:
        return len(self.piece)

    def __getitem__(self, which: NDArray[np.generic] | slice) -> Boxes:
        return Boxes(self.piece[which], self.e[which], self.ec[which])

    @property
    def middles(self) -> tuple[FloatArray, FloatArray]:
        """Points inside. Halving both ends first cannot overflow; the ends are kept where rounding would leave the
        box."""
        return _middle(self.e), _middle(self.ec)

    def halves(self, across_e: NDArray[np.bool_]) -> Boxes:
        """Both halves of each: cut across e where ``across_e``, else across ec. They share the cut, so nothing is
        lost."""
        middle_e, middle_ec = self.middles
        left = Boxes(
            self.piece,
            Interval(self.e.lo, np.where(across_e, middle_e, self.e.hi)),
            Interval(self.ec.lo, np.where(across_e, self.ec.hi, middle_ec)),
        )
        right = Boxes(
            self.piece,
            Interval(np.where(across_e, middle_e, self.e.lo), self.e.hi),
            Interval(np.where(across_e, self.ec.lo, middle_ec), self.ec.hi),
        )
        return join([left, right])


def join(parts: list[Boxes]) -> Boxes:
    """One after the other."""

    def joined(intervals: list[Interval]) -> Interval:
        return Interval(np.concatenate([i.lo for i in intervals]), np.concatenate([i.hi for i in intervals]))

    return Boxes(
        np.concatenate([part.piece for part in parts]),
        joined([part.e for part in parts]),
        joined([part.ec for part in parts]),
    )


def _middle(x: Interval) -> FloatArray:
    return np.clip(0.5 * x.lo + 0.5 * x.hi, x.lo, x.hi)

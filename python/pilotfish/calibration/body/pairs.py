"""How two tags sit to each other, from the frames that show both: a vote that the flips lose.

Each frame offers four poses aMb (two of a times two of b). The true one is the same in every frame; the flipped ones
turn with the view. So every offer is held against all frames, and the one that most of them agree with wins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.body.rigid import inverse, mean_pose, transform
from pilotfish.calibration.body.sightings import UNIT_CORNERS, Sightings

SIZE_FACTORS = np.exp(np.linspace(-np.log(4.0), np.log(4.0), 71))  # 4 % apart
CLEARLY_LESS = 0.5
MAX_VOTERS = 60  # frames a pair; more of them do not change a vote


@dataclass(frozen=True)
class Pair:
    """Tags ``a`` and ``b`` (places in the ids), seen together in ``common`` frames, ``agreeing`` of the voters."""

    a: int
    b: int
    aMb: np.ndarray
    common: int
    voters: int
    agreeing: int
    b_larger_by: float  # factor on b's size, if a's is right, roughly


def pairs_seen_together(sightings: Sightings, cMt: np.ndarray, errors_px: np.ndarray) -> list[Pair]:
    """One Pair for any two tags with a frame in common. ``cMt`` (S, 2, 4, 4), ``errors_px`` (S, 2)."""
    tags = len(sightings.ids)
    place = np.full((sightings.frame_count, tags), -1)
    usable = np.isfinite(errors_px).all(axis=1)
    place[sightings.frame[usable], sightings.tag[usable]] = np.flatnonzero(usable)
    result = []
    for a in range(tags):
        for b in range(a + 1, tags):
            common = place[(place[:, a] >= 0) & (place[:, b] >= 0)][:, [a, b]]
            if len(common):
                voters = common[np.unique(np.linspace(0, len(common) - 1, MAX_VOTERS).astype(int))]
                sizes = sightings.sizes_m[[a, b]]
                aMb, agreeing = _vote(cMt[voters[:, 0]], cMt[voters[:, 1]], *sizes)
                larger_by = _size_factor(cMt[voters[::2, 0]], cMt[voters[::2, 1]])
                result.append(Pair(a, b, aMb, len(common), len(voters), agreeing, larger_by))
    return result


def _vote(cMa: np.ndarray, cMb: np.ndarray, size_a_m: float, size_b_m: float) -> tuple[np.ndarray, int]:
    """aMb from (K, 2, 4, 4) each, and how many of the K frames agree with it."""
    offers = (inverse(cMa)[:, :, None] @ cMb[:, None, :]).reshape(-1, 4, 4)  # four a frame
    # Two offers are as far apart as they put the corners of b in a's frame, and those of a in b's (RMS).
    corners = np.concatenate(
        [transform(offers, UNIT_CORNERS * size_b_m), transform(inverse(offers), UNIT_CORNERS * size_a_m)], axis=1
    ).reshape(len(offers), -1)
    squares = (corners**2).sum(axis=1)
    squared = squares[:, None] + squares[None, :] - 2.0 * corners @ corners.T
    apart_m = np.sqrt(np.maximum(squared, 0.0) / 8.0)
    nearest = apart_m.reshape(len(offers), -1, 4)  # offer x frame x its four
    agree_m = 0.25 * (size_a_m + size_b_m)  # a tilt of 30 degrees: noise stays below, most flips do not
    winner = np.minimum(nearest.min(axis=2), agree_m).sum(axis=1).argmin()
    chosen = nearest[winner].argmin(axis=1)
    agreeing = nearest[winner].min(axis=1) < agree_m
    of_each_frame = offers.reshape(-1, 4, 4, 4)[np.arange(len(chosen)), chosen]
    return mean_pose(of_each_frame[agreeing]), int(agreeing.sum())


def _size_factor(cMa: np.ndarray, cMb: np.ndarray) -> float:
    """By how much b's size must be multiplied so that b keeps its place in a's frame, from (K, 2, 4, 4) each.

    A size that is wrong by a factor leaves a tag's turn as it is and puts the tag that much too far or too near, so
    R_a^T (factor t_b - t_a) is the same in every frame for the true factor, and for no other if the body turns.
    """
    R, t_a, t_b = cMa[:, :, :3, :3], cMa[:, 0, :3, 3], cMb[:, 0, :3, 3]  # where a tag is does not flip
    enough_m = 0.2 * float(np.median(np.linalg.norm(t_a, axis=1)))
    spread = []
    for factor in SIZE_FACTORS:
        offers = np.einsum("kcji,kj->kci", R, factor * t_b - t_a)  # in a's frame, for each of a's two poses
        apart_m = np.linalg.norm(offers.reshape(-1, 1, 1, 3) - offers, axis=-1)
        spread.append(np.minimum(apart_m.min(axis=2), enough_m).sum(axis=1).min())
    # A short turn hardly determines it: then the configured size is kept.
    as_said, best = spread[len(SIZE_FACTORS) // 2], int(np.argmin(spread))
    return float(SIZE_FACTORS[best]) if spread[best] < CLEARLY_LESS * as_said else 1.0

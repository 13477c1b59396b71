"""From delays to a table's rows, and what the goals are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.common.statistics import quantile

if TYPE_CHECKING:
    from measure import Delays

RATIO_GOAL = 1.5  # of the medians: the coordinator's to that of the same picture, raw, over LCM alone
P999_GOAL_MS = {"idle": 10.0, "pinned": 10.0, "one-core": 10.0, "busy": 33.0}
WITHOUT_RATIO = {"busy"}  # where others work, the goal is to be in time


@dataclass(frozen=True)
class Row:
    condition: str
    receiver: str
    picture: str
    sent: int
    answered: int
    p50_ms: float
    p99_ms: float
    p999_ms: float
    max_ms: float
    to_same_bare: float  # p50 over that of LCM alone for the same message
    to_raw_bare: float  # and for the same picture raw
    missed: list[str]  # goals


def goal_text(condition: str) -> str:
    p999 = f"p99.9 <= {P999_GOAL_MS[condition]:g}"
    return p999 if condition in WITHOUT_RATIO else f"p50 <= {RATIO_GOAL:g} raw bare, {p999}"


def rows_of(condition: str, found: list[Delays]) -> list[Row]:
    """One an arm. The time of an unanswered picture is infinite."""
    p50_ms = {(arm.receiver, arm.picture): quantile(_with_unanswered(arm), 0.5) for arm in found}
    rows = []
    for arm in found:
        values = _with_unanswered(arm)
        own, p999 = p50_ms[arm.receiver, arm.picture], quantile(values, 0.999)
        to_same, to_raw = (own / p50_ms["bare", picture] for picture in (arm.picture, "raw"))
        missed = ["p50"] if condition not in WITHOUT_RATIO and not to_raw <= RATIO_GOAL else []
        if not p999 <= P999_GOAL_MS[condition]:
            missed.append("p99.9")
        rows.append(
            Row(
                condition,
                arm.receiver,
                arm.picture,
                arm.sent,
                len(arm.milliseconds),
                own,
                quantile(values, 0.99),
                p999,
                max(values),
                to_same,
                to_raw,
                missed,
            )
        )
    return rows


def _with_unanswered(arm: Delays) -> list[float]:
    return [*arm.milliseconds, *[math.inf] * (arm.sent - len(arm.milliseconds))]

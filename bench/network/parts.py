"""The parts of the benchmark, and the figures of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from disturbances import DISTURBANCES
from drive import Driven, Plan

from pilotfish.recording import COLUMNS, Recording

_LINK = ("none", "loss-5", "loss-20", "loss-50", "delay-20", "delay-100", "delay-300", "reorder", "link-down")
_WORST = ("none", "loss-50", "delay-300", "link-down", "interface-down")
_BOTH = ("line", "circle")


@dataclass(frozen=True)
class Part:
    words: str
    plan: Plan
    disturbances: tuple[str, ...]
    quick: tuple[str, ...]


PARTS = {
    "lockstep": Part("in lock-step", Plan(_BOTH, lockstep=True), (*_LINK, "interface-down"), _WORST),
    "following": Part("in real time", Plan(_BOTH), (*_LINK, "interface-down"), _WORST),
    "nonideal": Part("in real time, non-ideal robots", Plan(_BOTH, nonideal=True), (*_LINK, "interface-down"), _WORST),
    "images": Part(
        "images on the shared bus",
        Plan(_BOTH, images="shared", switch="bridge"),
        ("none", "rate-20", "link-down", "interface-down"),
        ("none", "rate-20"),
    ),
    "intent": Part(
        "stop_dead with the leader's intent",
        Plan(("stop_dead",), intent=True),
        ("none", "loss-50", "delay-100", "delay-300", "link-down"),
        ("none", "delay-300", "link-down"),
    ),
}


@dataclass(frozen=True)
class Row:
    """Of one scenario with one disturbance; means over the repetitions unless the name says otherwise."""

    scenario: str
    link: str
    rms_mm: float
    rms_min_mm: float
    rms_max_mm: float
    change_mm: float  # to the mean with the ideal link
    change: float  # the same as a share of it
    ideal_spread_mm: float  # greatest less least RMS of the repetitions with the ideal link
    closest_mm: float  # the nearest in any repetition
    tracking: float
    rendered: float  # pictures for which the simulator had the time
    watched: float
    gap_s: float  # the longest
    identical: bool | None = None  # in lock-step: every number of the recording equal to the one with the ideal link


def rows_of(runs: dict[str, list[list[Driven]]]) -> list[Row]:
    """One a scenario and disturbance; runs["none"] are those with the ideal link."""
    rows = []
    for index, first in enumerate(runs["none"][0]):
        ideal = [run[index].rms_mm for run in runs["none"]]
        for key, repetitions in runs.items():
            own = [run[index] for run in repetitions]
            rms = [each.rms_mm for each in own]
            change_mm = float(np.mean(rms) - np.mean(ideal))
            rows.append(
                Row(
                    scenario=first.scenario,
                    link=DISTURBANCES[key].words,
                    rms_mm=float(np.mean(rms)),
                    rms_min_mm=min(rms),
                    rms_max_mm=max(rms),
                    change_mm=change_mm,
                    change=change_mm / float(np.mean(ideal)),
                    ideal_spread_mm=max(ideal) - min(ideal),
                    closest_mm=max(each.closest_mm for each in own),
                    tracking=float(np.mean([each.tracking for each in own])),
                    rendered=float(np.mean([each.frames / each.frames_due for each in own])),
                    watched=float(np.mean([each.watched for each in own])),
                    gap_s=max(each.watched_gap_s for each in own),
                    identical=_same(own[0].recording, runs["none"][0][index].recording),
                )
            )
    return rows


def _same(one: Recording | None, other: Recording | None) -> bool | None:
    if one is None or other is None:
        return None
    pairs = [(getattr(one, name), getattr(other, name)) for name in COLUMNS]
    return all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in pairs)

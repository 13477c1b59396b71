"""The goals, as rows: which figure of which scenario, for whom, and what it is held against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from figures import physical_limit_m

from pilotfish.harness.driving import BASELINES

SCENARIOS = ("line", "circle", "stop_dead", "start", "reverse", "figure_eight", "square", "occlusion")
LAWS = ("paper", *BASELINES, "anticipate")

Figures = dict[str, dict[str, list[dict[str, float]]]]  # scenario -> law -> one per seed


@dataclass(frozen=True)
class Row:
    """One line of the table: `ours` is the worst over all seeds, the others are means; `goal` is an upper bound."""

    scenario: str
    figure: str
    goal: float
    goal_text: str
    ours: float
    others: dict[str, float]  # means over the seeds

    @property
    def met(self) -> bool:
        return bool(self.ours <= self.goal)

    @property
    def ratio(self) -> float:
        """Ours over the best baseline's; below 1 we are better."""
        best = min(self.others[law] for law in BASELINES)
        return self.ours / best if best > 0.0 else float("nan")


# (scenario, figure, greatest value)
FIXED_GOALS = [
    ("line", "steady-state error [mm]", 2.0),
    ("circle", "steady-state error [mm]", 2.0),
    ("line", "rms error [mm]", 5.0),
    ("circle", "rms error [mm]", 5.0),
    ("line", "rms bearing [deg]", 0.1),
    ("circle", "rms bearing [deg]", 0.2),
    ("line", "settling [s]", 4.0),
    ("circle", "settling [s]", 4.0),
    ("line", "overshoot [mm]", 20.0),
    ("circle", "overshoot [mm]", 20.0),
    ("stop_dead", "closest approach [mm]", 1.1 * 1000.0 * physical_limit_m()),
    ("stop_dead", "reversal [mm]", 20.0),
    ("start", "frames out of picture", 0.0),
    ("reverse", "frames out of picture", 0.0),
    ("figure_eight", "frames out of picture", 0.0),
    ("square", "frames out of picture", 0.0),
    ("occlusion", "command 100 ms after [m/s]", 0.0),
    ("occlusion", "back within 50 mm [s]", 3.0),
]
REPORTED = [
    (scenario, figure)
    for scenario in ("start", "reverse", "figure_eight", "square")
    for figure in ("peak error [mm]", "frames not measured")
]


def make_rows(measured: Figures) -> list[Row]:
    """Every row whose scenario was played."""
    rows = []
    for scenario, figure, most in FIXED_GOALS:
        if scenario in measured:
            rows.append(_row(measured, scenario, figure, most, f"≤ {most:.3g}"))
    for scenario, figure in REPORTED:
        if scenario in measured:
            rows.append(_row(measured, scenario, figure, float("inf"), "reported"))
    for scenario in measured:
        paper = _mean(measured, scenario, "paper", "rms jerk [m/s3]")
        rows.append(_row(measured, scenario, "rms jerk [m/s3]", paper, "≤ paper's"))
    for scenario in measured:
        for figure in ("rms error [mm]", "rms bearing [deg]"):
            best = min(_mean(measured, scenario, law, figure) for law in BASELINES)
            rows.append(_row(measured, scenario, figure, best, "≤ best baseline"))
    return rows


def _row(measured: Figures, scenario: str, figure: str, goal: float, text: str) -> Row:
    ours = max(run[figure] for run in measured[scenario]["anticipate"])
    others = {law: _mean(measured, scenario, law, figure) for law in LAWS if law != "anticipate"}
    return Row(scenario, figure, goal, text, ours, others)


def _mean(measured: Figures, scenario: str, law: str, figure: str) -> float:
    return float(np.mean([run[figure] for run in measured[scenario][law]]))

"""The measurements: everything in turns, so that whatever else the machine does slows all alike; medians of ratios."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from baselines import RESOLUTION, Law, pyfuzzylite_law, scikit_fuzzy_law, table_law
from noisy_following import at_steady_state_error, mean_of_runs

from pilotfish import control, fuzzy


@dataclass(frozen=True)
class Row:
    """Ours against one baseline, per evaluation."""

    what: str
    baseline: str
    goal: float  # the ratio that is wanted
    ours_ns: float
    baseline_ns: float
    ratio: float  # the median of the rounds' ratios, which is not the ratio of the medians
    spread: tuple[float, float]  # their quartiles
    baseline_error: float  # the greatest |du| between the baseline and ours

    @property
    def met(self) -> bool:
        return self.ratio >= self.goal


def row(
    what: str, baseline: str, goal: float, ours_ns: np.ndarray, baseline_ns: np.ndarray, baseline_error: float
) -> Row:
    ratios = baseline_ns / ours_ns
    low, middle, high = np.percentile(ratios, [25, 50, 75])
    return Row(
        what,
        baseline,
        goal,
        float(np.median(ours_ns)),
        float(np.median(baseline_ns)),
        float(middle),
        (low, high),
        baseline_error,
    )


def one_evaluation(program: Path, fll: Path, rounds: int) -> list[Row]:
    """C++ against C++: u alone, and u with the strengths of the 56 rules, as the robot publishes them."""
    answer = subprocess.run([program, fll, str(rounds)], check=True, capture_output=True, text=True).stdout
    *lines, last = (json.loads(line) for line in answer.splitlines())
    column = {name: np.array([line[name] for line in lines]) for name in lines[0]}
    rows = []
    for resolution, goal in ((100, 100.0), (1000, 500.0)):
        theirs_ns, error = column[f"fuzzylite_{resolution}_ns"], last[f"difference_{resolution}"]
        for ours, what in (("infer_ns", "C++: u and 56 strengths"), ("infer_output_ns", "C++: u alone")):
            rows.append(row(what, f"fuzzylite {resolution}", goal, column[ours], theirs_ns, error))
    return rows


def batches(controller: fuzzy.Controller, rounds: int, count: int = 1000) -> list[Row]:
    """Python, arrays (count,): ours and each baseline in turns on the same inputs."""
    e, ec = np.random.default_rng(7).uniform(-1, 1, (2, count))
    ours = fuzzy.infer_outputs(controller, e, ec)
    rows = []
    for name, goal, law, turns in (
        ("pyfuzzylite", 200.0, pyfuzzylite_law(controller), rounds),
        ("scikit-fuzzy", 2000.0, scikit_fuzzy_law(controller), max(rounds // 10, 3)),
    ):
        error = float(np.abs(law(e, ec) - ours).max())
        times = [
            (
                time_ns(lambda: fuzzy.infer_outputs(controller, e, ec), repeat=5),
                time_ns(lambda law=law: law(e, ec)),
            )
            for _ in range(turns)
        ]
        ours_ns, baseline_ns = np.array(times).T / count
        rows.append(row(f"Python: arrays ({count},)", f"{name} {RESOLUTION}", goal, ours_ns, baseline_ns, error))
    return rows


def time_ns(call: Callable[[], object], repeat: int = 1) -> float:
    begin = time.perf_counter_ns()
    for _ in range(repeat):
        call()
    return (time.perf_counter_ns() - begin) / repeat


def table_error(controller: fuzzy.Controller) -> float:
    """Of 257 x 257 values interpolated bilinearly: the greatest |du| over inputs between them."""
    e, ec = np.random.default_rng(8).uniform(-1, 1, (2, 400_000))
    table: Law = table_law(controller)
    return float(np.abs(table(e, ec) - fuzzy.infer_outputs(controller, e, ec)).max())


@dataclass(frozen=True)
class Width:
    """Inputs of k sigma against singletons at one noise; ratios below 1 are smoother."""

    sigma_m: float
    input_sigmas: float
    steady_state_error_m: float  # with the shipped error scale
    matched_scale_m: float | None  # the error scale at which it stands where singletons stand; None: there is none
    wanted_change_ratio: float | None  # at that scale: RMS change of the wanted speed
    command_change_ratio: float | None  # of the command, within the limits
    distance_ratio: float | None  # RMS of the distance about its mean


def widths(controller: fuzzy.Controller, quick: bool) -> list[Width]:
    """The curve over k, at several noises of the distance."""
    seeds = range(1 if quick else 5)
    found = []
    for sigma_m in (0.02,) if quick else (0.005, 0.01, 0.02, 0.03):
        singleton = mean_of_runs(controller, control.FuzzyVelocityConfig(), sigma_m, seeds)
        for k in (0.5, 1.0) if quick else (0.25, 0.5, 1.0, 2.0, 3.0):
            as_shipped = mean_of_runs(controller, control.FuzzyVelocityConfig(input_sigmas=k), sigma_m, seeds)
            matched = at_steady_state_error(controller, k, singleton.steady_state_error_m, sigma_m, seeds)
            ratios = [None] * 4
            if matched is not None:
                smoothness, scale_m = matched
                names = ("wanted_change_rms_mps", "command_change_rms_mps", "distance_rms_m")
                ratios = [scale_m, *(getattr(smoothness, name) / getattr(singleton, name) for name in names)]
            found.append(Width(sigma_m, k, as_shipped.steady_state_error_m, *ratios))
    return found


def as_json(rows: list[Row], error: float, curve: list[Width], machine: str) -> str:
    return json.dumps(
        {
            "machine": machine,
            "rows": [asdict(r) | {"met": r.met} for r in rows],
            "bilinear_257_error": error,
            "widths": [asdict(width) for width in curve],
        },
        indent=2,
    )

"""Finds the parameters of a law: one cost, one budget and one seeded search for all of them, so that a comparison
compares laws and not tuning effort.

Runs are played with drawn measurements (harness.drawn_observations), 100 times faster than with rendered pictures.
Nothing of the scenarios reported in bench/following is tuned on in its rendered form.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pilotfish import control, coordinator, data, sim
from pilotfish.extras import require
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.driving import Driving
from pilotfish.harness.in_process import run_in_process
from pilotfish.harness.scenario import Scenario
from pilotfish.metrics import rms_jerk_mps3
from pilotfish.recording import Recording
from pilotfish.whole_files import write_whole


@dataclass(frozen=True)
class Range:
    """Where to look for one parameter, on a logarithmic scale; key as in the coordinator's section ``control``."""

    low: float
    high: float


# What is searched, by who drives. Limits, drive model and safety are the robot's, not the law's: they stay.
SEARCH: dict[str, dict[str, Range]] = {
    "paper": {
        "velocity.error_scale_m": Range(0.1, 2.0),
        "velocity.error_change_scale_m": Range(0.005, 1.0),
        "velocity.velocity_scale_mps": Range(0.3, 1.5),
        "heading.gain_per_s": Range(0.5, 20.0),
    },
    "anticipate": {
        "anticipate.error_scale_m": Range(0.1, 2.0),
        "anticipate.error_change_scale_m": Range(0.005, 1.0),
        "anticipate.velocity_scale_mps": Range(0.3, 1.5),
        "anticipate.heading_gain_per_s": Range(0.5, 20.0),
        "anticipate.half_weight_sigma_mps": Range(0.02, 1.0),
        "leader_motion.quiescent_velocity_sigma": Range(2e-4, 0.02),
        "leader_motion.quiescent_turn_sigma": Range(1e-3, 0.2),
        "leader_motion.manoeuvre_velocity_sigma": Range(0.01, 0.5),
        "leader_motion.manoeuvre_turn_sigma": Range(0.03, 2.0),
        "leader_motion.abrupt_velocity_sigma": Range(0.3, 3.0),
        "leader_motion.change_rate_per_s": Range(0.01, 2.0),
    },
    "pbvs": {
        "pbvs.gain_at_zero": Range(0.5, 20.0),
        "pbvs.gain_at_infinity": Range(0.1, 20.0),
        "pbvs.slope_at_zero": Range(0.5, 1000.0),
    },
    "pid": {
        "pid.distance_kp": Range(0.3, 20.0),
        "pid.distance_ki": Range(0.02, 30.0),
        "pid.distance_kd": Range(0.001, 2.0),
        "pid.bearing_kp": Range(0.5, 20.0),
        "pid.bearing_ki": Range(0.02, 50.0),
        "pid.bearing_kd": Range(0.001, 2.0),
        "pid.derivative_filter_s": Range(0.005, 0.5),
    },
}

# For a law that is not listed: its parameters' own ranges, four decades where they begin at zero.
_DECADES = 1e-4


def search_ranges(name: str) -> dict[str, Range]:
    """What is searched for whoever drives: SEARCH, or all that a law has."""
    if name in SEARCH:
        return SEARCH[name]
    law = next(law for law in control.built_in_laws() if law.name == name)
    return {f"{name}.{each.key}": Range(max(each.min, each.max * _DECADES), each.max) for each in law.parameters}


# Scenario: how long it is played, and from when on its errors count.
PLAYED = {"line": (14.0, 5.0), "circle": (14.0, 5.0), "stop_dead": (15.0, 5.0), "square": (30.0, 5.0)}

# One unit of cost each.
RMS_ERROR_M, RMS_BEARING_RAD, JERK_MPS3, OVERSHOOT_M, BLIND_RATIO = 0.010, np.radians(0.5), 5.0, 0.020, 0.01


def cost(recording: Recording, counts_from_s: float) -> float:
    """How bad a run is. RMS distance error over 10 mm + RMS bearing error over 0.5 deg, once the start is over; RMS
    jerk of the command over 5 m/s3, overshoot over 20 mm and frames without the leader over 1 %, all along."""
    counts = recording.time_s - recording.time_s[0] >= counts_from_s
    error_m, bearing_rad = recording.distance_error_m[counts], recording.bearing_error_rad[counts]
    blind = float(np.mean(recording.status != "tracking"))
    return float(
        np.sqrt(np.mean(error_m**2)) / RMS_ERROR_M
        + np.sqrt(np.mean(bearing_rad**2)) / RMS_BEARING_RAD
        + rms_jerk_mps3(recording) / JERK_MPS3
        + max(0.0, float(recording.distance_error_m.max())) / OVERSHOOT_M
        + blind / BLIND_RATIO
    )


class Trial:
    """The cost of a set of parameters: the mean over the scenarios PLAYED."""

    def __init__(self, name: str, seed: int) -> None:
        self.name, self.seed = name, seed
        self._scenarios = {
            which: (Scenario.load(file), sim.load_scenario(file))
            for which in PLAYED
            for file in [data.path(f"scenarios/{which}.yaml")]
        }

    def __call__(self, parameters: Mapping[str, float]) -> float:
        costs = []
        for which, (scenario, spec) in self._scenarios.items():
            duration_s, counts_from_s = PLAYED[which]
            run = run_in_process(
                scenario,
                profile=self.name,
                spec=spec,
                configure=lambda config: set_parameters(config, parameters),
                drawn=DrawnObservations(self.seed),
                duration_s=duration_s,
            )
            costs.append(cost(run.recordings[scenario.robot().name], counts_from_s))
        return float(np.mean(costs))


@dataclass(frozen=True)
class Tuned:
    """What a search found."""

    driving: Driving
    parameters: dict[str, float]
    cost: float
    cost_before: float  # of what the configuration says
    trials: int
    seed: int

    def write(self, file: Path) -> Path:
        """As a file for ``tuning:`` or ``--tuning``."""
        sections: dict[str, dict[str, float]] = {}
        for key, value in self.parameters.items():
            section, name = key.split(".")
            sections.setdefault(section, {})[name] = float(f"{value:.6g}")
        write_whole(
            file,
            f"# Made by: pilotfish tune {self.driving.name} --trials {self.trials} --seed {self.seed}\n"
            f"# Cost {self.cost:.3f}, before {self.cost_before:.3f} (see pilotfish.tuning).\n"
            + yaml.safe_dump(sections),
        )
        return file


class _LawSection:
    """A law's numbers as attributes, as those of every other section of ``control`` are."""

    def __init__(self, config: control.FollowerConfig, law: str) -> None:
        self.__dict__.update(config=config, law=law)

    def __getattr__(self, key: str) -> float:
        return self.config.law_parameters(self.law)[key]

    def __setattr__(self, key: str, value: float) -> None:
        self.config.set_law_parameter(self.law, key, value)


def _section(config: control.FollowerConfig, name: str) -> Any:
    return _LawSection(config, name) if any(law.name == name for law in config.laws) else getattr(config, name)


def set_parameters(config: coordinator.CoordinatorConfig, parameters: Mapping[str, float]) -> None:
    """Keys as in SEARCH, "section.key" of the coordinator's section ``control``."""
    for key, value in parameters.items():
        section, name = key.split(".")
        setattr(_section(config.control, section), name, value)


def current_parameters(name: str) -> dict[str, float]:
    """What the first scenario's coordinator is configured with: where the search begins."""
    config = coordinator.load_coordinator(
        Scenario.load(data.path("scenarios/line.yaml")).robot().coordinator_file
    ).coordinator
    Driving(name).apply(config)
    keys = (key.split(".") for key in search_ranges(name))
    return {f"{section}.{key}": getattr(_section(config.control, section), key) for section, key in keys}


def tune(name: str, trials: int, seed: int, on_trial: Callable[[int, int], None] | None = None) -> Tuned:
    """A seeded search with Optuna's TPE; the first trial is what the configuration says. The same seed gives the same
    result."""
    best = None
    for best in searching(name, trials, seed):
        if on_trial:
            on_trial(best.trials, trials)
    assert best is not None, "one trial at least"
    return best


def searching(name: str, trials: int, seed: int) -> Iterator[Tuned]:
    """The same search: after each trial the best so far, which is what ``tune`` with so many trials returns."""
    optuna = require("optuna", "tune")
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    trial_cost, start, ranges = Trial(name, seed), current_parameters(name), search_ranges(name)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed, multivariate=False))
    study.enqueue_trial(start)
    for done in range(1, trials + 1):
        # Asked and told, not study.optimize(): that takes Ctrl-C for a failed trial, and logs its traceback.
        trial = study.ask()
        parameters = {key: trial.suggest_float(key, span.low, span.high, log=True) for key, span in ranges.items()}
        study.tell(trial, trial_cost(parameters))
        yield Tuned(Driving(name), dict(study.best_params), study.best_value, study.trials[0].value, done, seed)

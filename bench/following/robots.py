"""Robots and cameras that are not ideal: pictures dropped, slow or late; wheels that slip, step and lag.

scripts/bench following -- --robots        all laws under all conditions; drawn measurements
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.driving import BASELINES
from pilotfish.harness.timed import TimedRun, Timing, Wheels, run_timed

LAWS = ("anticipate", *BASELINES, "paper")
FROM_S, DURATION_S = 15.0, 40.0
FRAME_S = 1.0 / 30.0


@dataclass(frozen=True)
class Condition:
    """Unmodelled: not in the laws' configuration."""

    name: str
    timing: Timing = field(default_factory=Timing)
    wheels: Wheels = field(default_factory=Wheels)
    vibration_deg: float = 0.0
    slow_camera: bool = False  # with the explicit mode for it: max_age_s 0.2 and at most 0.3 m/s


NONIDEAL = Wheels(lag_s=0.12, slip=0.02, slip_sigma=0.015, step_mps=0.005, gain=0.99)
LATE = Timing(latency_s=0.054, latency_jitter_s=0.01)
CONDITIONS = (
    Condition("ideal"),
    Condition("20 % of the pictures dropped", Timing(drop_probability=0.2)),
    Condition("50 % dropped", Timing(drop_probability=0.5)),
    Condition("20 Hz, 20 % dropped", Timing(frame_rate_hz=20.0, drop_probability=0.2)),
    Condition("9.9 Hz", Timing(frame_rate_hz=9.9)),
    Condition("8 Hz, its mode", Timing(frame_rate_hz=8.0), slow_camera=True),
    Condition("latency 140 ms", Timing(latency_s=0.14)),
    Condition("latency 289 ms", Timing(latency_s=0.289)),
    Condition("lag 10 ms", wheels=Wheels(lag_s=0.01)),
    Condition("lag 300 ms", wheels=Wheels(lag_s=0.3)),
    Condition("stamps off by 10 ms", Timing(stamp_jitter_s=0.01)),
    Condition("vibration 0.2 deg", vibration_deg=0.2),
    Condition("non-ideal wheels, late camera", LATE, NONIDEAL),
    Condition("the same, vibrating 0.1 deg", LATE, NONIDEAL, vibration_deg=0.1),
)


def slow_camera_mode(config) -> None:
    safety, control = config.safety, config.control
    limits = control.limits
    safety.max_age_s, limits.max_linear_mps, limits.max_reverse_mps = 0.2, 0.3, 0.3
    config.safety = safety
    control.limits = limits
    config.control = control


def play(scenario: str, law: str, condition: Condition, seed: int) -> TimedRun:
    return run_timed(
        scenario,
        law=law,
        seed=seed,
        timing=condition.timing,
        wheels=condition.wheels,
        duration_s=DURATION_S,
        drawn=DrawnObservations(seed, vibration_rad=np.radians(condition.vibration_deg)),
        configure=slow_camera_mode if condition.slow_camera else None,
    )


def figures(runs: list[TimedRun]) -> dict[str, float]:
    """Over all runs: mean and RMS of d - d_p [mm], and the RMS jerk of the command [m/s^3]."""
    errors_mm = 1e3 * np.concatenate([run.distance_error_m(FROM_S) for run in runs])
    return {
        "mean_mm": float(errors_mm.mean()),
        "rms_mm": float(np.sqrt(np.mean(errors_mm**2))),
        "jerk_mps3": float(np.mean([jerk_mps3(run) for run in runs])),
    }


def jerk_mps3(run: TimedRun) -> float:
    times_s = np.arange(FROM_S, run.time_s[-1], FRAME_S)
    commands = run.command_mps[np.searchsorted(run.time_s, times_s)]
    return float(np.sqrt(np.mean(np.diff(commands, 2) ** 2))) / FRAME_S**2


def measure(seeds: int, scenarios: tuple[str, ...] = ("line", "figure_eight")) -> list[dict[str, object]]:
    """A row per scenario, condition and law."""
    jobs = [(which, condition, law) for which in scenarios for condition in CONDITIONS for law in LAWS]
    rows: list[dict[str, object]] = []
    for which, condition, law in track(jobs, "robots", console=Console(stderr=True)):
        runs = [play(which, law, condition, seed) for seed in range(1, seeds + 1)]
        rows.append({"scenario": which, "condition": condition.name, "law": law, **figures(runs)})
    return rows


def table(rows: list[dict[str, object]]) -> Table:
    """Mean +- RMS of the distance error [mm], and the jerk, of each law."""
    result = Table(title="Robots that are not ideal: d - d_p, mean / RMS in mm, and jerk in m/s3", title_justify="left")
    for column in ("scenario", "condition", *LAWS):
        result.add_column(column, justify="right" if column in LAWS else "left")
    for which, name in dict.fromkeys((row["scenario"], row["condition"]) for row in rows):
        of_law = {row["law"]: row for row in rows if (row["scenario"], row["condition"]) == (which, name)}
        cells = [f"{r['mean_mm']:.1f} / {r['rms_mm']:.1f}, {r['jerk_mps3']:.1f}" for r in map(of_law.get, LAWS)]
        result.add_row(str(which), str(name), *cells)
    return result

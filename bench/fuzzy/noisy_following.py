"""What width the inputs of eq. (6) should have when the distance is noisy: following on a line, in one dimension.

A leader drives at constant speed; the follower sees its distance with white noise, 30 times a second, and drives as the
velocity law says, within the limits, one frame late and behind an actuator lag. No heading, no camera: what is left is
the law's own answer to noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish import control, core, fuzzy

PERIOD_S = 1 / 30
LAG_S = 0.1
SETPOINT_M = 1.10
SETTLING_S = 13.0
DURATION_S = 50.0


@dataclass(frozen=True)
class Smoothness:
    """Command variation of one law, and its steady-state error."""

    steady_state_error_m: float  # mean of d_p - d
    distance_rms_m: float  # of d about its mean
    wanted_change_rms_mps: float  # RMS change from frame to frame of the speed that the law asks for
    command_change_rms_mps: float  # of the speed commanded, within the limits on acceleration


def follow_noisily(
    law: fuzzy.Controller, config: control.FuzzyVelocityConfig, sigma_m: float, seed: int, leader_mps: float = 0.2
) -> Smoothness:
    """One run; sigma_m: of the noise, known to the law (as vision's covariance says it)."""
    rng = np.random.default_rng(seed)
    limits = control.LimitsConfig()
    distance_m, speed_mps, error_m = SETPOINT_M + 0.17, leader_mps, None
    command = late = core.Twist(linear_mps=leader_mps)
    follows = 1.0 - np.exp(-PERIOD_S / LAG_S)
    wanted, commanded, errors = [], [], []
    for _ in range(round(DURATION_S / PERIOD_S)):
        seen_m = distance_m + sigma_m * rng.standard_normal()
        said = control.fuzzy_velocity(law, config, SETPOINT_M, seen_m, error_m, PERIOD_S, sigma_m)
        error_m = said.error_m
        late, command = command, control.limit(limits, core.Twist(linear_mps=said.linear_mps), command, PERIOD_S)
        speed_mps += (late.linear_mps - speed_mps) * follows
        distance_m += (leader_mps - speed_mps) * PERIOD_S
        wanted.append(said.linear_mps)
        commanded.append(command.linear_mps)
        errors.append(SETPOINT_M - distance_m)
    settled = slice(round(SETTLING_S / PERIOD_S), None)
    error = np.array(errors[settled])
    return Smoothness(
        float(error.mean()), float(error.std()), _change_rms(wanted[settled]), _change_rms(commanded[settled])
    )


def _change_rms(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.diff(values) ** 2)))


def mean_of_runs(
    law: fuzzy.Controller, config: control.FuzzyVelocityConfig, sigma_m: float, seeds: range
) -> Smoothness:
    """The mean of several runs, figure by figure."""
    runs = [follow_noisily(law, config, sigma_m, seed) for seed in seeds]
    names = Smoothness.__dataclass_fields__
    return Smoothness(**{name: float(np.mean([getattr(run, name) for run in runs])) for name in names})


def at_steady_state_error(
    law: fuzzy.Controller, input_sigmas: float, steady_state_error_m: float, sigma_m: float, seeds: range
) -> tuple[Smoothness, float] | None:
    """The law with inputs that wide, its error scale [m] chosen so that it stands at the given error, within 1 %.

    A wide B' fires rules for leaders that come and leave as well, and the table answers the two unequally: the
    steady-state error grows. A smaller scale takes that back, at the price of a steeper law, and only then are two
    widths comparable. Returns what came of it and the scale; None if no scale does it, because A', as wide as the
    noise, then takes up the universe. The steady-state error is about proportional to the scale, so steps of
    proportion find it.
    """
    scale_m = control.FuzzyVelocityConfig().error_scale_m
    for _ in range(8):
        config = control.FuzzyVelocityConfig(input_sigmas=input_sigmas, error_scale_m=scale_m)
        smoothness = mean_of_runs(law, config, sigma_m, seeds)
        if abs(smoothness.steady_state_error_m / steady_state_error_m - 1.0) < 0.01:
            return smoothness, scale_m
        scale_m *= steady_state_error_m / smoothness.steady_state_error_m
        if scale_m < 4.0 * sigma_m:
            return None
    return None

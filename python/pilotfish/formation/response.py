"""How a chain answers its leader's speed: gains by least squares, ratios of peaks after a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish.recording import FloatArray

ComplexArray = np.ndarray


@dataclass(frozen=True)
class SineFit:
    """A signal of each robot as offset + slope t + Re(phasor exp(j w t)) + residual."""

    phasor: ComplexArray  # (R,), in the signal's unit
    residual_rms: FloatArray  # (R,): noise, harmonics, what of the transient is left


def fit_sine(time_s: FloatArray, signals: FloatArray, frequency_hz: float) -> SineFit:
    """Least squares over all samples; time_s (N,), signals (R, N).

    With x = a cos wt + b sin wt = Re((a - jb) exp(jwt)) the phasor is a - jb. The offset and the slope take up a mean
    and a slow drift, so the window need not be whole periods to a sample.
    """
    phase = 2.0 * np.pi * frequency_hz * time_s
    centred_s = time_s - time_s.mean()
    basis = np.stack([np.ones_like(phase), centred_s, np.cos(phase), np.sin(phase)], axis=-1)
    solution, *_ = np.linalg.lstsq(basis, signals.T, rcond=None)
    residual = signals.T - basis @ solution
    return SineFit(solution[2] - 1j * solution[3], np.sqrt(np.mean(np.square(residual), axis=0)))


@dataclass(frozen=True)
class StepResponse:
    """After a step of the leader's speed from v0 to v1, robot by robot from the first follower on, shape (R - 1,)."""

    overshoot: FloatArray  # (max v - v1) / (v1 - v0): beyond the new speed, as a share of the step; 0: none
    peak_error_m: FloatArray  # max |e - e before the step| until the end
    overshoot_ratio: FloatArray  # (R - 2,): of robot i + 1 over robot i; nan where robot i has none (below 1 %)
    peak_error_ratio: FloatArray  # (R - 2,): the same of peak_error_m


MIN_OVERSHOOT = 0.01


def step_response(
    time_s: FloatArray,
    speed_mps: FloatArray,
    error_m: FloatArray,
    step_at_s: float,
    before_mps: float,
    after_mps: float,
) -> StepResponse:
    """speed_mps (R, N) with the leader's in row 0, error_m (R - 1, N). The error before the step is its mean over the
    second before it."""
    after = time_s >= step_at_s
    just_before = (time_s < step_at_s) & (time_s >= step_at_s - 1.0)
    rise_mps = after_mps - before_mps
    beyond = ((speed_mps[1:, after] - after_mps) * np.sign(rise_mps)).max(axis=1)
    overshoot = np.maximum(0.0, beyond / abs(rise_mps))
    rest_m = error_m[:, just_before].mean(axis=1, keepdims=True)
    peak_m = np.abs(error_m[:, after] - rest_m).max(axis=1)
    known = overshoot[:-1] >= MIN_OVERSHOOT
    ratio = np.where(known, overshoot[1:] / np.where(known, overshoot[:-1], 1.0), np.nan)
    return StepResponse(overshoot, peak_m, ratio, peak_m[1:] / peak_m[:-1])

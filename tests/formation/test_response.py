"""Gains by least squares, and peaks after a step, on signals written down by formula."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lsim, lti

from pilotfish.formation.response import fit_sine, step_response


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.floats(0.05, 2.0), st.floats(0.01, 1.0), st.floats(-3.0, 3.0), st.floats(-1.0, 1.0), st.floats(-0.1, 0.1))
def test_amplitude_and_phase_of_a_sine_on_an_offset_and_a_slope_are_found(
    frequency_hz, amplitude, phase, offset, slope
):
    time_s = np.arange(0.0, max(10.0, 2.0 / frequency_hz), 1 / 30.0)
    signal = offset + slope * time_s + amplitude * np.cos(2 * math.pi * frequency_hz * time_s + phase)
    fit = fit_sine(time_s, np.stack([signal, 2 * signal]), frequency_hz)
    assert fit.phasor[0] == pytest.approx(amplitude * np.exp(1j * phase), abs=1e-7)
    assert abs(fit.phasor[1] / fit.phasor[0]) == pytest.approx(2.0)
    assert fit.residual_rms.max() < 1e-6


@pytest.mark.parametrize("frequency_hz", [0.05, 0.2, 0.8])
def test_a_chain_of_first_order_lags_has_the_gain_of_first_order_lags(frequency_hz):
    """scipy integrates V' = (U - V) / tau; |G| = 1 / sqrt(1 + (w tau)^2) between any two."""
    tau_s, time_s = 0.5, np.arange(0.0, 60.0, 1 / 100.0)
    speeds = [0.2 + 0.05 * np.sin(2 * math.pi * frequency_hz * time_s)]
    for _ in range(3):
        speeds.append(lsim(lti([1.0], [tau_s, 1.0]), speeds[-1], time_s)[1])
    late = time_s >= 20.0
    phasors = np.abs(fit_sine(time_s[late], np.array(speeds)[:, late], frequency_hz).phasor)
    expected = 1.0 / math.hypot(1.0, 2 * math.pi * frequency_hz * tau_s)
    assert phasors[1:] / phasors[:-1] == pytest.approx([expected] * 3, rel=2e-3)


def test_noise_ends_up_in_the_residual():
    time_s = np.arange(0.0, 60.0, 1 / 30.0)
    noise = 0.01 * np.random.default_rng(1).standard_normal(len(time_s))
    fit = fit_sine(time_s, np.array([np.sin(time_s) + noise]), 1 / (2 * math.pi))
    assert fit.residual_rms[0] == pytest.approx(0.01, rel=0.05)


def test_the_overshoot_of_a_second_order_system_is_that_of_the_textbook():
    """Step response of w0^2 / (s^2 + 2 z w0 s + w0^2): overshoot exp(-pi z / sqrt(1 - z^2)); 0.254 for z = 0.4."""
    time_s = np.arange(0.0, 40.0, 0.01)
    leader = np.where(time_s < 5.0, 0.1, 0.3)
    second = lti([4.0], [1.0, 1.6, 4.0])
    speeds = [leader, 0.1 + lsim(second, leader - 0.1, time_s)[1]]
    gap_m = np.cumsum(speeds[0] - speeds[1]) * 0.01
    speeds.append(speeds[1])
    step = step_response(
        time_s, np.array(speeds), np.array([-gap_m, -2 * gap_m]), step_at_s=5.0, before_mps=0.1, after_mps=0.3
    )
    assert step.overshoot[0] == pytest.approx(math.exp(-math.pi * 0.4 / math.sqrt(1 - 0.16)), rel=0.01)
    assert step.overshoot_ratio[0] == pytest.approx(1.0)
    assert step.peak_error_ratio[0] == pytest.approx(2.0)


def test_a_steady_error_before_the_step_does_not_count_as_one_of_the_step():
    time_s = np.arange(0.0, 10.0, 0.1)
    error_m = np.array([np.where(time_s < 5.0, -0.16, -0.2), np.where(time_s < 5.0, -0.16, -0.12)])
    speed = np.tile(np.where(time_s < 5.0, 0.1, 0.2), (3, 1))
    step = step_response(time_s, speed, error_m, step_at_s=5.0, before_mps=0.1, after_mps=0.2)
    assert step.peak_error_m == pytest.approx([0.04, 0.04])
    assert np.isnan(step.overshoot_ratio).all(), "no overshoot: no ratio"

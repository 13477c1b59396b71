"""Non-singleton inputs in the velocity law: their widths, and the command variation when the distance is noisy."""

import math

import numpy as np
import pytest

from bench.fuzzy.noisy_following import at_steady_state_error, follow_noisily, mean_of_runs
from pilotfish import control, fuzzy

SEEDS = range(2)


def test_the_widths_are_the_sigma_of_the_distance_and_of_the_difference_of_two(controller):
    # e = 1.1 - 1.2 = -0.1 m of 0.8; ec = -0.1 - -0.09 = -0.01 m over 1.5 periods: -0.00667 m of 0.02.
    # With k = 2 and sigma_d = 0.03: A' has 0.06/0.8, B' has sqrt(2) 0.06 m over 1.5 periods, of 0.02.
    config = control.FuzzyVelocityConfig(input_sigmas=2.0)
    command = control.fuzzy_velocity(controller, config, 1.1, 1.2, -0.09, 0.05, 0.03)
    widths = fuzzy.InputWidths(0.06 / 0.8, math.sqrt(2) * 0.06 / 1.5 / 0.02, fuzzy.WidthShape.gaussian)
    expected = fuzzy.infer(controller, -0.1 / 0.8, -0.01 / 1.5 / 0.02, widths)
    assert command.inference.output == pytest.approx(expected.output, abs=1e-12)
    np.testing.assert_allclose(command.inference.strengths, expected.strengths, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("sigmas", "sigma_m"), [(0.0, 0.03), (2.0, 0.0), (2.0, math.nan), (2.0, math.inf)], ids=str)
def test_without_a_width_or_a_sigma_the_inputs_are_singletons(controller, sigmas, sigma_m):
    config = control.FuzzyVelocityConfig(input_sigmas=sigmas)
    singleton = control.fuzzy_velocity(controller, control.FuzzyVelocityConfig(), 1.1, 1.2, -0.09, 0.05)
    command = control.fuzzy_velocity(controller, config, 1.1, 1.2, -0.09, 0.05, sigma_m)
    assert command.linear_mps == singleton.linear_mps


def test_the_first_measurement_has_no_change_and_so_no_width_of_it(controller):
    config = control.FuzzyVelocityConfig(input_sigmas=1.0)
    command = control.fuzzy_velocity(controller, config, 1.1, 1.2, None, 0.0, 0.03)
    expected = fuzzy.infer(controller, -0.125, 0.0, fuzzy.InputWidths(0.0375, 0.0, fuzzy.WidthShape.gaussian))
    assert command.inference.output == pytest.approx(expected.output, abs=1e-12)


@pytest.mark.parametrize("sigma_m", [0.02, 0.03])
def test_at_long_range_inputs_of_one_sigma_reduce_command_variation_at_the_same_steady_state_error(controller, sigma_m):
    # Measured: the frame-to-frame change of the wanted speed falls to 0.31 (20 mm) and 0.32 (30 mm) of that with
    # singletons, the spread of the distance to 0.54 and 0.39.
    singleton = mean_of_runs(controller, control.FuzzyVelocityConfig(), sigma_m, SEEDS)
    wide, scale_m = at_steady_state_error(controller, 1.0, singleton.steady_state_error_m, sigma_m, SEEDS)
    assert wide.steady_state_error_m == pytest.approx(singleton.steady_state_error_m, rel=0.01)
    assert 0.4 < scale_m < 0.8
    assert wide.wanted_change_rms_mps < 0.45 * singleton.wanted_change_rms_mps
    assert wide.command_change_rms_mps < singleton.command_change_rms_mps
    assert wide.distance_rms_m < 0.8 * singleton.distance_rms_m


def test_without_noise_the_widths_change_nothing(controller):
    quiet = [follow_noisily(controller, control.FuzzyVelocityConfig(input_sigmas=k), 0.0, seed=1) for k in (0.0, 1.0)]
    assert quiet[0] == quiet[1]

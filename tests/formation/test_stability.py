"""Whether a disturbance grows from robot to robot; gaps of a chain on curves."""

import json
import math

import numpy as np
import pytest

from pilotfish import coordinator, data, fuzzy
from pilotfish.errors import ConfigError
from pilotfish.formation.chain import chain_of, drive_chain
from pilotfish.formation.gaps import path_of, steady_gaps
from pilotfish.formation.stability import Trial, measure, sine_speed_mps, to_json, window_s

SPEED_MPS = 0.2


@pytest.fixture(scope="module")
def results():
    trial = Trial(robots=4, frequencies_hz=(0.1, 0.4))
    return {result.law: result for result in measure(["paper", "anticipate"], trial=trial, jobs=1)}


def steady_gap_growth_s():
    """h = d(d)/dv of the published law behind a leader at SPEED_MPS: the error settles where V u(e / E, 0) = v."""
    config = coordinator.load_coordinator(str(data.path("config/coordinator.yaml"))).coordinator.control
    velocity = config.velocity

    def gap_m(speed_mps):
        low, high = -velocity.error_scale_m, 0.0  # u falls from its maximum to 0
        for _ in range(60):
            middle = (low + high) / 2
            u = fuzzy.infer(config.law, middle / velocity.error_scale_m, 0.0).output
            low, high = (middle, high) if velocity.velocity_scale_mps * u > speed_mps else (low, middle)
        return -low

    return (gap_m(SPEED_MPS + 0.005) - gap_m(SPEED_MPS - 0.005)) / 0.01


def test_the_published_law_damps_as_its_surface_and_the_delays_of_the_loop_say(results):
    """Near a speed the law is v = D / h, with h the seconds by which the gap D grows with the speed. It acts after the
    latency of one frame and, held for a frame, half a frame more (L = 50 ms), and through the wheels' lag (0.1 s); the
    gap is the integral of the difference of the speeds:

        V (1 + s lag) exp(s L) = D / h,  D = (V_leader - V) / s   =>   G = 1 / (1 + s h (1 + s lag) exp(s L))
    """
    s = 2j * math.pi * 0.1
    expected = abs(1.0 / (1.0 + s * steady_gap_growth_s() * (1.0 + 0.1 * s) * np.exp(0.05 * s)))
    assert results["paper"].gain[0] == pytest.approx(np.full(3, expected), rel=0.01)


def test_a_law_without_a_steady_state_error_amplifies_somewhere_and_the_published_one_does_not(results):
    """Bode's integral: see pilotfish.formation.stability."""
    assert results["paper"].string_stable and results["paper"].peak_gain < 1.0
    assert not results["anticipate"].string_stable and results["anticipate"].peak_gain > 1.1
    assert results["anticipate"].peak_at_hz == 0.4


def test_gains_multiply_along_the_chain_and_a_long_chain_contains_the_shorter_ones(results):
    for result in results.values():
        assert np.cumprod(result.gain, axis=1) == pytest.approx(result.from_leader)
        assert result.peak_from_leader == pytest.approx(result.from_leader.max(axis=0))
    (short,) = measure(["paper"], trial=Trial(robots=3, frequencies_hz=(0.1,)), jobs=1)
    assert short.gain[0] == pytest.approx(results["paper"].gain[0, :2], rel=0.01)


def test_the_step_of_the_published_law_needs_the_room_by_which_the_gap_grows(results):
    """From 0.18 to 0.22 m/s: each gap grows by 0.04 h, monotonically, the same for every robot."""
    expected_m = 0.04 * steady_gap_growth_s()
    assert results["paper"].step.peak_error_m == pytest.approx(np.full(3, expected_m), rel=0.05)
    assert results["paper"].step.peak_error_ratio == pytest.approx([1.0, 1.0], abs=0.02)
    assert results["paper"].step.overshoot.max() < 0.02


def test_the_figures_are_plain_json(results):
    trial = Trial(robots=4, frequencies_hz=(0.1, 0.4))
    said = json.loads(json.dumps(to_json(list(results.values()), trial), allow_nan=False))
    assert said["trial"]["robots"] == 4
    assert said["results"][0]["law"] == "paper" and said["results"][0]["string_stable"] is True
    assert len(said["results"][1]["gain"]) == 2


def test_what_is_damped_below_a_hundredth_is_noise_and_no_gain():
    """The published law has |G| < 0.25 at 1.1 Hz: after three or four robots less than a hundredth is left."""
    (result,) = measure(["paper"], trial=Trial(robots=5, frequencies_hz=(1.1,)), jobs=1)
    known = np.isfinite(result.gain[0])
    assert known[0] and not known[-1]
    assert result.from_leader[0, np.flatnonzero(~known)[0] - 1] < 0.01


def test_the_leader_has_exactly_the_speed_it_is_told_and_all_see_each_other():
    trial = Trial(robots=3)
    run = drive_chain(chain_of(3, 1.0), "paper", lambda t: sine_speed_mps(trial, 0.5, t), 4.0)
    assert run.speed_mps[0] == pytest.approx([sine_speed_mps(trial, 0.5, t) for t in run.time_s])
    assert run.seen_ratio == pytest.approx([1.0, 1.0])
    # The gap is the integral of the difference of speeds: trapezoids of 33 ms, of speeds that change by 0.2 m/s2.
    steps = np.diff(run.time_s) * (
        run.speed_mps[0, 1:] + run.speed_mps[0, :-1] - run.speed_mps[1, 1:] - run.speed_mps[1, :-1]
    )
    assert -run.spacing_error_m[0, 1:] == pytest.approx(np.cumsum(steps / 2), abs=2e-3)


@pytest.mark.parametrize("frequency_hz", [0.02, 0.3, 1.1])
def test_the_window_is_whole_periods_after_the_transient(frequency_hz):
    start_s, end_s = window_s(Trial(), frequency_hz)
    periods = (end_s - start_s) * frequency_hz
    assert periods == pytest.approx(round(periods)) and periods >= 2
    assert start_s > SPEED_MPS / 0.1


@pytest.mark.parametrize("amplitude_mps", [0.0, 0.2, 1.0])
def test_a_leader_that_would_stop_is_refused(amplitude_mps):
    with pytest.raises(ConfigError, match=r"amplitude_mps: .* so that the leader never stops"):
        measure(["pid"], trial=Trial(amplitude_mps=amplitude_mps), jobs=1)


def test_a_headway_makes_the_gap_grow_with_the_speed():
    run = drive_chain(chain_of(2, 1.0), "anticipate", lambda t: min(0.1 * t, 0.2), 15.0, headway_s=1.0)
    assert abs(run.spacing_error_m[0, -1]) < 0.005, "e = d_p + h v - d, so d is 1.2 m"
    last_second = run.speed_mps[1, -30:]
    assert np.ptp(last_second) < 0.001, "it does not swing by itself"


def test_from_the_headway_that_theory_asks_for_on_no_robot_of_a_chain_amplifies():
    """2 (latency + lag) = 2 (0.033 + 0.1) s; 1.1 times that is 0.293 s. Two robots: the second sees the first's answer.
    Without a headway Bode's integral forbids it."""
    trial = Trial(robots=3, frequencies_hz=(0.1, 0.28, 0.4, 0.56))
    without, headway, longer = measure(["anticipate"], [0.0, 0.3, 1.0], trial, jobs=1)
    assert without.peak_gain > 1.2
    assert headway.peak_gain < 1.005
    assert longer.peak_gain < 1.0


@pytest.mark.parametrize("robots", [2, 5, 12])
def test_the_last_robot_of_a_chain_on_the_circle_turns_with_a_radius_of_a_metre_and_a_half(robots):
    """Each drives on the tangent to its own circle: r^2 falls by d^2 from robot to robot."""
    trajectory, _ = path_of("circle", robots, 1.0, SPEED_MPS)
    last_m = math.sqrt(trajectory["radius_m"] ** 2 - (robots - 1))
    assert last_m == pytest.approx(1.5, abs=0.26) and last_m >= 1.5


def test_on_a_circle_every_robot_of_a_chain_keeps_its_gap_to_5_mm_and_its_bearing_to_0_3_degrees():
    gaps = steady_gaps("circle", robots=3, speed_mps=0.5)
    assert gaps.reached and len(gaps.keeping) == 2
    assert gaps.least_apart_m > 0.9


def test_the_published_law_misses_that_goal():
    assert not steady_gaps("line", "paper", robots=2).reached

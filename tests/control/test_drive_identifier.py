"""The drive identifies itself: latency and lag, from the own commands and from what is seen. Nobody tells them."""

import itertools

import numpy as np
import pytest

from pilotfish import control, core
from pilotfish.harness.drawn_observations import DrawnObservations
from pilotfish.harness.timed import Timing, Wheels, run_timed

TOLD_LATENCY_S, TOLD_LAG_S = 1.0 / 30.0, 0.1  # what is used if nothing is configured
SLOWER = [(0.14, 0.1), (0.2, 0.1), (0.29, 0.1), (0.2, 0.3), (TOLD_LATENCY_S, 0.3)]  # latency and lag [s]
OTHERS = [(0.02, 0.1), (0.14, 0.1), (0.289, 0.1), (TOLD_LATENCY_S, 0.01), (TOLD_LATENCY_S, 0.3)]


def telling(latency_s=TOLD_LATENCY_S, lag_s=TOLD_LAG_S, identify=True):
    def configure(config):
        control_ = config.control
        drive = control_.drive
        drive.latency_s, drive.actuator_lag_s, drive.identify = min(latency_s, 0.25), lag_s, identify
        control_.drive = drive
        config.control = control_

    return configure


def drive_after(run_s, scenario="line", *, latency_s=TOLD_LATENCY_S, lag_s=TOLD_LAG_S, **keywords):
    keywords = {"timing": Timing(latency_s=latency_s), "wheels": Wheels(lag_s=lag_s)} | keywords
    answers = []
    run_timed(scenario, duration_s=run_s, on_answer=lambda _, answer: answers.append(answer), **keywords)
    return answers[-1].control.drive


@pytest.mark.parametrize(
    ("latency_s", "lag_s"), [(0.14, 0.1), (0.2, 0.1), (0.29, 0.1), (0.2, 0.3), (TOLD_LATENCY_S, 0.3)]
)
@pytest.mark.parametrize("scenario", ["line", "figure_eight"])
def test_within_ten_seconds_the_delays_are_known(scenario, latency_s, lag_s):
    # The start alone, from 2.4 m to 1.1 m, changes the speed often enough. The command is renewed every 5 ms: the true
    # latency is up to that much longer than the camera's.
    drive = drive_after(10.0, scenario, latency_s=latency_s, lag_s=lag_s)
    assert drive.differs_from_settings
    assert drive.latency_s == pytest.approx(latency_s + 0.0025, abs=0.0125)
    assert drive.actuator_lag_s == pytest.approx(lag_s, rel=0.2)
    assert drive.latency_s + drive.actuator_lag_s == pytest.approx(latency_s + lag_s, abs=0.0125)


@pytest.mark.parametrize(
    "delays", [(0.02, 0.1), (0.14, 0.1), (0.289, 0.1), (TOLD_LATENCY_S, 0.01), (TOLD_LATENCY_S, 0.3)]
)
@pytest.mark.parametrize("scenario", ["line", "figure_eight"])
def test_untold_delays_cost_no_more_than_told_ones(scenario, delays):
    # Before: a limit cycle of 33 mm RMS at 140 ms, of 98 mm at 289 ms, 2.3 mm at a lag of 10 ms.
    def rms_m(configure):
        timing, wheels = Timing(latency_s=delays[0]), Wheels(lag_s=delays[1])
        run = run_timed(scenario, timing=timing, wheels=wheels, duration_s=30.0, configure=configure)
        return np.sqrt(np.mean(run.distance_error_m(12.0) ** 2))

    assert rms_m(telling()) <= 1.2 * rms_m(telling(*delays, identify=False)) + 0.05e-3


@pytest.mark.parametrize("scenario", ["line", "circle", "square", "waypoints", "stop_dead"])
@pytest.mark.parametrize("scale", [1.0, 20.0])
def test_true_settings_are_kept_whatever_the_leader_does(scenario, scale):
    for seed in (1, 2, 3):
        drive = drive_after(20.0, scenario, seed=seed, drawn=DrawnObservations(seed, scale=scale))
        assert (drive.latency_s, drive.actuator_lag_s) == (TOLD_LATENCY_S, TOLD_LAG_S)


def test_true_settings_are_kept_on_wheels_that_slip_and_step_and_a_camera_that_vibrates():
    timing = Timing(latency_jitter_s=0.01)
    wheels = Wheels(slip=0.02, slip_sigma=0.015, step_mps=0.005, gain=0.99)
    for seed in (1, 2, 3):
        drawn = DrawnObservations(seed, vibration_rad=np.radians(0.1))
        drive = drive_after(20.0, "waypoints", seed=seed, timing=timing, wheels=wheels, drawn=drawn)
        assert drive.latency_s == pytest.approx(TOLD_LATENCY_S, abs=0.02)
        assert drive.actuator_lag_s == pytest.approx(TOLD_LAG_S, rel=0.3)


def identifier(latency_s=TOLD_LATENCY_S):
    return control.DriveIdentifier(control.DriveModelConfig(latency_s=latency_s), control.LimitsConfig())


def test_a_robot_that_does_not_change_its_speed_learns_nothing():
    drive = identifier()
    before = drive.estimate
    for k in range(300):
        drive.observe(k * 33_333, 1.0, 0.0)
        drive.command(core.Twist(linear_mps=0.0), k * 33_333)
    assert drive.estimate.latency_s == before.latency_s
    assert drive.estimate.latency_sigma_s == pytest.approx(before.latency_sigma_s, rel=0.05)


def test_it_is_less_sure_the_less_it_has_seen():
    sigmas_s = [drive_after(run_s, latency_s=0.14).latency_sigma_s for run_s in (0.5, 2.0, 10.0)]
    assert all(later < earlier for earlier, later in itertools.pairwise(sigmas_s))


def test_what_cannot_be_used_changes_nothing():
    drive = identifier()
    for distance_m, bearing_rad in ((np.nan, 0.0), (1.0, np.inf)):
        drive.observe(1_000_000, distance_m, bearing_rad)
    drive.command(core.Twist(linear_mps=np.nan), 1_000_000)
    drive.observe(1_000_000, 1.0, 0.0)
    drive.observe(500_000, 1.0, 0.0)  # earlier than the last
    assert drive.estimate.latency_s == TOLD_LATENCY_S


def test_a_gap_of_an_hour_takes_no_longer_than_one_of_a_second():
    drive = identifier()
    for k in range(200):
        drive.observe(k * 3_600_000_000, 1.0, 0.0)
        drive.command(core.Twist(linear_mps=0.3), k * 3_600_000_000)
    assert not drive.estimate.differs_from_settings

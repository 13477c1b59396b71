"""The figures of a run, on series whose figures can be computed by hand."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic_run import exponential_run, synthetic_run

from pilotfish.metrics import evaluate, overshoot_m, settling_time_s, steady_state_error_m, steady_window


def test_the_steady_window_is_the_last_quarter_of_the_run():
    # 0 .. 8 s: the last quarter starts at 6 s, which belongs to it; a run that starts later has the same
    # window.
    time_s = np.arange(9.0)
    np.testing.assert_array_equal(steady_window(time_s), time_s >= 6.0)
    np.testing.assert_array_equal(steady_window(time_s + 100.0), time_s >= 6.0)


def test_the_steady_state_error_is_the_mean_of_the_steady_window_and_of_nothing_before():
    # Samples at 6, 7, 8 s: (-0.11 - 0.10 - 0.06) / 3 = -0.09.
    error_m = np.array([9.0, 9.0, 9.0, 9.0, 9.0, 9.0, -0.11, -0.10, -0.06])
    assert steady_state_error_m(np.arange(9.0), error_m) == pytest.approx(-0.09, abs=1e-12)


def test_the_rms_counts_the_steady_state_error():
    # Steady window: 0.03 and 0.05 alternate, so the mean is 0.04 and the RMS sqrt((9 + 25) / 2) / 100 =
    # 0.041231.
    time_s = np.arange(8.0)
    metrics = evaluate(synthetic_run(time_s, [1, 1, 1, 1, 1, 1, 0.03, 0.05]))
    assert metrics.steady_state_error_m == pytest.approx(0.04, abs=1e-12)
    assert metrics.rms_error_m == pytest.approx(np.sqrt(17.0) / 100.0, abs=1e-12)


def test_the_settling_time_of_an_exponential_is_its_time_constant_times_a_logarithm():
    # |e - standing| = 1.3 exp(-t / 1.5) <= 0.05 from t = 1.5 ln 26 = 4.887 s on; the next sample at 30 Hz is
    # 4.9 s.
    run = exponential_run()
    assert settling_time_s(run.time_s, run.distance_error_m) == pytest.approx(4.9, abs=1e-9)


def test_leaving_the_band_again_starts_the_settling_anew():
    time_s = np.arange(12.0)
    error_m = np.array([1, 0, 0, 0.051, 0, 0.05, 0, 0, 0, 0, 0, 0])
    assert settling_time_s(time_s, error_m) == 4.0  # 0.051 at 3 s is outside, 0.05 at 5 s is inside


def test_a_run_that_is_inside_the_band_from_the_start_settles_at_once():
    assert settling_time_s(np.arange(8.0) + 5.0, np.zeros(8)) == 0.0


def test_a_run_that_leaves_the_band_in_the_steady_window_has_not_settled():
    # Mean of the window (6, 7, 8 s) is 0; 0.06 at 7 s is outside the band.
    error_m = np.array([0, 0, 0, 0, 0, 0, -0.03, 0.06, -0.03])
    assert settling_time_s(np.arange(9.0), error_m) is None


def test_passing_through_the_band_is_not_settling():
    # Closing in at 0.1 m/s: the last 0.6 s of 1 s are inside a band of 50 mm around their own mean, in
    # passing.
    time_s = np.arange(31) / 30.0
    assert settling_time_s(time_s, -1.0 + 0.1 * time_s) is None
    # Two seconds inside are enough: 0.01 m/s stays within 10 mm of the mean.
    time_s = np.arange(61) / 30.0
    assert settling_time_s(time_s, -1.0 + 0.01 * time_s) == 0.0


def test_overshoot_is_how_far_inside_the_desired_distance_the_robot_came():
    assert overshoot_m(np.array([-1.0, -0.2, 0.02, 0.013, -0.1])) == 0.02
    assert overshoot_m(np.array([-1.0, -0.2])) == 0.0


def test_initial_and_final_error_are_setpoint_minus_distance():
    # d_p = 1 m: 2.4 m away is e = -1.4 m; e(20 s) = -0.1 - 1.3 exp(-20 / 1.5).
    metrics = evaluate(exponential_run())
    assert metrics.initial_distance_m == pytest.approx(2.4)
    assert metrics.initial_error_m == pytest.approx(-1.4)
    assert metrics.final_error_m == pytest.approx(-0.1 - 1.3 * np.exp(-20 / 1.5), abs=1e-12)
    assert metrics.final_distance_m == pytest.approx(1.0 - metrics.final_error_m)


def test_the_bearing_error_is_taken_the_short_way_round():
    # theta = pi - 0.02 with theta_pd = -pi + 0.01 is -0.03 rad away, not 2 pi - 0.03.
    run = synthetic_run(np.arange(8.0), np.zeros(8))
    run = replace(run, true_bearing_rad=np.full(8, np.pi - 0.02)).with_meta(bearing_setpoint_rad=-np.pi + 0.01)
    metrics = evaluate(run)
    assert metrics.mean_bearing_error_deg == pytest.approx(np.degrees(-0.03), abs=1e-9)
    assert metrics.rms_bearing_error_deg == pytest.approx(np.degrees(0.03), abs=1e-9)


def test_a_bearing_error_that_swings_has_no_mean_but_an_rms():
    # +-2 degrees in turn, four samples in the window: mean 0, RMS 2.
    bearing_error_rad = np.radians(2.0) * (-1.0) ** np.arange(13)
    metrics = evaluate(synthetic_run(np.arange(13.0), np.zeros(13), bearing_error_rad))
    assert metrics.mean_bearing_error_deg == pytest.approx(0.0, abs=1e-9)
    assert metrics.rms_bearing_error_deg == pytest.approx(2.0, abs=1e-9)


def test_frames_detected_counts_tracking_among_the_frames_that_were_delivered():
    # Of 8 frames 6 were delivered, 3 of these tracked: 1/2. A dropped frame cannot be held against the
    # detector.
    status = ["searching", "tracking", "tracking", "coasting", "coasting", "tracking", "lost", "coasting"]
    delivered = [True, True, True, False, False, True, True, True]
    metrics = evaluate(synthetic_run(np.arange(8.0), np.zeros(8), status=status, delivered=delivered))
    assert metrics.frames_detected_ratio == 0.5


def test_a_run_without_a_setpoint_is_refused():
    run = exponential_run().with_meta(distance_setpoint_m=float("nan"))
    with pytest.raises(ValueError, match="does not say its setpoint"):
        evaluate(run)


@settings(derandomize=True, max_examples=50, deadline=None)
@given(st.lists(st.floats(-3, 3), min_size=25, max_size=60), st.floats(-1, 1))
def test_shifting_the_error_shifts_the_steady_state_error_and_leaves_the_settling_time(error, shift):
    time_s = np.arange(len(error)) / 3.0
    # On a grid of 1/1024 m both series are exact, so no sample can change sides of the band by rounding.
    error_m = np.round(np.array(error) * 1024) / 1024
    shift = round(shift * 1024) / 1024
    standing = steady_state_error_m(time_s, error_m)
    assert steady_state_error_m(time_s, error_m + shift) == pytest.approx(standing + shift, abs=1e-12)
    near_the_edge = np.abs(np.abs(error_m - standing) - 0.05) < 1e-12
    if not near_the_edge.any():
        assert settling_time_s(time_s, error_m + shift) == settling_time_s(time_s, error_m)


@settings(derandomize=True, max_examples=50, deadline=None)
@given(st.lists(st.floats(-3, 3), min_size=25, max_size=60))
def test_after_the_settling_time_the_error_never_leaves_the_band(error):
    time_s, error_m = np.arange(len(error)) / 3.0, np.array(error)  # 8 s and more: the last quarter is 2 s
    settled_s = settling_time_s(time_s, error_m)
    inside = np.abs(error_m - steady_state_error_m(time_s, error_m)) <= 0.05
    if settled_s is None:
        assert not inside[steady_window(time_s)].all()
    else:
        assert inside[time_s >= settled_s].all()
        assert settled_s == 0.0 or not inside[time_s < settled_s][-1]

"""Drives are found from what was commanded and seen; simulator and dense matrices are the oracles."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import yaml
from simulated_drives import simulated

from pilotfish import sim
from pilotfish.core import Twist
from pilotfish.errors import RecordingError
from pilotfish.identify import Evidence, as_yaml, evidence_from_recording, fit_drive, verdicts_of
from pilotfish.identify.evidence import _together
from pilotfish.identify.leader_track import Noise, bands, differences_of
from pilotfish.identify.own_path import own_poses, set_values


@pytest.fixture(scope="module")
def known():
    """A leader that stops dead after 10 s of 0.2 m/s, and a drive that its coordinator knows nothing of."""
    return simulated("stop_dead", 3, 14.0, latency_s=0.12, lag_s=0.2, linear_gain=1.02)


@pytest.fixture(scope="module")
def fit(known):
    return fit_drive(evidence_from_recording(known))


def evidence(time_s, linear, angular) -> Evidence:
    ones = np.ones(len(time_s))
    return Evidence(time_s, ones, 0 * ones, 1e-4 * ones, 1e-5 * ones, time_s, linear, angular)


@pytest.mark.parametrize("bit", [40, 50, 61])
def test_a_stamp_with_a_changed_bit_does_not_belong_to_the_run(bit):
    """2^40 us are 12 days, and 2^50 us 36 years: a grid over them would need terabytes."""
    utime_us = 1_764_000_000_000_000 + 33_333 * np.arange(300)
    utime_us[[0, 100, 299]] ^= 1 << bit
    belongs = _together(utime_us)
    assert np.flatnonzero(~belongs).tolist() == [0, 100, 299]
    assert _together(utime_us[:0]).tolist() == []


def test_a_pause_of_half_an_hour_belongs_to_the_run():
    assert _together(np.array([0, 33_333, 1800_000_000, 1800_033_333])).all()


def test_the_own_path_is_that_of_the_simulators_robot():
    """The simulator integrates in steps of 1 ms with a closed form of its own. 0.6 m of way at 2 ms a step: the
    trapezium's error is below a h^2 / 12 a step, 1e-6 m in all; the interpolation's likewise."""
    random = np.random.default_rng(1)
    time_s = np.arange(60) / 30.0
    linear, angular = np.cumsum(random.uniform(-0.05, 0.06, (2, 60)), axis=1)
    linear[0] = angular[0] = 0.0
    drive = sim.DriveConfig(
        max_linear_mps=20, max_angular_radps=50, actuator_lag_s=0.15, linear_gain=1.03, angular_gain=0.97
    )
    robot = sim.Unicycle(drive)
    truth = []
    for speed, turn in zip(linear, angular, strict=True):
        truth.append((robot.state.pose.x_m, robot.state.pose.y_m, robot.state.pose.heading_rad))
        robot.advance(Twist(linear_mps=speed, angular_radps=turn), 1 / 30)
    values = set_values(evidence(time_s, linear, angular), 1.0, 10.0)
    latency_s = 0.08  # seen so much later, it has driven the same way
    x, y, heading, _ = own_poses(values, time_s + latency_s, latency_s, 0.15, 1.03, 0.97)
    np.testing.assert_allclose(np.column_stack([x, y, heading]), truth, atol=2e-5)


def test_a_leader_with_constant_acceleration_leaves_no_third_difference():
    """Also where pictures come unevenly; a cubic t^3 leaves its third derivative, 6."""
    time_s = np.cumsum(np.random.default_rng(2).uniform(0.02, 0.04, 50))
    rows = differences_of(time_s)
    smooth = np.column_stack([1 + 2 * time_s + 3 * time_s**2, time_s**3])
    np.testing.assert_allclose(rows.of(smooth), np.tile([0.0, 6.0], (len(rows.first), 1)), atol=1e-7)


def test_the_covariance_is_that_of_dense_matrices():
    """Camera: D diag(s^2) D^T; straying: D G G^T D^T with G summing up the steps. A gap couples nothing."""
    time_s = np.delete(np.cumsum(np.random.default_rng(3).uniform(0.03, 0.035, 30)), [14, 15])
    rows, count = differences_of(time_s), 28
    assert len(rows.first) == 28 - 3 - 3  # three rows would reach over the gap
    dense = rows.of(np.eye(count))
    sigma, speed = np.linspace(1e-4, 3e-4, count), np.linspace(0.1, 0.5, count)
    steps = np.tril(np.ones((count, count)), -1) * np.sqrt(np.append(np.diff(time_s), 0.0) * (speed**2 + 1e-6))
    for noise, expected in (
        (Noise(1e-12, 2.0, 0.0, np.ones(len(rows.first))), dense @ np.diag(4 * sigma**2) @ dense.T),
        (Noise(1e-12, 0.0, 0.03, np.ones(len(rows.first))), 0.03**2 * dense @ steps @ steps.T @ dense.T),
    ):
        # a step belongs to the frame at its beginning
        out = bands(rows, sigma, np.append(speed[:1], speed[:-1]) if noise.straying else speed, noise)
        full = sum(np.diag(out[lag, : len(out[lag]) - lag], -lag) for lag in range(4))
        full = full + np.tril(full, -1).T
        np.testing.assert_allclose(full, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_a_known_drive_is_found_within_its_standard_deviations(fit):
    """Five of them: one false alarm in two million, were they Gaussian. And they say something: 5 ms, 5 %, 3 %."""
    for found, truth, useful in (
        (fit.latency_s, 0.12, 0.005),
        (fit.lag_s, 0.2, 0.01),
        (fit.linear_gain, 1.02, 0.03),
    ):
        assert found.observable
        assert found.sigma < useful
        assert abs(found.value - truth) < 5 * found.sigma
        assert abs(found.value - truth) < useful


def test_the_noise_is_that_which_was_drawn(fit):
    """As stated. The ratio's relative standard deviation is at least 1 / sqrt(2 x 420 frames) = 3 %; some of the rows
    inform about the leader instead."""
    assert fit.distance_noise_ratio == pytest.approx(1.0, abs=0.15)
    assert fit.bearing_noise_ratio == pytest.approx(1.0, abs=0.15)


def test_a_robot_that_never_changed_its_speed_is_told_to_do_so():
    """20 s of constant speed exactly, distance too: nothing of the drive is in it, and nothing is written."""
    time_s = np.arange(600) / 30.0
    random = np.random.default_rng(4)
    seen = evidence(time_s, np.full(600, 0.2), np.zeros(600))
    seen = dataclasses.replace(
        seen, distance_m=1 + 1e-4 * random.standard_normal(600), bearing_rad=1e-5 * random.standard_normal(600)
    )
    verdicts = verdicts_of(fit_drive(seen))
    assert [row.value for row in verdicts] == [None] * 4
    assert "never changed its speed; drive stop-and-go for 20 s" in verdicts[0].verdict
    assert yaml.safe_load(as_yaml(verdicts, "steady.lcmlog")) == {}


def test_the_fragment_says_the_keys_of_the_configuration(fit):
    verdicts = verdicts_of(fit, wheel_radius_m=0.05, track_width_m=0.3)
    keys = yaml.safe_load(as_yaml(verdicts, "run\n.lcmlog"))
    assert keys == {
        "control": {
            "drive": {
                "latency_s": round(fit.latency_s.value, 4),
                "actuator_lag_s": round(fit.lag_s.value, 4),
            }
        }
    }


def test_a_latency_that_cannot_be_configured_is_not_written(fit):
    """control.drive.latency_s ends at 0.25 s."""
    slow = dataclasses.replace(fit, latency_s=dataclasses.replace(fit.latency_s, value=0.3))
    row = verdicts_of(slow)[0]
    assert not row.recommended
    assert "0 to 0.25 s" in row.verdict
    assert "latency_s" not in yaml.safe_load(as_yaml(verdicts_of(slow), "x"))["control"]["drive"]


def test_a_run_that_is_too_short_says_how_many_frames_are_needed(known):
    short = dataclasses.replace(
        known, measured_distance_m=np.where(known.time_s < 1.0, known.measured_distance_m, np.nan)
    )
    with pytest.raises(RecordingError, match="30 frames of 'robot1', and 60 are needed"):
        evidence_from_recording(short)

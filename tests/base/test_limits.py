"""What the wheels are allowed, whoever asks."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twists import Twist

from pilotfish import base

WHEELS = base.DriveGeometry(wheel_radius_m=0.05, track_width_m=0.30)
LIMITS = base.WheelLimitsConfig(
    max_linear_mps=0.7,
    max_reverse_mps=0.2,
    max_linear_acceleration_mps2=1.0,
    brake_mps2=4.0,
    max_angular_radps=2.0,
    max_angular_acceleration_radps2=10.0,
    max_wheel_radps=1000.0,
)
any_number = st.floats(allow_nan=True, allow_infinity=True)
last_commands = st.tuples(st.floats(-0.2, 0.7), st.floats(-2.0, 2.0))


def limited(wanted, last=(0.0, 0.0), dt_s=0.1, limits=LIMITS):
    out = base.limit(limits, WHEELS, wanted=Twist(*wanted), last=Twist(*last), dt_s=dt_s)
    return out.linear_mps, out.angular_radps


@pytest.mark.parametrize(
    ("wanted", "last", "expected"),
    [
        ((0.5, 0.0), (0.0, 0.0), (0.1, 0.0)),  # 1 m/s2 for 0.1 s
        ((9.0, 9.0), (0.7, 2.0), (0.7, 2.0)),
        ((-9.0, -9.0), (-0.2, -2.0), (-0.2, -2.0)),
        ((0.3, 0.0), (0.6, 0.0), (0.3, 0.0)),  # braking: 4 m/s2 for 0.1 s are 0.4, more than needed
        ((0.1, 0.0), (0.7, 0.0), (0.3, 0.0)),
        ((-0.2, 0.0), (0.2, 0.0), (-0.05, 0.0)),  # to zero in 0.05 s, then 0.05 s of 1 m/s2
        ((-0.2, 0.0), (0.6, 0.0), (0.2, 0.0)),
        ((-0.2, 0.0), (0.1, 0.0), (-0.075, 0.0)),  # to zero in 0.025 s
        ((0.0, 1.0), (0.4, 0.0), (0.0, 1.0)),  # turning on: 4 m/s2 take the 0.4 away, 10 rad/s2 give the 1
        ((0.0, 0.0), (0.7, 2.0), (0.0, 0.0)),  # zero is never put off
    ],
)
def test_speeding_up_braking_and_reversing_by_hand(wanted, last, expected):
    assert limited(wanted, last) == pytest.approx(expected)


@given(any_number, any_number, last_commands, st.floats(0.0, 0.1))
def test_nothing_gets_past_the_limits(v, w, last, dt_s):
    linear, angular = limited((v, w), last, dt_s)
    assert -0.2 <= linear <= 0.7
    assert abs(angular) <= 2.0
    if linear != 0.0 or angular != 0.0:
        assert math.isfinite(v) and math.isfinite(w)
        assert abs(linear) <= abs(last[0]) + 1.0 * dt_s + 1e-12, "speeding up beyond the limit"
        assert abs(angular - last[1]) <= 10.0 * dt_s + 1e-12


@given(last_commands)
def test_a_zero_is_a_zero_at_once(last):
    assert limited((0.0, 0.0), last, dt_s=0.0) == (0.0, 0.0)


def test_while_time_goes_back_or_stands_still_nothing_changes_but_to_zero():
    for dt_s in (0.0, -1.0):
        assert limited((0.7, -2.0), last=(0.2, 0.5), dt_s=dt_s) == (0.2, 0.5)
        assert limited((0.1, 0.1), last=(0.2, 0.5), dt_s=dt_s) == (0.2, 0.5)
        assert limited((0.0, 0.0), last=(0.2, 0.5), dt_s=dt_s) == (0.0, 0.0)


@given(st.floats(-0.2, 0.7), st.floats(-2.0, 2.0))
def test_a_wheel_too_fast_slows_both_down_and_keeps_the_curvature(v, w):
    # The wheels' limit binds: 5 rad/s are 0.25 m/s.
    limits = base.WheelLimitsConfig(max_wheel_radps=5.0, max_linear_mps=0.7, max_angular_radps=2.0)
    linear, angular = limited((v, w), last=(v, w), limits=limits)
    left, right = base.wheel_speeds(WHEELS, Twist(linear, angular))
    assert max(abs(left), abs(right)) <= 5.0 + 1e-9
    assert linear * w == pytest.approx(angular * v, abs=1e-12)

"""Wheels and twist, encoders and pose: cases one can compute by hand, and properties."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twists import Twist

from pilotfish import base

# r = 0.05 m, b = 0.30 m, 1000 ticks a turn: a tick is 2 pi 0.05 / 1000 = 0.314 mm.
WHEELS = base.DriveGeometry(wheel_radius_m=0.05, track_width_m=0.30, ticks_per_revolution=1000)
METRES_PER_TICK = 2 * math.pi * 0.05 / 1000

speeds = st.floats(-2.0, 2.0)
geometries = st.builds(
    lambda r, b: base.DriveGeometry(wheel_radius_m=r, track_width_m=b, ticks_per_revolution=1000),
    st.floats(0.02, 0.3),
    st.floats(0.1, 1.0),
)


def odometry(max_wheel_radps=1000.0):
    return base.WheelOdometry(WHEELS, max_wheel_radps=max_wheel_radps)


@pytest.mark.parametrize(
    ("twist", "left", "right"),
    [
        ((0.0, 0.0), 0.0, 0.0),
        ((0.5, 0.0), 10.0, 10.0),  # 0.5 m/s on wheels of 0.05 m
        ((0.0, 1.0), -3.0, 3.0),  # 1 rad/s times 0.15 m, over 0.05 m: to the left, the right wheel goes forwards
        ((0.15, 1.0), 0.0, 6.0),  # about the left wheel
        ((-0.5, 0.0), -10.0, -10.0),
    ],
)
def test_stop_straight_spin_and_pivot_by_hand(twist, left, right):
    assert base.wheel_speeds(WHEELS, Twist(*twist)) == pytest.approx((left, right))


@given(geometries, speeds, speeds)
def test_the_wheels_of_a_twist_make_that_twist(geometry, v, w):
    left, right = base.wheel_speeds(geometry, Twist(v, w))
    back = base.twist_of(geometry, left_radps=left, right_radps=right)
    assert (back.linear_mps, back.angular_radps) == pytest.approx((v, w), abs=1e-12)


def test_odometry_goes_straight_and_turns_on_the_spot():
    wheels = odometry()
    assert wheels.update(time_ms=0, left_ticks=0, right_ticks=0) is None
    twist = wheels.update(time_ms=100, left_ticks=500, right_ticks=500)
    assert twist.linear_mps == pytest.approx(500 * METRES_PER_TICK / 0.1)
    assert wheels.pose == pytest.approx((500 * METRES_PER_TICK, 0.0, 0.0))
    # The wheels go 200 ticks apart each: 2 * 200 * 0.314 mm over 0.30 m.
    wheels.update(time_ms=200, left_ticks=300, right_ticks=700)
    assert wheels.pose == pytest.approx((500 * METRES_PER_TICK, 0.0, 400 * METRES_PER_TICK / 0.30))


def test_half_a_circle_ends_two_radii_to_the_left_in_one_step_as_in_many():
    """Radius R: the wheels roll pi (R -+ b/2). R = 0.6 m, in ticks rounded to whole ones: 0.3 mm at most."""
    for steps in (1, 7, 100):
        wheels = odometry(max_wheel_radps=1e4)
        for k in range(steps + 1):
            turned = math.pi * k / steps
            left, right = (round(turned * (0.6 + side * 0.15) / METRES_PER_TICK) for side in (-1, 1))
            wheels.update(time_ms=10 * k, left_ticks=left, right_ticks=right)
        x, y, heading = wheels.pose
        assert (x, y) == pytest.approx((0.0, 1.2), abs=2e-3)
        assert abs(heading) == pytest.approx(math.pi, abs=3e-3)


@given(st.integers(-(2**31), 2**31 - 1), st.integers(-2000, 2000), st.integers(-2000, 2000), st.integers(1, 1000))
def test_counters_and_clock_may_wrap_around(start, left, right, passed_ms):
    def wrapped(ticks):
        return (ticks + 2**31) % 2**32 - 2**31

    plain, wrapping = odometry(1e5), odometry(1e5)
    plain.update(time_ms=0, left_ticks=0, right_ticks=0)
    plain.update(time_ms=passed_ms, left_ticks=left, right_ticks=right)
    clock = 2**32 - 1
    wrapping.update(time_ms=clock, left_ticks=start, right_ticks=start)
    wrapping.update(
        time_ms=(clock + passed_ms) % 2**32, left_ticks=wrapped(start + left), right_ticks=wrapped(start + right)
    )
    assert wrapping.pose == plain.pose
    assert wrapping.jumps == 0


def test_a_controller_that_begins_anew_is_no_motion():
    """40 rad/s for 20 ms are 127 ticks; twice that and 4 more is the most that is accepted."""
    wheels = odometry(max_wheel_radps=40.0)
    wheels.update(time_ms=1000, left_ticks=100_000, right_ticks=100_000)
    assert wheels.update(time_ms=1020, left_ticks=0, right_ticks=0) is None
    assert wheels.pose == (0.0, 0.0, 0.0)
    assert wheels.jumps == 1
    assert wheels.update(time_ms=1040, left_ticks=100, right_ticks=100) is not None
    assert wheels.pose[0] == pytest.approx(100 * METRES_PER_TICK)


def test_readings_of_one_instant_and_after_a_long_silence_say_nothing():
    wheels = odometry()
    wheels.update(time_ms=5, left_ticks=0, right_ticks=0)
    assert wheels.update(time_ms=5, left_ticks=50, right_ticks=50) is None
    assert wheels.update(time_ms=1200, left_ticks=50, right_ticks=50) is None
    assert wheels.pose == (0.0, 0.0, 0.0)


# 40 rad/s for 20 ms are 0.8 rad of 6.2832, so 127.32 of 1000 ticks; twice that and 4 more are 258.65.
@pytest.mark.parametrize(("left", "right"), [(258, 0), (0, 258), (-258, 0), (0, -258)])
def test_each_wheel_may_turn_twice_as_fast_as_it_can_and_four_ticks_more(left, right):
    wheels = odometry(max_wheel_radps=40.0)
    wheels.update(time_ms=0, left_ticks=0, right_ticks=0)
    assert wheels.update(time_ms=20, left_ticks=left, right_ticks=right) is not None
    beyond = odometry(max_wheel_radps=40.0)
    beyond.update(time_ms=0, left_ticks=0, right_ticks=0)
    one_more = [ticks + (ticks > 0) - (ticks < 0) for ticks in (left, right)]
    assert beyond.update(time_ms=20, left_ticks=one_more[0], right_ticks=one_more[1]) is None
    assert (wheels.jumps, beyond.jumps) == (0, 1)


def test_two_readings_of_one_instant_lose_no_tick_and_are_no_jump():
    wheels = odometry()
    wheels.update(time_ms=5, left_ticks=0, right_ticks=0)
    assert wheels.update(time_ms=5, left_ticks=50, right_ticks=50) is None
    assert wheels.update(time_ms=105, left_ticks=60, right_ticks=60) is not None
    assert wheels.pose[0] == pytest.approx(60 * METRES_PER_TICK)
    assert wheels.jumps == 0


@pytest.mark.parametrize(("gap_ms", "moves"), [(1000, True), (1001, False)])
def test_readings_more_than_a_second_apart_are_no_motion(gap_ms, moves):
    wheels = odometry()
    wheels.update(time_ms=0, left_ticks=0, right_ticks=0)
    assert (wheels.update(time_ms=gap_ms, left_ticks=50, right_ticks=50) is not None) == moves
    assert wheels.jumps == (not moves)

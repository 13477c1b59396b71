"""The distance that no law goes below: a leader that stops dead, or drives towards the robot."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from pilotfish import ConfigError, control, core, fuzzy, sim
from pilotfish import data as shipped
from pilotfish.harness.driving import BASELINES
from pilotfish.harness.timed import Timing, run_timed

GUARD, LIMITS = control.GuardConfig(), control.LimitsConfig()
HOLD_S, LAG_S = 0.1, 0.1
REACTION = control.Reaction(limits=LIMITS, hold_s=HOLD_S, actuator_lag_s=LAG_S)
A_MPS2 = LIMITS.max_linear_acceleration_mps2
LAWS = ("anticipate", "paper", *BASELINES)


@settings(derandomize=True)
@given(st.floats(0.7, 4.0), st.floats(0.0, 0.05), st.floats(-0.5, 0.5), st.floats(0.0, 0.6))
def test_from_the_guarded_speed_the_gap_stops_shrinking_at_d_min(distance_m, sigma_m, leaving_mps, own_mps):
    """With c the speed at which the leader comes, the set value stays at v for the hold and then falls to -c; the
    wheels' lag adds tau (v_0 + c), and a set value s that has to come down to v first (s - v)^2 / 2a. The gap shrinks
    by (v + c) H + (v + c)^2 / 2a + (s - v)^2 / 2a + tau (v_0 + c), which is the room there is."""
    gap = control.Gap(distance_m=distance_m, distance_sigma_m=sigma_m, own_mps=own_mps, leaving_mps=leaving_mps)
    closing_mps = max(-leaving_mps, 0.0)
    shrinks_mps = control.guarded_speed(GUARD, REACTION, gap) + closing_mps
    room_m = distance_m - GUARD.safety_sigmas * sigma_m - GUARD.minimum_distance_m - LAG_S * (own_mps + closing_mps)
    falls_mps = max(closing_mps - shrinks_mps, 0.0)  # the set value was 0
    if room_m > 0 and falls_mps < A_MPS2 * HOLD_S - 1e-9:
        needed_m = shrinks_mps * HOLD_S + shrinks_mps**2 / (2 * A_MPS2) + falls_mps**2 / (2 * A_MPS2)
        assert needed_m == pytest.approx(room_m, abs=1e-12)
    elif room_m > 0:  # nothing fits: it brakes as hard as it can
        assert shrinks_mps == pytest.approx(0.0, abs=1e-12)
    else:
        assert shrinks_mps == pytest.approx(room_m / 0.5, abs=1e-12)


def fastest_by_linear_programming(gap, steps_s=0.002, horizon_s=1.5):
    """The largest set value that can be held for HOLD_S and after which some braking keeps d_min: a linear program over
    the set values s_k and the wheels' speeds w_k of a sampled drive, solved by HiGHS. Shares nothing with the guard.

        w_k+1 = w_k + (1 - exp(-dt / tau)) (s_k - w_k),   |s_k+1 - s_k| <= a dt,   sum of w dt <= distance - d_min
    """
    n, held = round(horizon_s / steps_s), round(HOLD_S / steps_s)
    blend = 1 - np.exp(-steps_s / LAG_S)
    # variables: v, s_0..s_n-1, w_0..w_n
    size = 1 + n + n + 1
    equal, values, below, bounds_above = [], [], [], []

    def row(**entries):
        line = np.zeros(size)
        for key, value in entries.items():
            line[int(key[1:])] = value
        return line

    for k in range(held):  # the set value comes down to v, or is there at once
        come_down = max(gap.set_mps - A_MPS2 * steps_s * k, 0.0)
        below.append(row(**{"i0": 1.0, f"i{1 + k}": -1.0}))
        bounds_above.append(0.0)
        below.append(row(**{f"i{1 + k}": -1.0}))
        bounds_above.append(-come_down)
    equal.append(row(**{f"i{1 + n}": 1.0}))
    values.append(gap.own_mps)
    for k in range(n):
        equal.append(row(**{f"i{1 + n + k + 1}": 1.0, f"i{1 + n + k}": blend - 1.0, f"i{1 + k}": -blend}))
        values.append(0.0)
    for k in range(held - 1, n - 1):
        below.append(row(**{f"i{1 + k}": 1.0, f"i{2 + k}": -1.0}))
        bounds_above.append(A_MPS2 * steps_s)
    whole = np.zeros(size)
    whole[1 + n + 1 :] = steps_s
    below.append(whole)
    bounds_above.append(gap.distance_m - GUARD.minimum_distance_m)
    objective = np.zeros(size)
    objective[0] = -1.0
    solved = linprog(
        objective, A_ub=np.array(below), b_ub=bounds_above, A_eq=np.array(equal), b_eq=values, bounds=(0, 3.0)
    )
    return solved.x[0] if solved.success else None


@pytest.mark.parametrize("distance_m", [0.6, 0.8, 1.2])
@pytest.mark.parametrize(("own_mps", "set_mps"), [(0.0, 0.0), (0.3, 0.0), (0.3, 0.3), (0.4, 0.5)])
def test_the_guard_allows_what_a_linear_program_finds_and_no_more(distance_m, own_mps, set_mps):
    # 2 ms steps: the sampled ramp covers half a step less or more, v dt / 2 < 1.5 mm of way; at 1 m/s^2 and with a
    # hold of 0.1 s that is less than 1.5 mm / (0.1 s + v / a) = 5 mm/s.
    gap = control.Gap(distance_m=distance_m, own_mps=own_mps, set_mps=set_mps)
    fastest = fastest_by_linear_programming(gap)
    allowed = control.guarded_speed(GUARD, REACTION, gap)
    if fastest is None:  # nothing helps any more: it brakes as hard as it can
        assert allowed == 0.0
    else:
        assert allowed == pytest.approx(fastest, abs=0.005)


@settings(derandomize=True, max_examples=50, deadline=None)
@given(
    st.floats(0.7, 2.0),
    st.floats(0.0, 0.6),
    st.floats(0.0, 0.6),
    st.sampled_from([1 / 30, 1 / 15, 0.1]),
    st.sampled_from([0.0, 1.0, 3.0]),
    st.floats(0.0, 1.5),
)
def test_driven_at_the_bound_the_worst_leader_is_never_nearer_than_d_min(
    distance_m, leader_mps, own_mps, period_s, braking_mps2, brakes_at_s
):
    """The robot takes all that the guard allows at each picture; the leader brakes at any time, at once or as hard as
    is said. Errors of the measurement of just safety_sigmas sigma, always to the bad side. Own integration in 1 ms
    steps."""
    guard = control.GuardConfig(leader_deceleration_mps2=braking_mps2)
    dt, sigma_m = 0.001, 0.002
    gap_m, command, set_value, wheels = distance_m, own_mps, own_mps, own_mps
    need_m = own_mps * (HOLD_S + LAG_S) + own_mps**2 / (2 * A_MPS2) + 2 * guard.safety_sigmas * sigma_m
    if distance_m - guard.minimum_distance_m < need_m + own_mps * period_s:
        return  # lost before it began
    speed, nearest, every = leader_mps, distance_m, round(period_s / dt)
    for k in range(4000):
        if k % every == 0:
            seen = control.Gap(
                distance_m=gap_m + guard.safety_sigmas * sigma_m,
                distance_sigma_m=sigma_m,
                own_mps=wheels,
                set_mps=set_value,
                leaving_mps=speed,
            )
            allowed = control.guarded_speed(guard, REACTION, seen)
            command = min(max(allowed, command - A_MPS2 * period_s, 0.0), command + A_MPS2 * period_s, 0.6)
        set_value += np.clip(command - set_value, -A_MPS2 * dt, A_MPS2 * dt)
        wheels += (set_value - wheels) * (1 - np.exp(-dt / LAG_S))
        if k * dt >= brakes_at_s:
            speed = max(speed - braking_mps2 * dt, 0.0) if braking_mps2 else 0.0
        gap_m += (speed - wheels) * dt
        nearest = min(nearest, gap_m)
    assert nearest > guard.minimum_distance_m - 0.0005  # the integration's own error: 0.6 m/s x 1 ms


@settings(derandomize=True)
@given(st.floats(0.0, 0.4), st.floats(-0.5, 0.5))
def test_below_d_min_it_recedes_and_faster_the_less_there_is(distance_m, leaving_mps):
    def bound(distance_m):
        return control.guarded_speed(GUARD, REACTION, control.Gap(distance_m=distance_m, leaving_mps=leaving_mps))

    assert bound(distance_m) <= min(0.0, leaving_mps)
    assert bound(distance_m) <= bound(distance_m + 0.01)


def test_the_guard_has_no_step_where_there_is_just_no_room():
    for leaving_mps in (-0.3, 0.0, 0.3):
        edge_m = GUARD.minimum_distance_m + LAG_S * max(-leaving_mps, 0.0)
        below, above = (
            control.guarded_speed(GUARD, REACTION, control.Gap(distance_m=edge_m + d, leaving_mps=leaving_mps))
            for d in (-1e-9, 1e-9)
        )
        assert below == pytest.approx(above, abs=1e-6)


def test_a_leader_that_brakes_less_hard_than_the_robot_is_refused():
    law = fuzzy.load_controller(str(shipped.path("fuzzy/coordination.yaml")))
    config = control.FollowerConfig(law=law, guard=control.GuardConfig(leader_deceleration_mps2=0.5))
    with pytest.raises(ConfigError, match=r"control.guard.leader_deceleration_mps2: 0.5 is below .*, 1; give at least"):
        control.Follower(config)


def reversing(speed_mps):
    def change(spec):
        robots = spec.robots
        for robot in robots:
            if robot.name == "leader":
                profile = robot.trajectory.profile
                profile.speed_mps = -speed_mps
                robot.trajectory = sim.Line(profile)
        spec.robots = robots

    return change


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("speed_mps", [0.1, 0.2, 0.29])
def test_no_law_is_hit_by_a_leader_that_reverses_slower_than_the_robot_can(law, speed_mps):
    # It comes from 2.4 m at once, while the robot drives towards it at 0.6 m/s to keep 0.5 m, and may reverse at 0.3.
    # Without the guard, at 0.29 m/s: paper 0.35, pbvs 0.33, pid 0.17 m; the two robots are 0.4 m long together.
    def near(config):
        config.setpoint = core.Setpoint(distance_m=0.5)

    run = run_timed("line", law=law, change=reversing(speed_mps), configure=near)
    assert run.distance_m.min() > GUARD.minimum_distance_m - 0.005


@pytest.mark.parametrize("law", LAWS)
def test_no_law_goes_below_d_min_behind_a_leader_that_stops_dead_before_a_late_camera(law):
    run = run_timed("stop_dead", law=law, timing=Timing(latency_s=0.1))
    assert run.distance_m.min() > GUARD.minimum_distance_m

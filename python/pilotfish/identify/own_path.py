"""The own path from the commands: delay, ramp of the driver's set value, first-order lag, gains.

The driver's set value r ramps to the command c with the greatest acceleration a, the wheels follow with a lag tau:

    dr/dt = +-a until r = c,    dv/dt = (r - v) / tau,    on the ground g v

A delay shifts all of it: with latency L the twist at t is that without latency at t - L. The ramp depends neither on
the latency nor on lag and gains, so it is made once; r is then piecewise linear, and between two points of a grid where
r goes in a straight line from r0 to r1 the lag has the closed form (with E = exp(-h / tau))

    v1 = E v0 + r1 - E r0 - (1 - E) tau (r1 - r0) / h,

a recursive filter of first order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from pilotfish.identify.evidence import Evidence, FloatArray

STEP_S = 0.002
_LEAD_S = 1.0  # the grid begins so long before the first exposure or command


@dataclass(frozen=True)
class SetValues:
    """Speed [m/s] and turn rate [rad/s] of the driver's ramp for a latency of zero, at the times of a grid (K,)."""

    time_s: FloatArray
    linear_mps: FloatArray
    angular_radps: FloatArray


def set_values(evidence: Evidence, max_mps2: float, max_radps2: float) -> SetValues:
    """What the wheels' driver makes of the commands."""
    at_s = evidence.command_time_s
    first_s, last_s = min(at_s[0], evidence.time_s[0]) - _LEAD_S, max(at_s[-1], evidence.time_s[-1]) + STEP_S
    grid_s = np.arange(first_s, last_s + STEP_S, STEP_S)
    return SetValues(
        grid_s,
        _ramped(at_s, evidence.linear_mps, max_mps2, grid_s),
        _ramped(at_s, evidence.angular_radps, max_radps2, grid_s),
    )


def _ramped(at_s: FloatArray, target: FloatArray, acceleration: float, grid_s: FloatArray) -> FloatArray:
    """The breakpoints of the ramp, then on the grid. A coordinator that starts is at rest, and its first command is no
    more than one period's acceleration; if the first one is more, the robot was driving, and has reached it."""
    period_s = float(np.median(np.diff(at_s))) if len(at_s) > 1 else 0.0
    value = 0.0 if abs(target[0]) <= 1.05 * acceleration * period_s else float(target[0])
    times, values = [grid_s[0]], [value]
    for start_s, end_s, wanted in zip(at_s, np.append(at_s[1:], np.inf), target, strict=True):
        times.append(start_s)
        values.append(value)
        needed_s = abs(wanted - value) / acceleration
        if needed_s <= end_s - start_s:
            value = float(wanted)
            if needed_s > 0:
                times.append(start_s + needed_s)
                values.append(value)
        else:
            value += float(np.copysign(acceleration * (end_s - start_s), wanted - value))
    return np.interp(grid_s, times, values)


def lagged(set_value: FloatArray, lag_s: float) -> FloatArray:
    """v behind r, on the same grid; in the steady state at its beginning."""
    if lag_s < 1e-4:
        return set_value
    keep = np.exp(-STEP_S / lag_s)
    share = (1.0 - keep) * lag_s / STEP_S
    # v1 = keep v0 + (1 - share) r1 + (share - keep) r0; in the steady state v0 = r0 the filter's memory is share r0.
    start = share * set_value[0]
    return lfilter([1.0 - share, share - keep], [1.0, -keep], set_value, zi=[start])[0]


def own_poses(
    values: SetValues, time_s: FloatArray, latency_s: float, lag_s: float, linear_gain: float, angular_gain: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """x, y [m], heading [rad] in the odometry frame and forward speed [m/s] at ``time_s``, each (N,)."""
    speed = linear_gain * lagged(values.linear_mps, lag_s)
    turn = angular_gain * lagged(values.angular_radps, lag_s)
    heading = _integral(turn)
    at_s = time_s - latency_s
    x = np.interp(at_s, values.time_s, _integral(speed * np.cos(heading)))
    y = np.interp(at_s, values.time_s, _integral(speed * np.sin(heading)))
    return x, y, np.interp(at_s, values.time_s, heading), np.interp(at_s, values.time_s, speed)


def _integral(rate: FloatArray) -> FloatArray:
    return np.concatenate([[0.0], np.cumsum(0.5 * STEP_S * (rate[1:] + rate[:-1]))])

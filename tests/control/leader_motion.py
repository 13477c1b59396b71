"""Leaders for the estimator's tests: what they really do, and what a camera at rest measures of it."""

import math

import numpy as np

from pilotfish import control, core

PERIOD_S = 1.0 / 30.0
DISTANCE_SIGMA_M, BEARING_SIGMA_RAD, HEADING_SIGMA_RAD = 3e-4, 1e-4, 8e-4


def utime(index):
    return 1_000_000 + round(index * PERIOD_S * 1e6)


def measurement(index, x, y, heading, noise, correlation=0.6):
    """A measurement from the origin. The errors of distance and heading are correlated, as those of a tag that hangs
    behind the leader's origin are; `noise` is three standard normal numbers."""
    d, theta = math.hypot(x, y), math.atan2(y, x)
    sigma = np.diag([DISTANCE_SIGMA_M, BEARING_SIGMA_RAD, HEADING_SIGMA_RAD])
    correlations = np.eye(3)
    correlations[0, 2] = correlations[2, 0] = correlation
    covariance = sigma @ correlations @ sigma
    error = np.linalg.cholesky(covariance) @ noise
    return core.Observation(
        utime=utime(index),
        distance_m=d + error[0],
        bearing_rad=theta + error[1],
        heading_rad=core.wrap_angle(heading + error[2]),
        covariance=covariance,
    )


def coordinated_turn(state, dt_s):
    """(x, y, vx, vy, heading, turn rate) after dt_s, along the arc: with a = w dt,

    p += R(a/2) v dt sin(a/2) / (a/2),  v -> R(a) v,  heading += a
    """
    x, y, vx, vy, heading, w = state
    a = w * dt_s
    chord = dt_s * np.sinc(a / 2 / np.pi)
    c, s = math.cos(a / 2), math.sin(a / 2)
    x, y = x + chord * (c * vx - s * vy), y + chord * (s * vx + c * vy)
    c, s = math.cos(a), math.sin(a)
    return np.array([x, y, c * vx - s * vy, s * vx + c * vy, heading + a, w])


def estimate_along(states, seed=1, config=None):
    """Feeds the estimator with the states, one a frame, seen from the origin; the estimates after each frame."""
    estimator = control.LeaderMotionEstimator(config or control.LeaderMotionConfig())
    random = np.random.default_rng(seed)
    estimates = []
    for index, (x, y, _, _, heading, _) in enumerate(states):
        estimator.update(measurement(index, x, y, heading, random.standard_normal(3)), (0.0, 0.0, 0.0))
        estimates.append(estimator.at(utime(index)))
    return estimates


def along_heading(estimate):
    """Speed of the leader along its own heading: negative if it reverses."""
    _, _, vx, vy, heading, _ = estimate.mean
    return vx * math.cos(heading) + vy * math.sin(heading)

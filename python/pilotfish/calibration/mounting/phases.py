"""Which pictures are of the turn on the spot, and which of the straight drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TURN_RADPS, STRAIGHT_MPS = 0.05, 0.02  # odometry: slower is standing still
STRAIGHT_RADPM = 0.3  # turn rate over speed of what still counts as straight: a radius of 3 m
ON_THE_SPOT_M = 0.01  # speed over turn rate of what still counts as on the spot
FIT_MM = 1.0
MIN_TAIL = 5


@dataclass(frozen=True)
class Phases:
    """``turning`` and ``straight`` (N,) bool of N pictures; those in neither are not used. ``forward``: False if the
    robot is known to have driven backwards."""

    turning: np.ndarray
    straight: np.ndarray
    forward: bool = True


@dataclass(frozen=True)
class Odometry:
    """What the robot's own odometry said: ``utime`` (K,) [us], ``x_m``, ``y_m``, ``heading_rad`` (K,), of the world it
    counts in."""

    utime: np.ndarray
    x_m: np.ndarray
    y_m: np.ndarray
    heading_rad: np.ndarray

    def at(self, utime: np.ndarray) -> np.ndarray:
        """(N, 3): x, y [m] and heading [rad] at those times, between messages in proportion."""
        rows = (self.x_m, self.y_m, np.unwrap(self.heading_rad))
        return np.stack([np.interp(utime, self.utime, row) for row in rows], axis=1)


def phases_by_odometry(odometry: Odometry, utime: np.ndarray, window_s: float = 0.3) -> Phases:
    """From the speeds that odometry gives around each picture's time ``utime`` (N,) [us]."""
    half = window_s / 2.0 * 1e6
    before, after = odometry.at(utime - half), odometry.at(utime + half)
    middle = (before[:, 2] + after[:, 2]) / 2.0
    step = (after - before) / window_s
    speed = step[:, 0] * np.cos(middle) + step[:, 1] * np.sin(middle)
    rate = step[:, 2]
    turning = (np.abs(rate) > TURN_RADPS) & (np.abs(speed) < ON_THE_SPOT_M * np.abs(rate) + 1e-3)
    straight = (np.abs(speed) > STRAIGHT_MPS) & (np.abs(rate) < STRAIGHT_RADPM * np.abs(speed))
    forward = bool(np.sum(speed[straight]) >= 0.0)
    straight &= (speed >= 0.0) == forward
    return Phases(turning, straight, forward)


def phases_by_motion(centres_c: np.ndarray) -> Phases | None:
    """A turn, then a straight drive, from the places (N, 3) [m] of one tag in the camera's frame; None if its end is no
    straight line.

    While the robot drives the tag moves along a nearly straight line, its third part of the way is enough to fit one;
    the drive begins where, going back from the end, the tag leaves that line.
    """
    count = len(centres_c)
    for share in (0.5, 0.35, 0.25):  # of the pictures, that are surely of the drive
        begin = int(count * (1.0 - share))
        off = _off_path(centres_c, np.arange(begin, count))
        if count - begin >= MIN_TAIL and _rms(off[begin:]) < 2.0 * FIT_MM * 1e-3:
            break
    else:
        return None
    while begin > 0 and off[begin - 1] <= max(4.0 * _rms(off[begin:]), FIT_MM * 1e-3):
        begin -= 1
        off = _off_path(centres_c, np.arange(begin, count))
    along = np.linalg.norm(centres_c - centres_c[-1], axis=1)
    numbers = np.arange(count)
    # One picture on either side of the change belongs to neither.
    straight = numbers >= begin + 1
    turning = numbers <= begin - 2
    if turning.sum() < MIN_TAIL or along[straight].max(initial=0.0) == 0.0:
        return None
    return Phases(turning, straight)


def _off_path(points: np.ndarray, of: np.ndarray) -> np.ndarray:
    """Distance (N,) of all points from the parabola through those at ``of``: no robot drives quite straight."""
    middle = points[of].mean(axis=0)
    axes = np.linalg.svd(points[of] - middle)[2]
    along, *aside = ((points - middle) @ axes.T).T
    fits = [np.polyval(np.polyfit(along[of], each[of], 2), along) for each in aside]
    return np.hypot(*(each - fit for each, fit in zip(aside, fits, strict=True)))


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))

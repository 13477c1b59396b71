"""Sequences for one question each: a lens that distorts, a tag far away, a tag seen head-on."""

from __future__ import annotations

import numpy as np

from bench.vision.scenes import VGA, Motion, Picture, Scene, camera_of
from pilotfish import core

DISTORTED = camera_of(640, 480, 600.0, k1=-0.25, k2=0.08)


def sequence(camera: core.CameraModel, motion: Motion, count: int, seed: int) -> list[Picture]:
    """Frames of one leader before one background."""
    rng = np.random.default_rng([seed, round(1000 * motion.distance_m), round(motion.max_yaw_deg)])
    poses = motion.poses(count, rng)
    return list(Scene(camera, int(rng.integers(1, 10_000))).pictures(poses))


def through_lens(count: int, seed: int) -> list[Picture]:
    """At 1.1 m, out to where the lens moves the tag by many pixels."""
    return sequence(DISTORTED, Motion(1.1, sideways_share=0.35), count, seed)


def far(count: int, seed: int) -> list[Picture]:
    """At 5 m the tag is 19 px wide: two poses explain it almost equally well."""
    return sequence(VGA, Motion(5.0, sweep_s=6.0), count, seed)


def head_on(count: int, seed: int) -> list[Picture]:
    """2 to 4 m, within 12 degrees of head-on: where the two poses are nearest to each other."""
    return sequence(VGA, Motion(3.0, max_yaw_deg=12.0, ahead_mps=0.35, ahead_share=0.33, sweep_s=4.0), count, seed)

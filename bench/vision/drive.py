"""A drive with motion blur, in which the leader is now and then hidden, in part or whole."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bench.vision.scenes import (
    FRAME_RATE_HZ,
    LEADER,
    REAL,
    TAG_SIZE_M,
    VGA,
    Motion,
    Picture,
    Scene,
    corners_px,
    utime_of,
)

EXPOSURES = 5  # instants that are averaged, over half a frame period around the frame's time
OCCLUDED_SHARE = 0.2  # of the frames
# From 0.8 to 3 m and back, past the camera as fast as if the camera turned too: up to 4 px of blur a frame.
MOTION = Motion(1.9, ahead_mps=0.35, ahead_share=0.58, sideways_mps=0.8, sweep_s=4.0)


def drive(count: int, seed: int) -> Iterator[Picture]:
    """`count` frames of 640x480."""
    rng = np.random.default_rng([seed, 41])
    path = MOTION.path(rng)
    sharp = Scene(VGA, int(rng.integers(1, 10_000)), noise_sigma=0.0)
    hidden = occlusions(count, rng)
    offsets = (np.arange(EXPOSURES) / (EXPOSURES - 1) - 0.5) * 0.5
    for index in range(count):
        cMt = path(index / FRAME_RATE_HZ)
        instants = index + offsets
        images = [sharp.image([(LEADER, path(k / FRAME_RATE_HZ))], k) for k in instants]
        gray = np.mean(images, axis=0)
        if hidden[index] > 0:
            cover(
                gray, corners_px(VGA, cMt, TAG_SIZE_M * 10 / 8), hidden[index], np.random.default_rng([seed, 42, index])
            )
        gray += rng.normal(0.0, REAL["noise_sigma"], gray.shape)
        yield Picture(np.clip(np.rint(gray), 0, 255).astype(np.uint8), cMt, utime_of(index))


def occlusions(count: int, rng: np.random.Generator) -> np.ndarray:
    """(count,): how much of the sheet is hidden in each frame, 0 to 1. Something passes for 1 to 8 frames at a time,
    and hides from a tenth of the sheet to all of it, until OCCLUDED_SHARE of the frames are used up."""
    hidden = np.zeros(count)
    while np.count_nonzero(hidden) < round(OCCLUDED_SHARE * count):
        first, length = int(rng.integers(0, count)), int(rng.integers(1, 9))
        left = round(OCCLUDED_SHARE * count) - np.count_nonzero(hidden)
        free = [k for k in range(first, min(first + length, count)) if hidden[k] == 0][:left]
        hidden[free] = rng.uniform(0.1, 1.0)
    return hidden


def cover(gray: np.ndarray, sheet_px: np.ndarray, share: float, rng: np.random.Generator) -> None:
    """Draws a plain or chequered patch over `share` of the sheet's bounding box, from one of its sides, in place."""
    first = np.maximum(np.floor(sheet_px.min(axis=0)).astype(int), 0)
    last = np.maximum(np.ceil(sheet_px.max(axis=0)).astype(int) + 1, 0)
    axis, reach = int(rng.integers(2)), (last - first) * share
    if rng.integers(2):
        last[axis] = first[axis] + round(reach[axis])
    else:
        first[axis] = last[axis] - round(reach[axis])
    part = gray[first[1] : last[1], first[0] : last[0]]
    part[:] = rng.uniform(20, 235)
    if rng.integers(2):
        rows, columns = np.indices(part.shape) // int(rng.integers(3, 12))
        part[(rows + columns) % 2 == 0] = rng.uniform(20, 235)

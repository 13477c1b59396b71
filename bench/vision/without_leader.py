"""Frames in which the leader is not, but everything that could be taken for it is.

Pieces are rendered once (tags with other ids and of other families, clutter), then recombined with crops, flips,
contrast, sheets of random bits and noise at the speed of NumPy. Every PERIOD frames the leader is really there for one
frame; in the next two another tag hangs where it was, or nothing, so that a tracker is lured as well as a detector.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from bench.vision.ours import Ours
from bench.vision.scenes import LEADER, TAG_ID, TAG_SIZE_M, VGA, Motion, Scene, utime_of
from pilotfish import core, vision

PERIOD = 20
FOREIGN_FAMILIES = ("tag36h10", "tag25h9", "tag16h5", "tagStandard41h12", "tagCircle21h7")
Variants = dict[str, np.ndarray]  # one scene four times: "leader", "other id", "other family", "empty"


@dataclass(frozen=True)
class Verdict:
    """How many of the frames that count were frames without a leader, and what was made of them."""

    frames: int  # without a leader
    wrong: int  # of these, with an observation
    shown: int  # frames with the leader, in between
    seen: int  # of these, with an observation


@dataclass(frozen=True)
class Pieces:
    """What frames are put together from."""

    scenes: list[Variants]
    crowds: list[np.ndarray]  # (H, W) uint8: several tags, none of them the leader's
    noise: np.ndarray  # (N, H, W) int16


def other_leader(rng: np.random.Generator, family: str) -> core.LeaderBody:
    """It wears any tag but the leader's."""
    tag_id = int(rng.integers(vision.TagFamily(family).size))
    if family == LEADER.family and tag_id == TAG_ID:
        tag_id += 1
    return core.LeaderBody([core.BodyTag(id=tag_id, size_m=TAG_SIZE_M)], family=family)


def prepared(scenes: int, seed: int) -> Pieces:
    """Renders the pieces; about 0.1 s a scene."""
    rng = np.random.default_rng([seed, 71])
    pieces = Pieces([], [], np.rint(rng.normal(0, 4, (4, VGA.height, VGA.width))).astype(np.int16))
    for k in range(scenes):
        renderer = Scene(VGA, int(rng.integers(1, 10_000)))
        pose = Motion(float(rng.uniform(0.6, 5.0))).poses(1, rng)[0]
        foreign = other_leader(rng, FOREIGN_FAMILIES[k % len(FOREIGN_FAMILIES)])
        worn = {"leader": LEADER, "other id": other_leader(rng, "tag36h11"), "other family": foreign}
        variants = {what: renderer.image([(leader, pose)], k) for what, leader in worn.items()}
        pieces.scenes.append(variants | {"empty": renderer.image([], k)})
        families = ["tag36h11", "tag36h11", *rng.choice(FOREIGN_FAMILIES, 2)]
        crowd = [(other_leader(rng, f), Motion(float(rng.uniform(0.5, 4.0))).poses(1, rng)[0]) for f in families]
        pieces.crowds.append(renderer.image(crowd, k))
    return pieces


def frames(count: int, pieces: Pieces, seed: int) -> Iterator[tuple[bool, np.ndarray]]:
    """`count` frames as (whether the leader is shown, image)."""
    rng = np.random.default_rng([seed, 72])
    for index in range(count):
        step = index % PERIOD
        if step == 0:
            scene = pieces.scenes[rng.integers(len(pieces.scenes))]
        if step < 3:  # the leader; then twice another at its place, or nothing
            what = "leader" if step == 0 else str(rng.choice(["other id", "other family", "empty"]))
            yield step == 0, scene[what]
        elif step < 6:  # what a printer could make of random bits
            yield False, with_false_tags(scene["empty"], rng)
        else:
            yield False, disturbed(mixed(pieces, rng), pieces.noise, rng)


def mixed(pieces: Pieces, rng: np.random.Generator) -> np.ndarray:
    """A crowd or an empty scene, flipped and shifted any way, with a part of another one pasted in; or nothing but
    noise."""
    kind = rng.integers(8)
    if kind == 0:
        return rng.integers(0, 256, (VGA.height, VGA.width), dtype=np.uint8)
    if kind == 1:
        return with_false_tags(pieces.crowds[rng.integers(len(pieces.crowds))], rng)
    image = np.roll(any_of(pieces, rng), (int(rng.integers(VGA.height)), int(rng.integers(VGA.width))), (0, 1))
    image = image[:: rng.choice([1, -1]), :: rng.choice([1, -1])].copy()
    height, width = int(rng.integers(40, 400)), int(rng.integers(40, 500))
    top, left = int(rng.integers(VGA.height - height)), int(rng.integers(VGA.width - width))
    image[top : top + height, left : left + width] = any_of(pieces, rng)[:height, -width:]
    return image


def any_of(pieces: Pieces, rng: np.random.Generator) -> np.ndarray:
    k = int(rng.integers(len(pieces.crowds)))
    return pieces.crowds[k] if rng.integers(3) else pieces.scenes[k]["empty"]


def with_false_tags(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Six sheets with a black border and 36 random bits: that they are the leader's 36 has a chance of 4 in 2^36."""
    image = image.copy()
    for _ in range(6):
        cells = np.zeros((10, 10), dtype=np.uint8)
        cells[[0, -1], :] = cells[:, [0, -1]] = 220
        cells[2:8, 2:8] = rng.integers(0, 2, (6, 6)) * 190 + 30
        side_px = int(rng.integers(2, 15))
        sheet = np.maximum(np.kron(cells, np.ones((side_px, side_px), dtype=np.uint8)), 30)
        top, left = int(rng.integers(VGA.height - len(sheet))), int(rng.integers(VGA.width - len(sheet)))
        image[top : top + len(sheet), left : left + len(sheet)] = sheet
    return image


def disturbed(image: np.ndarray, noise: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Another contrast and brightness, now and then the negative, and noise."""
    gain = rng.uniform(0.3, 1.3) * (-1 if rng.integers(10) == 0 else 1)
    gray = (image.astype(np.float32) - 128) * np.float32(gain) + np.float32(rng.uniform(90, 160))
    shaken = np.roll(noise[rng.integers(len(noise))], int(rng.integers(noise[0].size)))
    return np.clip(gray + shaken, 0, 255).astype(np.uint8)


def wrong_leaders(count: int, scenes: int, seed: int, on_frame: Callable[[], None]) -> Verdict:
    """Shows `count` frames to Pilotfish's tracker and counts what it takes for the leader."""
    tracker = Ours(VGA, LEADER, tracking=True)
    wrong = shown = seen = 0
    for index, (is_leader, image) in enumerate(frames(count, prepared(scenes, seed), seed)):
        found = tracker.track(image, utime_of(index)).cMt is not None
        shown += is_leader
        seen += is_leader and found
        wrong += found and not is_leader
        on_frame()
    return Verdict(frames=count - shown, wrong=wrong, shown=shown, seen=seen)

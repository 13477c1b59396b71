"""All trackers on the same frames in short bursts, each first in its turn: what disturbs the machine disturbs everyone.

A robot runs one tracker, which finds the caches as it left them. So a tracker looks at BURST frames before the
next one does; only the first frame of a burst finds the caches full of the others' data. Those frames have a figure of
their own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, zip_longest
from typing import Protocol

import numpy as np

from bench.vision.answers import Answer
from bench.vision.scenes import Picture
from bench.vision.summary import Figures, figures_of

BURST = 10  # frames


class Tracker(Protocol):
    """A tracker: Pilotfish's or a baseline."""

    name: str

    def track(self, image: np.ndarray, utime: int) -> Answer: ...


@dataclass(frozen=True)
class Contest:
    """Trackers, and what they are shown."""

    trackers: Sequence[Tracker]
    pictures: Iterable[Picture]


def compare(
    trackers: Sequence[Tracker], pictures: Iterable[Picture], on_frame: Callable[[], None] = lambda: None
) -> dict[str, Figures]:
    """Figures by the tracker's name, in the order given."""
    return compare_in_turns({"": Contest(trackers, pictures)}, on_frame)[""]


def compare_in_turns(
    contests: Mapping[str, Contest], on_frame: Callable[[], None] = lambda: None
) -> dict[str, dict[str, Figures]]:
    """Figures by contest and tracker. A burst of each contest in turn, so that figures compare."""
    answers: dict[str, dict[str, list[Answer]]] = {}
    truths: dict[str, list[np.ndarray]] = {name: [] for name in contests}
    for name, contest in contests.items():
        answers[name] = {tracker.name: [] for tracker in contest.trackers}
        assert len(answers[name]) == len(contest.trackers), "two trackers of one name"
    for index, bursts in enumerate(zip_longest(*[_bursts(contest.pictures) for contest in contests.values()])):
        for (name, contest), burst in zip(contests.items(), bursts, strict=True):
            first = index % len(contest.trackers)
            for tracker in [*contest.trackers[first:], *contest.trackers[:first]]:
                answers[name][tracker.name] += [tracker.track(picture.image, picture.utime) for picture in burst or []]
            for picture in burst or []:
                truths[name].append(picture.cMt)
                on_frame()
    return {
        name: {tracker: figures_of(given, truths[name], BURST) for tracker, given in by_tracker.items()}
        for name, by_tracker in answers.items()
    }


def _bursts(pictures: Iterable[Picture]) -> Iterator[list[Picture]]:
    remaining = iter(pictures)
    while burst := list(islice(remaining, BURST)):
        yield burst

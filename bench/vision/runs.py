"""All eyes on the same frames, in short bursts, each first in its turn: what disturbs the machine disturbs everyone.

A robot runs one eye, which finds the processor's caches as it left them. So an eye looks at BURST frames before the
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


class Eye(Protocol):
    """Somebody who looks for the leader."""

    name: str

    def look(self, image: np.ndarray, utime: int) -> Answer: ...


@dataclass(frozen=True)
class Contest:
    """Eyes, and what they are shown."""

    eyes: Sequence[Eye]
    pictures: Iterable[Picture]


def compare(
    eyes: Sequence[Eye], pictures: Iterable[Picture], on_frame: Callable[[], None] = lambda: None
) -> dict[str, Figures]:
    """Figures by the eye's name, in the order given."""
    return compare_in_turns({"": Contest(eyes, pictures)}, on_frame)[""]


def compare_in_turns(
    contests: Mapping[str, Contest], on_frame: Callable[[], None] = lambda: None
) -> dict[str, dict[str, Figures]]:
    """Figures by contest and eye. A burst of each contest in turn, so that their figures can be compared as well."""
    answers: dict[str, dict[str, list[Answer]]] = {}
    truths: dict[str, list[np.ndarray]] = {name: [] for name in contests}
    for name, contest in contests.items():
        answers[name] = {eye.name: [] for eye in contest.eyes}
        assert len(answers[name]) == len(contest.eyes), "two eyes of one name"
    for index, bursts in enumerate(zip_longest(*[_bursts(contest.pictures) for contest in contests.values()])):
        for (name, contest), burst in zip(contests.items(), bursts, strict=True):
            first = index % len(contest.eyes)
            for eye in [*contest.eyes[first:], *contest.eyes[:first]]:
                answers[name][eye.name] += [eye.look(picture.image, picture.utime) for picture in burst or []]
            for picture in burst or []:
                truths[name].append(picture.cMt)
                on_frame()
    return {
        name: {eye: figures_of(given, truths[name], BURST) for eye, given in by_eye.items()}
        for name, by_eye in answers.items()
    }


def _bursts(pictures: Iterable[Picture]) -> Iterator[list[Picture]]:
    remaining = iter(pictures)
    while burst := list(islice(remaining, BURST)):
        yield burst

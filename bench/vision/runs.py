"""All eyes on the same frames, in short bursts, each first in its turn: what disturbs the machine disturbs everyone.

A robot runs one eye, which finds the processor's caches as it left them. So an eye looks at BURST frames before the
next one does; only the first frame of a burst finds the caches full of the others' data. Those frames have a figure of
their own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
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


def compare(
    eyes: Sequence[Eye], pictures: Iterable[Picture], on_frame: Callable[[], None] = lambda: None
) -> dict[str, Figures]:
    """Figures by the eye's name, in the order given."""
    answers: dict[str, list[Answer]] = {eye.name: [] for eye in eyes}
    assert len(answers) == len(eyes), "two eyes of one name"
    truths = []
    for index, burst in enumerate(_bursts(pictures)):
        first = index % len(eyes)
        for eye in [*eyes[first:], *eyes[:first]]:
            answers[eye.name] += [eye.look(picture.image, picture.utime) for picture in burst]
        for picture in burst:
            truths.append(picture.cMt)
            on_frame()
    return {name: figures_of(given, truths, BURST) for name, given in answers.items()}


def _bursts(pictures: Iterable[Picture]) -> Iterator[list[Picture]]:
    remaining = iter(pictures)
    while burst := list(islice(remaining, BURST)):
        yield burst

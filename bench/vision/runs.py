"""All eyes on the same frames, frame by frame, each first in its turn: what disturbs the machine disturbs everyone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Protocol

import numpy as np

from bench.vision.answers import Answer
from bench.vision.scenes import Picture
from bench.vision.summary import Figures, figures_of


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
    for index, picture in enumerate(pictures):
        first = index % len(eyes)
        for eye in [*eyes[first:], *eyes[:first]]:
            answers[eye.name].append(eye.look(picture.image, picture.utime))
        truths.append(picture.cMt)
        on_frame()
    return {name: figures_of(given, truths) for name, given in answers.items()}

"""Changes of status that repeat over and over, as on a busy computer, told as one: else they bury the few events that
mean something."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from pilotfish.logs.run import RunEvent

BRIEF_S = 1.0  # a status other than tracking that lasts longer is an event of its own
_FEWEST = 6  # changes that are told as one
_NEVER = ("stopped",)  # somebody's wish


@dataclass(frozen=True)
class Repeats:
    """Successive changes of status, in the order of time."""

    events: tuple[RunEvent, ...]

    @property
    def counts(self) -> list[tuple[str, int]]:
        """How often each was entered; the most frequent first."""
        return Counter(event.text for event in self.events).most_common()


def with_repeats_joined(events: Sequence[RunEvent]) -> list[RunEvent | Repeats]:
    """The same events in the same order; brief changes of status that follow each other, with nothing else in between,
    are one item if they are _FEWEST or more."""
    joined: list[RunEvent | Repeats] = []
    together: list[RunEvent] = []
    for event, brief in zip(events, _is_brief(events), strict=True):
        if brief:
            together.append(event)
            continue
        joined += _joined(together)
        together = []
        joined.append(event)
    return joined + _joined(together)


def _joined(together: list[RunEvent]) -> list[RunEvent | Repeats]:
    return [Repeats(tuple(together))] if len(together) >= _FEWEST else list(together)


def _is_brief(events: Sequence[RunEvent]) -> list[bool]:
    """Of each: whether it is a status that a run under way enters and leaves again at once, or tracking."""
    brief, next_s = [], float("inf")
    for event in reversed(events):
        if event.kind != "status":
            brief.append(False)
            continue
        status = event.text.partition(":")[0]
        brief.append(status not in _NEVER and (status == "tracking" or next_s - event.t_s <= BRIEF_S))
        next_s = event.t_s
    return brief[::-1]

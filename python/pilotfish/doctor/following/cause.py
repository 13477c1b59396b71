"""A cause, and how numbers stand in its words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from pilotfish.doctor.following.evidence import Evidence

FOLLOWS_SHARE = 0.9  # of the deciding part in `tracking` or `coasting`, for "it follows"
MIN_FRAME_RATE_HZ = 12.0  # docs/operating-guide.md, "A slow camera"
MOVES_MPS = 0.03  # less than that is standing still


@dataclass(frozen=True)
class Cause:
    """``what`` is seen, with numbers; ``do`` mends it. ``name`` is for programs."""

    name: str
    what: str
    do: str

    def as_dict(self) -> dict[str, str]:
        """For JSON."""
        return asdict(self)


def held_share(seen: Evidence) -> float:
    """The share of the time in which its status lets it move."""
    return seen.status_shares.get("tracking", 0.0) + seen.status_shares.get("coasting", 0.0)


def risen_by(seen: Evidence, counter: str) -> int:
    """How much a counter of the coordinator rose while it was watched."""
    return seen.counters_risen.get(counter, 0)


def speed_text(seen: Evidence) -> str:
    """ "0.20 m/s": the median of what was commanded."""
    return f"{seen.commanded_mps.median:.2f} m/s" if seen.commanded_mps.count else "no speed"


def time_text(value_s: float) -> str:
    """ "120 ms", "3600 s" """
    return f"{1000 * value_s:.0f} ms" if value_s < 10 else f"{value_s:.0f} s"


def ids_text(ids: Sequence[int]) -> str:
    """ "0 to 2", "0, 1 and 7", "5": as one says them."""
    runs: list[list[int]] = []
    for number in sorted(ids):
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    parts = [f"{run[0]} to {run[-1]}" if len(run) > 2 else " and ".join(map(str, run)) for run in runs]
    return ", ".join(parts) if parts else "none"

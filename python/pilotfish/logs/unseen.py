"""A run in which the leader was never measured: that, and why, is all that can be said of errors and settling."""

from __future__ import annotations

from collections import Counter

from pilotfish.logs.run import RobotRun
from pilotfish.reason_words import reason_text

_SAID = 2  # reasons


def never_measured(run: RobotRun) -> str:
    """In a sentence, with what the statuses name as the cause; empty: it was measured."""
    frames = run.frames
    if frames["measured"].any():
        return ""
    shares = {len(frames): f"all {len(frames)} frames"}
    causes = [
        f"{reason_text(reason)} ({shares.get(count, f'{count} of {len(frames)} frames')})"
        for reason, count in _reasons(run)[:_SAID]
    ]
    return "the leader was never measured" + (f": {'; '.join(causes)}" if causes else "")


def _reasons(run: RobotRun) -> list[tuple[str, int]]:
    words = run.frames.words("reason").tolist()
    return [(reason, count) for reason, count in Counter(words).most_common() if reason not in ("", "none")]

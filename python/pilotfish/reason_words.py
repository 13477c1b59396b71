"""A reason in words, as the programs say it."""

from __future__ import annotations

from pilotfish.core import Reason


def reason_text(name: str) -> str:
    """Of a name of Reason; one that this version does not know keeps its name."""
    reason = Reason.__members__.get(name)
    return str(reason.text) if reason is not None and reason.text else name.replace("_", " ")

"""What a check found, in words that say what to do."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import Enum


class Verdict(str, Enum):
    """How a check ended."""

    ok = "ok"
    note = "note"  # nothing that must be mended, or nothing that could be looked at here
    wrong = "wrong"


@dataclass(frozen=True)
class Finding:
    """One line of the report. `advice` is empty where there is nothing to do."""

    check: str
    verdict: Verdict
    seen: str
    advice: str = ""

    def as_dict(self) -> dict[str, str]:
        """For JSON."""
        return {**asdict(self), "verdict": self.verdict.value}


def ok(check: str, seen: str) -> Finding:
    """A finding of what is as it must be."""
    return Finding(check, Verdict.ok, seen)


def note(check: str, seen: str, advice: str = "") -> Finding:
    """A finding of what does no harm, or cannot be determined here."""
    return Finding(check, Verdict.note, seen, advice)


def wrong(check: str, seen: str, advice: str) -> Finding:
    """A finding of what must be mended, and how."""
    return Finding(check, Verdict.wrong, seen, advice)

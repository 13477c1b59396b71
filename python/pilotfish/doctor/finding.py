"""What a check found, in words that say what to do."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import Enum


class Verdict(str, Enum):
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
        return {**asdict(self), "verdict": self.verdict.value}


def ok(check: str, seen: str) -> Finding:
    return Finding(check, Verdict.ok, seen)


def note(check: str, seen: str, advice: str = "") -> Finding:
    return Finding(check, Verdict.note, seen, advice)


def wrong(check: str, seen: str, advice: str) -> Finding:
    return Finding(check, Verdict.wrong, seen, advice)

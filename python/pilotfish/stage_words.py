"""What a stage of a status (stage_t) measures, in words. A stage that is not known here keeps its name."""

from __future__ import annotations

STAGE_WORDS = {
    "waited": "wait before vision",
    "looked": "vision and law",
    "answered": "arrival to command",
    "beats_late": "lateness of commands",  # of those between pictures, against when they were due
}


def stage_words(name: str) -> str:
    """Of a stage on the wire."""
    return STAGE_WORDS.get(name, name.replace("_", " "))

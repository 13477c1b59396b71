"""What a stage of a status (stage_t) measures, in words. A stage that is not known here keeps its name."""

from __future__ import annotations

STAGE_WORDS = {
    "waited": "from a picture's arrival until it is looked at",
    "looked": "vision and control law",
    "answered": "from a picture's arrival to its command",
    "beats_late": "commands between pictures: sent later than due",
}


def stage_words(name: str) -> str:
    """Of a stage on the wire."""
    return STAGE_WORDS.get(name, name.replace("_", " "))

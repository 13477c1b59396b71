"""A leader's file, with ids checked against the family."""

from __future__ import annotations

from pathlib import Path

from pilotfish.coordinator import load_leader_body
from pilotfish.core import LeaderBody
from pilotfish.errors import ConfigError
from pilotfish.vision import TagFamily


def load_leader(file: str | Path) -> LeaderBody:
    """What the coordinator reads of this file. ConfigError names file, key, value and what is allowed."""
    try:
        body = load_leader_body(str(file))
        family = TagFamily(body.family)
    except ValueError as error:
        raise _in_file(file, error) from error
    for k, tag in enumerate(body.tags):
        if tag.id >= family.size:
            error = ConfigError(f"leader.tags[{k}].id: {tag.id}; {body.family} has the ids 0 to {family.size - 1}")
            error.key = f"leader.tags[{k}].id"
            raise _in_file(file, error)
    return body


def _in_file(file: str | Path, error: ValueError) -> ConfigError:
    named = ConfigError(str(error) if str(file) in str(error) else f"{file}: {error}")
    named.key = getattr(error, "key", None)
    return named

"""Of which coordinator the diagnosis speaks, where another could be meant. Pure."""

from __future__ import annotations

from collections.abc import Collection

from pilotfish.doctor.following.cause import Cause
from pilotfish.doctor.following.setup import Setup

_LISTED = 8


def whom(robot: str, others: Collection[str], given: Setup | None) -> list[Cause]:
    """Notes: the other coordinators that were heard, and a ``given`` configuration (--config) that is of another robot;
    None where it was not given, or its coordinator runs here under the name ``robot``."""
    notes = []
    if given is not None and given.written_name.lower() != robot.lower():
        theirs = given.written_name
        notes.append(
            Cause(
                "config_of_another",
                f"this is about the coordinator of {robot}, and {given.file} is of {theirs}: its ids, "
                f"its camera and channel of pictures are compared with what {robot} says",
                f"--config with the configuration of {robot}, or --following {theirs}",
            )
        )
    if others:
        listed = sorted(others)
        more = f" and {len(listed) - _LISTED} more" if len(listed) > _LISTED else ""
        several = "are also those of " if len(listed) > 1 else "is also that of "
        notes.append(
            Cause(
                "other_coordinators",
                f"this is about the coordinator of {robot}; on this bus there {several}"
                f"{', '.join(listed[:_LISTED])}{more}",
                f"pilotfish doctor --following {listed[0]}, if that one is meant",
            )
        )
    return notes

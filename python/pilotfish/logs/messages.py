"""LCM events as messages: which type they are is said by their first eight bytes, not by their channel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pilotfish.black_box.log import Event
from pilotfish.lcmtypes.bot_core import image_t, pose_t
from pilotfish.lcmtypes.pilotfish import (
    base_t,
    box_start_t,
    command_t,
    motion_t,
    observation_t,
    sent_t,
    setpoint_t,
    status_t,
    step_t,
)

TYPES: dict[str, Any] = {
    "BOX": box_start_t,
    "STEP": step_t,
    "SENT": sent_t,
    "OBSERVATION": observation_t,
    "STATUS": status_t,
    "COMMAND": command_t,
    "SETPOINT": setpoint_t,
    "BASE": base_t,
    "POSE": pose_t,
    "MOTION": motion_t,
    "IMAGE": image_t,
}
FINGERPRINTS = {bytes(kind._get_packed_fingerprint()): suffix for suffix, kind in TYPES.items()}
_FINGERPRINT_BYTES = 8


@dataclass(frozen=True)
class Message:
    """One decoded event: whose it is, what it is ("OBSERVATION", ...; a name of TYPES), and the message."""

    event: Event
    robot: str  # of the channel, in small letters: ROBOT1_STATUS is robot1's
    kind: str
    content: Any


def kind_of(event: Event) -> str | None:
    """A name of TYPES; None if the event is none of our messages."""
    return FINGERPRINTS.get(event.data[:_FINGERPRINT_BYTES])


def robot_of(channel: str, kind: str) -> str:
    """ROBOT1_STATUS is robot1's. What does not end as our channels do is its own robot's."""
    return channel.removesuffix(f"_{kind}").lower()


def is_unreadable(event: Event) -> bool:
    """On one of our channels, but no message of its type: mostly another version of it."""
    suffix = event.channel.rpartition("_")[2]
    return suffix in TYPES and kind_of(event) != suffix


def decode(event: Event, kind: str) -> Message | None:
    """None if the bytes are damaged."""
    try:
        content = TYPES[kind].decode(event.data)
    except Exception:  # lcm-gen's decoders raise whatever the bytes lead to
        return None
    return Message(event, robot_of(event.channel, kind), kind, content)

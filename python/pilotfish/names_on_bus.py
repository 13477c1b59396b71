"""Names of robots, in channels that were heard: the rule of include/pilotfish/core/robot_name.hpp."""

from __future__ import annotations

import re

_ROBOT_CHANNEL = re.compile(r"([A-Z0-9_]{1,32})_([A-Z]+)", re.ASCII)


def split_channel(channel: str) -> tuple[str, str] | None:
    """Robot and kind of ROBOT1_STATUS: robot1, STATUS. None where no robot can be named so: anyone may send on any
    channel."""
    match = _ROBOT_CHANNEL.fullmatch(channel)
    return (match[1].lower(), match[2]) if match else None

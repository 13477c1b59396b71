"""How many connections this process's limit of open files (``ulimit -n``) leaves room for, beside what STOP needs."""

from __future__ import annotations

import resource
from dataclasses import dataclass
from pathlib import Path

from pilotfish.errors import SilentRobotError
from pilotfish.view.commands import MOST_REQUESTS

MOST_CONNECTIONS = 128  # 24 pages, and what their browsers open beside the WebSocket
_FEWEST_CONNECTIONS = 16
_OF_A_REQUEST = 6  # descriptors of an LCM connection: 4, and 2 more while it is opened (measured)
_BESIDES = 32  # the bus, the event loop, static files, a camera; connections that are accepted to be closed


@dataclass(frozen=True)
class Limits:
    """Connections that may be open at once: in all, and from one address."""

    total: int
    per_address: int


def limits() -> Limits:
    """For what is open now. SilentRobotError if ``ulimit -n`` leaves room for no page beside STOP."""
    allowed = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    reserve = sum(1 for _ in Path("/proc/self/fd").iterdir()) + _OF_A_REQUEST * MOST_REQUESTS + _BESIDES
    total = MOST_CONNECTIONS if allowed == resource.RLIM_INFINITY else min(MOST_CONNECTIONS, allowed - reserve)
    if total < _FEWEST_CONNECTIONS:
        needed = reserve + _FEWEST_CONNECTIONS
        raise SilentRobotError(f"only {allowed} open files are allowed here: ulimit -n {needed}, or more")
    return Limits(total, total // 2)

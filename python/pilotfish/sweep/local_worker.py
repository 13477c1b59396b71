"""What Dask loads first in each worker process of this machine."""

from __future__ import annotations

import signal


def dask_setup(_worker: object) -> None:
    """A terminal sends Ctrl-C to all processes of a command; the command acts on it, and ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

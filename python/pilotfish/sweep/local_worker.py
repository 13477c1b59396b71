"""What Dask loads first in each worker process of this machine."""

from __future__ import annotations

import signal


def dask_setup(_worker: object) -> None:
    """A terminal sends Ctrl-C, and SIGHUP when it is closed, to all processes of a command; the command acts on them,
    and ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)

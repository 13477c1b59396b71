"""Processes that end when the one that started them does, however that happens: SIGKILL leaves it no time to end them.

Linux sends PR_SET_PDEATHSIG's signal to a process when the *thread* that started it ends; start them from one that
stays as long as they are needed. See prctl(2).
"""

from __future__ import annotations

import ctypes
import functools
import os
import shutil
import signal
from collections.abc import Sequence

_PR_SET_PDEATHSIG = 1


def ending_with_parent(command: Sequence[str]) -> list[str]:
    """The command, through setpriv (of util-linux), which asks for SIGTERM at its parent's end and becomes the program:
    process number, arguments and streams stay. Where there is no setpriv: the command alone.

    Not a function that runs between fork and exec: other threads may hold locks there.
    """
    setpriv = _setpriv()
    return [setpriv, "--pdeathsig", "TERM", "--", *command] if setpriv else list(command)


@functools.cache
def _setpriv() -> str | None:
    return shutil.which("setpriv")


def end_with_parent(parent: int) -> None:
    """This process ends by SIGTERM when its parent does, whose number is given: it may be gone already. For workers
    that are Python's own; nothing where there is no prctl."""
    try:
        ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    except (OSError, AttributeError):
        return
    if os.getppid() != parent:
        os.kill(os.getpid(), signal.SIGTERM)

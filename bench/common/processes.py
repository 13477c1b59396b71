"""Processes beside what is measured, and who of them goes first."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress


@contextmanager
def process(target: Callable[..., None], *arguments: object) -> Iterator[multiprocessing.process.BaseProcess]:
    """As quickly begun as ended: a fork."""
    forked = multiprocessing.get_context("fork").Process(target=target, args=arguments, daemon=True)
    forked.start()
    try:
        yield forked
    finally:
        forked.kill()
        forked.join()


def work() -> None:
    """Nothing but work."""
    while True:
        pass


def real_time(priority: int) -> None:
    """What measures, and what sends as a robot's thread does, must not wait for a core; 0 ends it. Where it is not
    permitted, nothing changes."""
    policy = os.SCHED_FIFO if priority else os.SCHED_OTHER
    with suppress(PermissionError):
        os.sched_setscheduler(0, policy, os.sched_param(priority))

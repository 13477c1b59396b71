"""Programs that are an event loop, and what Ctrl-C, SIGTERM and SIGHUP do to them."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Awaitable, Callable

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def run_until_signal(main: Callable[[], Awaitable[None]], on_signal: Callable[[int], None]) -> None:
    """Runs ``main`` in a loop of its own; ``on_signal`` is called in it with the number of each signal, and is to end
    it. An exception would come out of whatever the loop is doing just then, which is a library's."""

    async def run() -> None:
        loop = asyncio.get_running_loop()
        for number in _ENDING:
            if signal.getsignal(number) is not signal.SIG_IGN:  # as under nohup
                loop.add_signal_handler(number, on_signal, number)
        await main()

    before = {number: signal.getsignal(number) for number in _ENDING}
    try:
        asyncio.run(run())
    finally:
        for number, handler in before.items():  # which the loop replaces by Python's own
            signal.signal(number, handler)

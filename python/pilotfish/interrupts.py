"""How Ctrl-C, SIGTERM and SIGHUP (a terminal that is closed, a connection that is lost) end a command: with one exit
code, no traceback, and what was begun cleaned up. Imports nothing large: it is there before everything else.

While a command works, the first one raises KeyboardInterrupt in the main thread. What comes within BOUNCE_S after it,
from a finger that bounces, or from a shell and a supervisor that both ask, is the same wish: it must not break into the
cleaning up. A later one raises again, for work that hangs, or that took the first one as "enough, go on with what there
is". Before and after the work there is nothing to clean up, and the process ends at once.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
import time

INTERRUPTED = 130  # 128 + SIGINT, as a shell says it
BOUNCE_S = 0.5
_RETRY_S = 0.02
_DEFAULTS = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL, signal.SIGHUP: signal.SIG_DFL}


class Interrupts:
    """The handlers of all three. ``working``: whether they are to raise, or to end the process at once."""

    def __init__(self) -> None:
        self.working = False
        self._number, self._last_s = 0, float("-inf")

    def install(self) -> None:
        """In place of Python's own handlers alone: a signal that is ignored, as under nohup, stays ignored."""
        for number, default in _DEFAULTS.items():
            if signal.getsignal(number) is default:
                signal.signal(number, self._handle)
                atexit.register(signal.signal, number, signal.SIG_IGN)  # the last of all: nothing is left to be ended
        self._otherwise = sys.unraisablehook
        sys.unraisablehook = self._raise_later
        signal.signal(signal.SIGALRM, self._handle_again)

    def exit_code(self, code: int = INTERRUPTED) -> int:
        """The command's code; if it says that it was interrupted, then by which signal."""
        # Else `python -m` ends itself by SIGINT if the exception has passed an exec() of a text, as when a dataclass is
        # made: it counts as unhandled until the next text is run.
        exec("")
        return 128 + self._number if code == INTERRUPTED and self._number else code

    def _handle(self, number: int, _frame: object) -> None:
        if not self.working:
            os._exit(128 + number)
        now_s = time.monotonic()
        if now_s - self._last_s > BOUNCE_S:
            self._number, self._last_s = number, now_s
            raise KeyboardInterrupt

    def _raise_later(self, unraisable: sys.UnraisableHookArgs) -> None:
        """A handler runs between any two instructions, also where Python can raise nothing, as in a destructor: there
        KeyboardInterrupt would be printed with its traceback, and lost."""
        if issubclass(unraisable.exc_type, KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, _RETRY_S)
        else:
            self._otherwise(unraisable)

    def _handle_again(self, _number: int, _frame: object) -> None:
        if self.working:
            raise KeyboardInterrupt


def is_of_interrupt(error: BaseException | None) -> bool:
    """Whether KeyboardInterrupt is what ``error`` comes from: a module of C++ that is being imported makes an
    ImportError of it."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            return True
        error = error.__cause__ or error.__context__
    return False

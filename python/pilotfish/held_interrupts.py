"""A stretch of work that Ctrl-C and SIGTERM must not break into, because half of it done is worse than none or all."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)  # SIGALRM: an interrupt raised later, see interrupts.py


class HeldInterrupts:
    """``with HeldInterrupts() as held:``: what a signal's handler raises meanwhile is raised on leaving.

    ``held.wanted`` says that something is to be raised: what may take long looks at it, and hurries.

    Python runs a handler between any two instructions. Where the standard library takes a lock in one and says in the
    next that it is to be given back, an interrupt leaves the lock taken for ever: subprocess.Popen.poll() is such a
    place (``_waitpid_lock``), and Popen.wait() without a time limit then waits for that lock without end.

    The handlers themselves are called at once, as ever: which signals are the same wish is for them to say. In another
    thread than the main one, where no handler runs, this does nothing. For short work, or work that looks at
    ``wanted``; nested ones hold until the outermost is left.
    """

    def __init__(self) -> None:
        self.wanted: BaseException | None = None
        self._holding = False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> HeldInterrupts:
        if threading.current_thread() is not threading.main_thread():
            return self
        self._holding = True
        try:
            for number in _SIGNALS:
                before = signal.getsignal(number)
                if callable(before):  # neither ignored nor the system's own, which ends the process
                    self._before[number] = before
                    signal.signal(number, self._hold(before))
        except BaseException:  # a signal whose handler was not replaced yet
            self._restore()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._restore()
        if self.wanted is not None:
            raise self.wanted

    def _hold(self, before: Callable[[int, FrameType | None], object]) -> Callable[[int, FrameType | None], None]:
        def handle(number: int, frame: FrameType | None) -> None:
            if not self._holding:  # left, and not yet put back
                before(number, frame)
                return
            try:
                before(number, frame)
            except KeyboardInterrupt as interrupt:
                self.wanted = interrupt

        return handle

    def _restore(self) -> None:
        self._holding = False
        for number, before in self._before.items():
            signal.signal(number, before)

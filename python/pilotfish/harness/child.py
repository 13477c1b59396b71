"""A child process that cannot be left behind, with its output in files (so that a full pipe can never block
it)."""

from __future__ import annotations

import subprocess
import time
import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType

from pilotfish.end_with_parent import ending_with_parent
from pilotfish.errors import HarnessError
from pilotfish.held_interrupts import HeldInterrupts

TERMINATE_WITHIN_S = 10.0
KILL_WITHIN_S = 10.0  # the system is to take away what was killed; a driver that hangs can keep it
_POLL_S = 0.02


class Child:
    """``with Child([...], folder, "robot1") as child:`` - on leaving, SIGTERM, and SIGKILL if that is not heeded, or if
    there is an interrupt meanwhile. One that is dropped without having been left is killed. It ends with this process,
    too, also if that is killed.

    No wait is without end, and an interrupt at any moment leaves nothing half done: ask ``poll`` and ``wait`` here, not
    those of ``process``.
    """

    def __init__(self, command: Sequence[str | Path], folder: Path, name: str) -> None:
        self.command = [str(word) for word in command]
        self.name = name
        self.stdout_file = folder / f"{name}.stdout"
        self.stderr_file = folder / f"{name}.stderr"
        words = ending_with_parent(self.command)
        with HeldInterrupts(), self.stdout_file.open("wb") as stdout, self.stderr_file.open("wb") as stderr:
            self.process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=stdout, stderr=stderr)
            # Also at the end of Python: an interrupt between here and a `with`, or within an ExitStack, drops it.
            weakref.finalize(self, _kill, self.process)

    def __enter__(self) -> Child:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.terminate()

    def poll(self) -> int | None:
        """Its exit code; None while it runs."""
        with HeldInterrupts():
            return self.process.poll()

    def wait(self, timeout_s: float) -> int | None:
        """Its exit code, once it has ended; None if it still runs after timeout_s."""
        _wait(self.poll, timeout_s)
        return self.process.returncode

    def terminate(self) -> int:
        """Ends the process if it still runs; its exit code. HarnessError if the system cannot end it."""
        with HeldInterrupts() as held:
            if self.process.poll() is None:
                self.process.terminate()
                _wait(lambda: self.process.poll() if held.wanted is None else -1, TERMINATE_WITHIN_S)
            _kill(self.process)
        if self.process.returncode is None:
            raise self.error(f"was killed, and still runs after {KILL_WITHIN_S:.0f} s")
        return self.process.returncode

    def wait_until(self, condition: Callable[[], bool], timeout_s: float, what: str) -> None:
        """Polls until the condition holds; HarnessError if the process ends before, or after timeout_s."""
        deadline = time.monotonic() + timeout_s
        while not condition():
            if (code := self.poll()) is not None:
                if condition():
                    return
                raise self.error(f"ended with {code} before {what}")
            if time.monotonic() > deadline:
                raise self.error(f"{what}: not within {timeout_s:.0f} s")
            time.sleep(_POLL_S)

    def stdout(self) -> str:
        """What it has written to its standard output so far."""
        return self.stdout_file.read_text(errors="replace")

    def stderr(self) -> str:
        """What it has written to its standard error so far."""
        return self.stderr_file.read_text(errors="replace")

    def error(self, problem: str) -> HarnessError:
        """The problem, with what one needs to look into it."""
        said = (self.stderr() or self.stdout()).strip().splitlines()[-15:]
        tail = "\n".join(f"  | {line}" for line in said) or "  | (it said nothing)"
        return HarnessError(f"{self.name}: {problem}\n  $ {' '.join(self.command)}\n{tail}")


def _kill(process: subprocess.Popen[bytes]) -> None:
    """At once; waits, but not for ever, until it is gone."""
    with HeldInterrupts():
        if process.poll() is None:
            process.kill()
            _wait(process.poll, KILL_WITHIN_S)


def _wait(poll: Callable[[], int | None], timeout_s: float) -> None:
    """Until poll() gives a code, or for timeout_s."""
    deadline = time.monotonic() + timeout_s
    delay_s = 0.001
    while poll() is None and time.monotonic() < deadline:
        time.sleep(delay_s)
        delay_s = min(2.0 * delay_s, _POLL_S)

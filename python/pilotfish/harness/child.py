"""A child process that cannot be left behind, with its output in files (so that a full pipe can never block
it)."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType

from pilotfish.end_with_parent import ending_with_parent
from pilotfish.errors import HarnessError

TERMINATE_WITHIN_S = 10.0
_POLL_S = 0.02


class Child:
    """``with Child([...], folder, "robot1") as child:`` - on leaving, SIGTERM, and SIGKILL if that is not
    heeded. It ends with this process, too, also if that is killed."""

    def __init__(self, command: Sequence[str | Path], folder: Path, name: str) -> None:
        self.command = [str(word) for word in command]
        self.name = name
        self.stdout_file = folder / f"{name}.stdout"
        self.stderr_file = folder / f"{name}.stderr"
        with self.stdout_file.open("wb") as stdout, self.stderr_file.open("wb") as stderr:
            words = ending_with_parent(self.command)
            self.process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=stdout, stderr=stderr)

    def __enter__(self) -> Child:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.terminate()

    def terminate(self) -> int:
        """Ends the process if it still runs; its exit code."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(TERMINATE_WITHIN_S)
            except subprocess.TimeoutExpired:
                self.process.kill()
        return self.process.wait()

    def wait_until(self, condition: Callable[[], bool], timeout_s: float, what: str) -> None:
        """Polls until the condition holds; HarnessError if the process ends before, or after timeout_s."""
        deadline = time.monotonic() + timeout_s
        while not condition():
            if self.process.poll() is not None:
                if condition():
                    return
                raise self.error(f"ended with {self.process.returncode} before {what}")
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

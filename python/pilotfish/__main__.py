"""The program ``pilotfish``, also as ``python -m pilotfish``. Imports nothing large before Ctrl-C ends it quietly."""

from __future__ import annotations

import os
import signal

INTERRUPTED = 130  # 128 + SIGINT, as a shell says it


def main() -> None:
    """The command line. Until it has been imported there is nothing to clean up: Ctrl-C ends the process at once."""
    handles_interrupts = signal.getsignal(signal.SIGINT) is signal.default_int_handler  # not ignored, as under nohup
    if handles_interrupts:
        signal.signal(signal.SIGINT, lambda number, frame: os._exit(INTERRUPTED))
    from pilotfish.cli import main as run

    if handles_interrupts:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        run()
    except KeyboardInterrupt:
        raise SystemExit(INTERRUPTED) from None


if __name__ == "__main__":
    main()

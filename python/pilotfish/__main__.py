"""The program ``pilotfish``, also as ``python -m pilotfish``. Imports nothing large before Ctrl-C ends it quietly."""

from __future__ import annotations

from pilotfish.interrupts import Interrupts


def main() -> None:
    """The command line. Until it has been imported there is nothing to clean up: Ctrl-C ends the process at once."""
    interrupts = Interrupts()
    interrupts.install()
    from pilotfish.cli import main as run

    try:
        interrupts.working = True
        try:
            run()
        finally:
            interrupts.working = False
    except KeyboardInterrupt:
        raise SystemExit(interrupts.exit_code()) from None
    except SystemExit as end:
        if isinstance(end.code, int):
            end.code = interrupts.exit_code(end.code)
        raise


if __name__ == "__main__":
    main()

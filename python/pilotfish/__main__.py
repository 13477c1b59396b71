"""The program ``pilotfish``, also as ``python -m pilotfish``. Imports nothing large before Ctrl-C ends it quietly."""

from __future__ import annotations

from pilotfish.interrupts import Interrupts, is_of_interrupt


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
    except SystemExit as end:
        if isinstance(end.code, int):
            end.code = interrupts.exit_code(end.code)
        raise
    except BaseException as error:
        if not is_of_interrupt(error):
            raise
        raise SystemExit(interrupts.exit_code()) from None


if __name__ == "__main__":
    main()

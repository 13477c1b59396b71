"""``python -m pilotfish``: the command line."""

from pilotfish.cli import main

main()

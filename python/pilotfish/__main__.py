"""``python -m pilotfish``: the command line."""

from pilotfish.cli import app

app(prog_name="pilotfish")

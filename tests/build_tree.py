"""Where the programs and libraries are that only tests use: they are built, and never installed."""

from __future__ import annotations

from pathlib import Path

from pilotfish import core

ROOT = Path(__file__).parents[1]


def built(name: str) -> Path:
    """``tests/probes/NAME`` of the build tree that the package was imported from, else of build/release."""
    beside = Path(core.__file__).parents[2] / "tests" / "probes" / name
    return beside if beside.exists() else ROOT / "build" / "release" / "tests" / "probes" / name

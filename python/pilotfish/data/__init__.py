"""Where the shipped data files are: scenarios, fuzzy sets, leaders, calibrations, configs.

An installed wheel carries them in this folder; a checkout (or a build tree, whose Python sources are links
into the checkout) has them in ``data/`` at the top of the repository.
"""

from __future__ import annotations

from pathlib import Path

from pilotfish.errors import MissingFileError

_HERE = Path(__file__).resolve().parent
_CHECKOUT = _HERE.parents[2] / "data"


def root() -> Path:
    """The folder that holds ``scenarios/``, ``fuzzy/``, ``leaders/`` and ``config/``."""
    for candidate in (_HERE, _CHECKOUT):
        if (candidate / "scenarios").is_dir():
            return candidate
    raise MissingFileError(f"Pilotfish's data files are neither in {_HERE} (wheel) nor in {_CHECKOUT} (checkout)")


def path(name: str) -> Path:
    """The shipped file ``name``, for example ``path("scenarios/line.yaml")``."""
    file = root() / name
    if not file.exists():
        beside = sorted(str(other.relative_to(root())) for other in file.parent.glob("*") if other.is_file())
        there = ", ".join(beside) if beside else "nothing"
        raise MissingFileError(f"no shipped data file '{name}'; beside it there is: {there}")
    return file

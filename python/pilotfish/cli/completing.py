"""What the shell proposes for an argument while it is typed. Where nothing is proposed, it completes files."""

from __future__ import annotations

from pilotfish.errors import MissingFileError


def shipped_scenarios(incomplete: str) -> list[str]:
    """The names of shipped scenarios that begin so."""
    from pilotfish import data

    try:
        return [name for name in data.scenarios() if name.startswith(incomplete)]
    except MissingFileError:
        return []


def experiments(incomplete: str) -> list[str]:
    """The same, and what stands for several."""
    return [name for name in ("both", *shipped_scenarios(incomplete)) if name.startswith(incomplete)]


def shipped_files(incomplete: str) -> list[str]:
    """The shipped files that begin so, as `pilotfish data` lists them."""
    from pilotfish import data

    try:
        names = [str(file.relative_to(data.root())) for file in data.files()]
    except MissingFileError:
        return []
    return [name for name in names if name.startswith(incomplete)]

"""``pilotfish data``: the shipped files, what they are, where they are, and copies of them."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.completing import shipped_files
from pilotfish.cli.console import console, friendly_errors, tell, warn


def data(
    path: Annotated[
        str | None,
        typer.Argument(
            help="One of them, e.g. scenarios/line.yaml, or a folder: prints its full path.",
            autocompletion=shipped_files,
        ),
    ] = None,
    copy: Annotated[
        Path | None,
        typer.Option("--copy", help="Copy it there: a new file, or into a folder. Without PATH: all of them."),
    ] = None,
) -> None:
    """List what is shipped: configurations, scenarios, leaders, calibrations, fuzzy laws, tunings, templates.

    A full path can be given to every command and program; a copy is to be edited.

    \b
    Examples
      pilotfish data
      pilotfish data scenarios/line.yaml
      pilotfish-sim --scenario "$(pilotfish data scenarios/line.yaml)" --realtime
      pilotfish data leaders/three_faces.yaml --copy my_leader.yaml
      pilotfish data --copy my_data         everything: the files name each other by relative paths
    """
    from pilotfish import data as shipped

    with friendly_errors():
        if path is None and copy is None:
            _print(shipped.files(), shipped.root())
            return
        source = shipped.root() if path is None else shipped.find(path)
        if copy is None:
            if source.is_dir():
                _print([file for file in shipped.files() if source in file.parents], shipped.root())
            else:
                typer.echo(str(source))
            return
        for written in _copy(source, copy):
            tell(f"wrote {written}")


def _print(files: list[Path], root: Path) -> None:
    """A line each; cut off to the width of a terminal, whole for everybody else."""
    from pilotfish.data import describe

    names = [str(file.relative_to(root)) for file in files]
    width = max(map(len, names))
    for name, file in zip(names, files, strict=True):
        line = f"{name:<{width}}  {describe(file)}"
        if console.is_terminal and len(line) > console.width:
            line = line[: console.width - 1] + "\u2026"
        typer.echo(line)


def _copy(source: Path, target: Path) -> list[Path]:
    """ExistsError where something is already; warns of files that the copy names and that are not beside it."""
    from pilotfish.data import files, root
    from pilotfish.errors import ExistsError

    if source.is_dir():
        if target.exists() and (not target.is_dir() or any(target.iterdir())):
            raise ExistsError(f"{target} is there already, and not empty: nothing is overwritten")
        chosen = [file for file in files() if source in file.parents]
        pairs = [(file, target / file.relative_to(source)) for file in chosen]
    else:
        place = target / source.name if target.is_dir() else target
        pairs = [(source, place)]
        if place.exists():
            raise ExistsError(f"{place} is there already: nothing is overwritten; choose another name")
    for file, place in pairs:
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, place)
    missing = sorted({name for _, place in pairs for name in _named(place) if not (place.parent / name).exists()})
    if missing and source != root():
        where = ", ".join(missing)
        warn(f"the copy names {where}, relative to itself: copy those, too, or enter their paths (pilotfish data PATH)")
    return [place for _, place in pairs]


def _named(file: Path) -> list[str]:
    if file.suffix != ".yaml":
        return []
    lines = (line.partition("#")[0] for line in file.read_text(errors="replace").splitlines())
    return [name for line in lines for name in re.findall(r":\s*(\.\./[\w./-]+)", line)]

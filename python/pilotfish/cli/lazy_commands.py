"""The commands by name, each imported when it is needed: `pilotfish stop` has to be quick, also on a small computer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import typer
import typer.core
import typer.main

from pilotfish.cli.help_text import let_help_flow


@dataclass(frozen=True)
class Place:
    """Where a command's function or a group's Typer is, and under which heading of the help it is listed."""

    name: str
    panel: str
    module: str
    attribute: str

    def build(self) -> typer.core.TyperCommand | typer.core.TyperGroup:
        """Imports it; a group of one, because Typer builds commands within groups alone."""
        found = getattr(import_module(self.module), self.attribute)
        around = typer.Typer(rich_markup_mode="rich")
        if isinstance(found, typer.Typer):
            around.add_typer(found, name=self.name, rich_help_panel=self.panel)
        else:
            around.command(self.name, rich_help_panel=self.panel)(found)
        let_help_flow(around)
        return typer.main.get_group(around).commands[self.name]


class LazyCommands(Mapping[str, Any]):
    """Name -> command, in the order of the places. Looking one up builds it; going through the names builds none."""

    def __init__(self, places: tuple[Place, ...]) -> None:
        self._places = {place.name: place for place in places}
        self._built: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._built:
            self._built[name] = self._places[name].build()
        return self._built[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

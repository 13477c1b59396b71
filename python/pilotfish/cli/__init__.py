"""The command line, in the order in which a new user needs it: set up a robot, see and drive, understand what happened,
simulate, look into the law."""

from __future__ import annotations

import sys
from typing import Annotated, Any

import typer

from pilotfish import __version__
from pilotfish.cli import console
from pilotfish.cli.lazy_commands import LazyCommands, Place

# Modules of pilotfish.cli with a function of their name; those with a Typer called app; and what one module shares.
_FUNCTIONS = {
    "Set up a robot": ("tags", "learn_body", "init", "doctor", "data"),
    "See and drive": ("view", "top"),
    "Recordings": ("plot", "report", "export", "replay", "identify"),
    "Simulate": ("demo", "experiment", "tune"),
}
_GROUPS = {
    "Set up a robot": ("calibrate", "leader"),
    "Simulate": ("render", "sweep", "formation"),
    "The fuzzy law": ("fuzzy",),
}
_OPERATING = ("stop", "go", "resume", "setpoint")
_PLACES = (
    *(
        Place(name.replace("_", "-"), panel, f"{__name__}.{name}", name)
        for panel, names in _FUNCTIONS.items()
        for name in names
    ),
    *(Place(name, "See and drive", f"{__name__}.operate", name) for name in _OPERATING),
    *(Place(name, panel, f"{__name__}.{name}", "app") for panel, names in _GROUPS.items() for name in names),
    Place("key", "Set up a robot", f"{__name__}.operate", "key_app"),
)


class _Pilotfish(console.SysexitsGroup):
    """The program, whose commands are imported when they are needed."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = LazyCommands(_PLACES)


app = typer.Typer(
    name="pilotfish",
    cls=_Pilotfish,
    help="A robot follows another robot by sight alone: set one up, watch and stop it, record, replay, simulate.",
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_show_locals=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """The program ``pilotfish``."""
    sys.exit(console.run(app))


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"pilotfish {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and end."),
    ] = False,
) -> None:
    pass

"""The command line, in the order in which a new user needs it: set up a robot, see and drive, understand what happened,
simulate, look into the law."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from pilotfish import __version__
from pilotfish.cli import console
from pilotfish.cli.calibrate import app as calibrate_app
from pilotfish.cli.data import data
from pilotfish.cli.demo import demo
from pilotfish.cli.doctor import doctor
from pilotfish.cli.experiment import experiment
from pilotfish.cli.export import export
from pilotfish.cli.formation import app as formation_app
from pilotfish.cli.fuzzy import app as fuzzy_app
from pilotfish.cli.help_text import let_help_flow
from pilotfish.cli.identify import identify
from pilotfish.cli.init import init
from pilotfish.cli.leader import app as leader_app
from pilotfish.cli.learn_body import learn_body
from pilotfish.cli.operate import go, key_app, resume, setpoint, stop
from pilotfish.cli.plot import plot
from pilotfish.cli.render import render
from pilotfish.cli.replay import replay
from pilotfish.cli.report import report
from pilotfish.cli.sweep import app as sweep_app
from pilotfish.cli.tags import tags
from pilotfish.cli.top import top
from pilotfish.cli.tune import tune
from pilotfish.cli.view import view

_COMMANDS = {
    "Set up a robot": (tags, learn_body, init, doctor, data),
    "See and drive": (view, top, stop, go, resume, setpoint),
    "Recordings": (plot, report, export, replay, identify),
    "Simulate": (demo, experiment, render, tune),
}
_GROUPS = {
    "Set up a robot": {"calibrate": calibrate_app, "leader": leader_app, "key": key_app},
    "Simulate": {"sweep": sweep_app, "formation": formation_app},
    "The fuzzy law": {"fuzzy": fuzzy_app},
}

app = typer.Typer(
    name="pilotfish",
    cls=console.SysexitsGroup,
    help="A robot follows another robot by sight alone: set one up, watch and stop it, record, replay, simulate.",
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_show_locals=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for panel, commands in _COMMANDS.items():
    for command in commands:
        app.command(rich_help_panel=panel)(command)
for panel, groups in _GROUPS.items():
    for name, group in groups.items():
        app.add_typer(group, name=name, rich_help_panel=panel)
let_help_flow(app)


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

"""The command line: ``pilotfish experiment | render | plot | replay | learn-body | tune | fuzzy | demo``, and for a
robot that runs ``stop | resume | setpoint | key | doctor``."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from pilotfish import __version__
from pilotfish.cli import console
from pilotfish.cli.calibrate import app as calibrate_app
from pilotfish.cli.demo import demo
from pilotfish.cli.doctor import doctor
from pilotfish.cli.experiment import experiment
from pilotfish.cli.fuzzy import app as fuzzy_app
from pilotfish.cli.learn_body import learn_body
from pilotfish.cli.operate import key_app, resume, setpoint, stop
from pilotfish.cli.plot import plot
from pilotfish.cli.render import render
from pilotfish.cli.replay import replay
from pilotfish.cli.tune import tune

app = typer.Typer(
    name="pilotfish",
    cls=console.SysexitsGroup,
    help="A robot follows another robot by sight alone: run experiments, render, draw, learn a leader's body.",
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_show_locals=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (stop, resume, setpoint, experiment, render, plot, replay, learn_body, tune, demo, doctor):
    app.command()(command)
app.add_typer(calibrate_app, name="calibrate")
app.add_typer(key_app, name="key")
app.add_typer(fuzzy_app, name="fuzzy")


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

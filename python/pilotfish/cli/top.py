"""``pilotfish top``: every robot on the bus, in one table."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from pilotfish.cli.console import console, friendly_errors, print_whole, warn
from pilotfish.cli.operate import KeyOption, UrlOption
from pilotfish.cli.options import between

if TYPE_CHECKING:
    from pilotfish.watching.columns import Column
    from pilotfish.watching.robots import Row


def top(
    robots: Annotated[list[str] | None, typer.Argument(help="Only these; default: all that are heard.")] = None,
    lcm_url: UrlOption = "",
    key: KeyOption = None,
    once: Annotated[bool, typer.Option("--once", help="Print one table and end, without Textual.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON array and end: SI units.")] = False,
    seconds: Annotated[
        float,
        typer.Option("--seconds", callback=between(0.1, 60.0, "s"), help="With --once or --json: how long to listen."),
    ] = 1.0,
) -> None:
    """Show every robot on the bus: status, reason, distance, commands, rates, latency, refusals; and stop one.

    Works over SSH and without Java; pictures are not received. Keys: q quit, s stop the selected robot (asks nothing),
    < > sort, R reverse, ? help. Sends nothing but such stops.

    On a terminal --once leaves out the columns that do not fit; in a pipe or a file it prints all.

    --once and --json end with 69 if no robot is heard.

    \b
    Examples
      pilotfish top
      pilotfish top robot1 robot2
      pilotfish top --once                      for a log or a script
      pilotfish top --json | jq '.[].status'
    """
    from pilotfish.bus import channel
    from pilotfish.errors import ConfigError

    for robot in robots or ():
        try:
            channel(robot, "STATUS")
        except ConfigError as error:
            raise typer.BadParameter(str(error)) from None
    with friendly_errors():
        if once or as_json:
            _print(lcm_url, seconds, tuple(robots or ()), as_json)
        else:
            _run(lcm_url, tuple(robots or ()), key)


def _run(lcm_url: str, robots: tuple[str, ...], key: Path | None) -> None:
    from pilotfish.extras import require
    from pilotfish.loop_signals import run_until_signal

    require("textual", "top")
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise typer.BadParameter("this is no terminal: --once prints one table, --json an array")
    from pilotfish.top.app import TopApp, stop_robot

    stop = stop_robot(lcm_url, key) if key else None
    app = TopApp(lcm_url, robots=robots, stop=stop, wall_offset_s=time.time() - time.monotonic())
    run_until_signal(app.run_async, lambda number: app.exit(return_code=128 + number))
    raise typer.Exit(app.return_code or 0)


def _print(lcm_url: str, seconds: float, robots: tuple[str, ...], as_json: bool) -> None:
    from pilotfish.errors import SilentRobotError
    from pilotfish.top import once
    from pilotfish.watching.columns import as_dict

    heard, url = once(lcm_url, seconds, robots)
    rows = heard.rows(time.monotonic())
    if not_shown := heard.left_out():
        warn(f"heard and not shown: {not_shown}; a robot's name is 1 to 32 letters, digits and underscores")
    if as_json:
        typer.echo(json.dumps([as_dict(row) for row in rows], indent=2))
    elif rows:
        _print_table(rows)
    if not rows:
        asked = f"{', '.join(robots)} is not" if robots else "no robot is"
        raise SilentRobotError(f"{asked} heard on {url} within {seconds:g} s; pilotfish doctor says if the bus works")


def _print_table(rows: list[Row]) -> None:
    from pilotfish.watching.columns import COLUMNS, fitting, width

    if console.is_terminal:
        console.print(_table(rows, fitting(rows, console.width)))
    else:
        print_whole(_table(rows, COLUMNS), width(rows, COLUMNS))


def _table(rows: list[Row], columns: Sequence[Column]) -> Table:
    """As Rich prints them."""
    from pilotfish.watching.columns import GAP, style

    printed = Table(box=None, padding=(0, GAP, 0, 0), pad_edge=False, header_style="bold")
    for column in columns:
        printed.add_column(Text(column.title), justify="right" if column.right else "left", no_wrap=True)
    for row in rows:
        printed.add_row(*(Text(column.text(row), style=style(row, column)) for column in columns))
    return printed

"""``pilotfish doctor``: is this machine ready, and if not, what is to be done."""

from __future__ import annotations

import json
import os
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from pilotfish.cli.console import console

_COLOURS = {"ok": "green", "note": "yellow", "wrong": "bold red"}
_WIDTH = 80


def doctor(
    lcm_url: Annotated[
        str | None, typer.Option("--lcm-url", help="The bus to look at; default: $LCM_DEFAULT_URL, else this host's.")
    ] = None,
    listen_s: Annotated[float, typer.Option(min=0.05, max=60.0, help="How long to listen to the bus.")] = 1.0,
    black_box: Annotated[
        str, typer.Option("--black-box", help="Where recordings go, to see if there is room.")
    ] = "/var/lib/pilotfish",
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")] = False,
) -> None:
    """Look at this machine: programs, bus, devices, permissions, clock, disk. Says what to do about what it finds.

    Ends with 0 if nothing is wrong, with 1 if something is. Changes nothing.
    """
    from pilotfish.doctor import Verdict, examine
    from pilotfish.doctor.network import DEFAULT_URL

    url = lcm_url or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL
    findings = examine(lcm_url=url, listen_s=listen_s, black_box=black_box)
    wrong = sum(finding.verdict is Verdict.wrong for finding in findings)
    if as_json:
        report = {"ok": wrong == 0, "lcm_url": url, "findings": [finding.as_dict() for finding in findings]}
        typer.echo(json.dumps(report, indent=2))
    else:
        table = Table.grid(padding=(0, 2))
        for column in (7, 21, None):
            table.add_column(width=column, overflow="fold")
        for finding in findings:
            word = finding.verdict.value
            advice = f"\n[italic]-> {escape(finding.advice)}[/]" if finding.advice else ""
            table.add_row(f"[{_COLOURS[word]}]{word}[/]", finding.check, escape(finding.seen) + advice)
        console.print(table, width=min(_WIDTH, console.width))
        console.print(f"{wrong} of {len(findings)} wrong" if wrong else "nothing is wrong")
    raise typer.Exit(1 if wrong else 0)

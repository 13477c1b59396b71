"""``pilotfish doctor``: is this machine ready, and if not, what is to be done; why a robot does not follow."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.advice import print_finding
from pilotfish.cli.console import console, friendly_errors, progress
from pilotfish.cli.options import between

_COLOURS = {"ok": "green", "note": "yellow", "wrong": "bold red"}
_FOLLOWING_S = 10.0


def doctor(
    following: Annotated[
        str | None,
        typer.Option("--following", metavar="ROBOT", help="Watch this robot's coordinator instead of the machine."),
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option("--seconds", callback=between(1.0, 3600.0, "s"), help="With --following: how long. Default: 10."),
    ] = None,
    config: Annotated[
        Path | None,
        typer.Option(
            "--config",
            exists=True,
            dir_okay=False,
            help="The coordinator's configuration: its camera is measured, and its leader's ids are compared.",
        ),
    ] = None,
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

    With --following: watch a running coordinator and say why its robot does not follow, the most likely cause
    first.

    Ends with 0 if nothing is wrong (the robot follows), with 1 if something is. Changes nothing, sends no command.

    \b
    Examples
      pilotfish doctor                                     this machine
      pilotfish doctor --config robot1.yaml                and the camera that robot1.yaml names
      pilotfish doctor --following robot1                  why does it not follow?
      pilotfish doctor --following robot1 --config robot1.yaml --seconds 30
    """
    with friendly_errors():
        if following is None:
            if seconds is not None:
                raise typer.BadParameter("--seconds belongs to --following ROBOT; --listen-s listens to the bus")
            _examine(lcm_url, listen_s, black_box, config, as_json)
        else:
            _check_robot(following)
            _follow(following, seconds or _FOLLOWING_S, lcm_url, config, as_json)


def _examine(lcm_url: str | None, listen_s: float, black_box: str, config: Path | None, as_json: bool) -> None:
    from pilotfish.doctor import Verdict, examine
    from pilotfish.doctor.following.setup import load_setup
    from pilotfish.doctor.network import DEFAULT_URL

    url = lcm_url or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL
    setup = load_setup(config) if config else None
    findings = examine(lcm_url=url, listen_s=listen_s, black_box=black_box, setup=setup)
    wrong = sum(finding.verdict is Verdict.wrong for finding in findings)
    if as_json:
        report = {"ok": wrong == 0, "lcm_url": url, "findings": [finding.as_dict() for finding in findings]}
        typer.echo(json.dumps(report, indent=2))
    else:
        for finding in findings:
            word = finding.verdict.value
            print_finding(console, [(word, 5, _COLOURS[word]), (finding.check, 21, "")], finding.seen, finding.advice)
        console.print(f"{wrong} of {len(findings)} wrong" if wrong else "nothing is wrong")
    raise typer.Exit(1 if wrong else 0)


def _follow(robot: str, seconds: float, lcm_url: str | None, config: Path | None, as_json: bool) -> None:
    from pilotfish.cli.following_report import print_diagnosis
    from pilotfish.doctor.following import diagnose

    with progress(f"watching {robot} [s]") as step:
        diagnosis = diagnose(
            robot,
            seconds=seconds,
            lcm_url=lcm_url or "",
            config=config,
            on_time=lambda passed_s: step(int(passed_s), int(seconds)),
        )
    if as_json:
        typer.echo(json.dumps(diagnosis.as_dict(), indent=2))
    else:
        print_diagnosis(diagnosis, console)
    raise typer.Exit(0 if diagnosis.follows else 1)


def _check_robot(name: str) -> None:
    from pilotfish.bus import channel

    try:
        channel(name, "STATUS")
    except ValueError as error:
        raise typer.BadParameter(f"--following: {error}") from None

"""The command line of the benchmark: which parts, how often, and the tables."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated

import typer
from disturbances import DISTURBANCES
from drive import Driven, Plan, drive
from parts import PARTS, Row, rows_of
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from wheels import stopping_ms

from bench.common.statistics import quantile
from pilotfish.errors import HarnessError

console = Console(width=160)
_UNAVAILABLE, _INTERNAL = 69, 70


def main(
    quick: Annotated[bool, typer.Option("--quick", help="Once each, ideal link and the worst of each kind.")] = False,
    part: Annotated[list[str] | None, typer.Option(help=f"Only this one of {', '.join((*PARTS, 'wheels'))}.")] = None,
    disturbance: Annotated[
        list[str] | None, typer.Option(help=f"Only this one of {', '.join(DISTURBANCES)}; besides the ideal link.")
    ] = None,
    repetitions: Annotated[int, typer.Option(min=1, max=100, help="Of every drive in real time.")] = 3,
    duration_s: Annotated[float, typer.Option(min=1.0, max=600.0, help="Of a drive.")] = 20.0,
    switch: Annotated[str, typer.Option(help="relay: our own; netem: this kernel's, where it has it.")] = "relay",
    out: Annotated[Path, typer.Option(help="Folder for network.json.")] = Path("out"),
) -> None:
    """Every robot has a network namespace of its own, with its pilotfish-sim (its camera) and its
    pilotfish-coordinator; a further host watches. What crosses between them is disturbed. Needs no root where user
    namespaces are permitted.

    \b
    Parts
      lockstep    two robots, local images, in lock-step: equal to the bit to the ideal link?
      following   the same in real time: RMS distance error, beside the spread of identical repetitions
      nonideal    the same with data/hardware/nonideal.yaml
      images      everything on the shared bus: free, at 20 Mbit/s, with the link and with the interface down
      wheels      the link between the coordinator's host and the wheels' goes down: time to the first zero
      intent      stop_dead, with the leader's intent over the disturbed link: closest approach

    The RMS is over the true distance from 40 % of the drive to the end; link and interface are down from 40 to 90 %.
    """
    for asked, known in ((part, [*PARTS, "wheels"]), (disturbance, DISTURBANCES), ([switch], ("relay", "netem"))):
        if wrong := sorted(set(asked or ()) - set(known)):
            raise typer.BadParameter(f"{', '.join(wrong)}: there is {', '.join(known)}")
    if switch == "netem" and not _has_netem():
        console.print("this kernel has no netem (CONFIG_NET_SCH_NETEM): sudo modprobe sch_netem, or --switch relay")
        raise typer.Exit(_UNAVAILABLE)
    report: dict[str, object] = {"machine": platform.processor() or platform.machine(), "cores": os.cpu_count()}
    out.mkdir(parents=True, exist_ok=True)
    different = False
    for name in part or [*PARTS, "wheels"]:
        if name == "wheels":
            stopped = stopping_ms(3 if quick else 30)
            console.print(
                f"wheels: link down to the first zero, {len(stopped)} times: "
                f"median {quantile(stopped, 0.5):.1f} ms, at most {max(stopped):.1f} ms"
            )
            report[name] = {"ms": stopped}
            continue
        chosen = PARTS[name]
        keys = [key for key in (chosen.quick if quick else chosen.disturbances) if key in (disturbance or DISTURBANCES)]
        keys = ["none", *(key for key in keys if key != "none")]
        plan = replace(chosen.plan, duration_s=duration_s, switch=chosen.plan.switch if name == "images" else switch)
        times = 1 if quick or plan.lockstep else repetitions
        runs = _runs(name, plan, keys, times)
        rows = rows_of(runs)
        different = different or any(row.identical is False for row in rows)
        console.print(_table(name, rows))
        report[name] = {"plan": asdict(plan), "repetitions": times, "rows": [asdict(row) for row in rows]}
        _write(out, report)
    _write(out, report)
    console.print(f"wrote {out / 'network.json'}")
    if different:
        raise typer.Exit(1)


def _write(out: Path, report: dict[str, object]) -> None:
    (out / "network.json").write_text(json.dumps(report, indent=1) + "\n")


def _runs(name: str, plan: Plan, keys: Sequence[str], times: int) -> dict[str, list[list[Driven]]]:
    """By disturbance, every repetition. Repetitions are the outer loop: what changes with time reaches all rows."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    runs: dict[str, list[list[Driven]]] = {key: [] for key in keys}
    with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True)) as bar:
        task = bar.add_task(name, total=times * len(keys))
        for repetition in range(times):
            for key in keys:
                bar.update(task, description=f"{name}: {DISTURBANCES[key].words}")
                runs[key].append(drive(replace(plan, disturbance=key, relay_seed=repetition + 1)))
                bar.advance(task)
    return runs


def _table(name: str, rows: list[Row]) -> Table:
    table = Table(title=f"{name}: {PARTS[name].words}", title_justify="left")
    columns = ["scenario", "link", "RMS [mm]", "min..max", "change [mm]", "ideal spread", "closest [mm]", "tracking"]
    for column in (*columns, "rendered", "watched", "gap [s]", "to the bit"):
        table.add_column(column, justify="left" if column in ("scenario", "link") else "right")
    for row in rows:
        table.add_row(
            row.scenario,
            row.link,
            f"{row.rms_mm:.3f}",
            f"{row.rms_min_mm:.3f}..{row.rms_max_mm:.3f}",
            f"{row.change_mm:+.3f}" + (f" ({100 * row.change:+.1f} %)" if abs(row.change) < 10 else ""),
            f"{row.ideal_spread_mm:.3f}",
            f"{row.closest_mm:.2f}",
            f"{row.tracking:.1%}",
            f"{row.rendered:.1%}",
            f"{row.watched:.0f}",
            f"{row.gap_s:.2f}",
            "" if row.identical is None else "[green]yes[/]" if row.identical else "[red]no[/]",
        )
    return table


def _has_netem() -> bool:
    words = [
        "tc",
        "qdisc",
        "replace",
        "dev",
        "lo",
        "root",
        "netem",
        "delay",
        "0ms",
    ]  # lo of this network, which is ours
    return subprocess.run(words, capture_output=True, check=False).returncode == 0


def run() -> None:
    """The benchmark; a program that fails is named, with what it said."""
    try:
        typer.run(main)
    except HarnessError as error:
        print(f"bench/network: {error}", file=sys.stderr)
        sys.exit(_INTERNAL)

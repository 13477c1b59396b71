"""How fast the wheels are commanded to stand still when something dies.

Takes: 40 minutes; 2 with --quick.
scripts/bench safety
scripts/bench safety -- --quick                           20 repetitions of each
scripts/bench safety -- --part base-deadline --kind stop --load idle
"""

from __future__ import annotations

import json
import os
import platform
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import typer
from base_deadline import KINDS, Deadline, measure
from loss_deadline import FAULTS, Loss
from loss_deadline import measure as measure_loss
from rich.console import Console
from rich.table import Table

from bench.common.statistics import quantile

console = Console(width=120)
LOADS = {"idle": 0, "busy": 4}
GOAL_MS = {"idle": 100.0, "busy": 110.0}


PARTS = ("base-deadline", "loss-deadline")


def main(
    quick: Annotated[bool, typer.Option("--quick", help="20 repetitions instead of 1000.")] = False,
    repetitions: Annotated[int, typer.Option(min=1, help="Of each kind under each load.")] = 1000,
    part: Annotated[list[str] | None, typer.Option(help=f"Only this one of {', '.join(PARTS)}.")] = None,
    kind: Annotated[list[str] | None, typer.Option(help=f"Only this one of {', '.join((*KINDS, *FAULTS))}.")] = None,
    load: Annotated[list[str] | None, typer.Option(help=f"Only this one of {', '.join(LOADS)}.")] = None,
    rate_hz: Annotated[float, typer.Option(min=5.0, max=60.0, help="The camera's, in loss-deadline.")] = 30.0,
    out: Annotated[Path, typer.Option(help="Folder for safety.json.")] = Path("out"),
) -> None:
    """Something dies, or the leader is lost, while the robot moves: how long until the wheels are commanded zero?"""
    for asked, known in ((part, PARTS), (kind, [*KINDS, *FAULTS]), (load, list(LOADS))):
        if wrong := set(asked or ()) - set(known):
            raise typer.BadParameter(f"{', '.join(sorted(wrong))}: there is {', '.join(known)}")
    count = 20 if quick else repetitions
    report: dict[str, object] = {"machine": platform.processor() or platform.machine(), "cores": os.cpu_count()}
    if "base-deadline" in (part or PARTS):
        found = [
            (how, which, measure(how, count, busy_loops=LOADS[which]))
            for which in load or LOADS
            for how in [each for each in KINDS if each in (kind or KINDS)]
        ]
        console.print(_table(found))
        report["base-deadline"] = [{"kind": how, "load": which, **asdict(deadline)} for how, which, deadline in found]
    if "loss-deadline" in (part or PARTS):
        losses = [
            (how, which, measure_loss(how, count, rate_hz=rate_hz, busy_loops=LOADS[which]))
            for which in load or LOADS
            for how in [each for each in FAULTS if each in (kind or FAULTS)]
        ]
        console.print(_loss_table(losses, rate_hz))
        report["loss-deadline"] = [
            {"kind": how, "load": which, "rate_hz": rate_hz, **asdict(loss)} for how, which, loss in losses
        ]
    out.mkdir(parents=True, exist_ok=True)
    (out / "safety.json").write_text(json.dumps(report, indent=1) + "\n")


def _loss_table(losses: list[tuple[str, str, Loss]], rate_hz: float) -> Table:
    """The goals are those of a life of 100 ms; a camera slower than 12 Hz has 250."""
    table = Table(title=f"Last good picture to the first zero on the bus [ms], {rate_hz:g} Hz", title_justify="left")
    for column in ("what happens", "load", "times", "p50", "p99", "max", "goal", "met", "moved after"):
        table.add_column(column, justify="left" if column in ("what happens", "load", "met") else "right")
    longer_ms = 150.0 if rate_hz < 12.0 else 0.0
    for how, which, loss in losses:
        values, goal_ms = loss.zero_ms, GOAL_MS[which] + longer_ms
        met = max(values) <= goal_ms and loss.moved_after == 0
        table.add_row(
            FAULTS[how],
            "idle" if which == "idle" else f"{LOADS[which]} busy loops",
            str(len(values)),
            *(f"{value:.1f}" for value in (quantile(values, 0.5), quantile(values, 0.99), max(values))),
            f"<= {goal_ms:.0f}",
            "[green]yes[/]" if met else "[red]no[/]",
            str(loss.moved_after),
        )
    return table


def _table(found: list[tuple[str, str, Deadline]]) -> Table:
    table = Table(title="Sender killed or stopped: milliseconds to the first zero", title_justify="left")
    for column in ("what happens", "load", "times", "seen on", "p50", "p99", "max", "goal", "met", "moved after"):
        table.add_column(column, justify="left" if column in ("what happens", "load", "seen on", "met") else "right")
    for how, which, deadline in found:
        for place, values in (("the line", deadline.line_ms), ("the bus", deadline.bus_ms)):
            met = max(values) <= GOAL_MS[which] and deadline.moved_after == 0
            table.add_row(
                KINDS[how].words,
                "idle" if which == "idle" else f"{LOADS[which]} busy loops",
                str(len(values)),
                place,
                *(f"{value:.1f}" for value in (quantile(values, 0.5), quantile(values, 0.99), max(values))),
                f"<= {GOAL_MS[which]:.0f}",
                "[green]yes[/]" if met else "[red]no[/]",
                str(deadline.moved_after),
            )
    return table


if __name__ == "__main__":
    typer.run(main)

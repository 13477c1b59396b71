"""How fast the wheels are told to stand still when something dies; what came of the goals.

python bench/safety                                   everything; some 40 minutes, on a computer that does nothing else
python bench/safety --quick                           20 repetitions of each
python bench/safety --part base-deadline --kind stop --load idle
"""

from __future__ import annotations

import json
import os
import platform
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from base_deadline import KINDS, Deadline, measure, quantile
from rich.console import Console
from rich.table import Table

console = Console(width=120)
LOADS = {"idle": 0, "busy": 4}
GOAL_MS = {"idle": 100.0, "busy": 110.0}


def main(
    quick: Annotated[bool, typer.Option("--quick", help="20 repetitions instead of 1000.")] = False,
    repetitions: Annotated[int, typer.Option(min=1, help="Of each kind under each load.")] = 1000,
    part: Annotated[list[str] | None, typer.Option(help="Only this one; there is: base-deadline.")] = None,
    kind: Annotated[list[str] | None, typer.Option(help=f"Only this one of {', '.join(KINDS)}.")] = None,
    load: Annotated[list[str] | None, typer.Option(help=f"Only this one of {', '.join(LOADS)}.")] = None,
    out: Annotated[Path, typer.Option(help="Folder for safety.json.")] = Path("out"),
) -> None:
    """Kill or stop the sender of commands while the wheels turn: how long until they are told zero?"""
    for asked, known in ((part, ["base-deadline"]), (kind, list(KINDS)), (load, list(LOADS))):
        if wrong := set(asked or ()) - set(known):
            raise typer.BadParameter(f"{', '.join(sorted(wrong))}: there is {', '.join(known)}")
    count = 20 if quick else repetitions
    found: list[tuple[str, str, Deadline]] = []
    for which in load or LOADS:
        for how in kind or KINDS:
            found.append((how, which, measure(how, count, busy_loops=LOADS[which])))
    console.print(_table(found))
    out.mkdir(parents=True, exist_ok=True)
    report = {"machine": platform.processor() or platform.machine(), "cores": os.cpu_count()}
    report["base-deadline"] = [{"kind": how, "load": which, **asdict(deadline)} for how, which, deadline in found]
    (out / "safety.json").write_text(json.dumps(report, indent=1) + "\n")


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

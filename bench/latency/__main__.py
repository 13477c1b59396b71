"""From a picture to the command that answers it, beside LCM alone with the same picture.

Takes: 8 minutes; 1 with --quick.
scripts/bench latency
scripts/bench latency -- --quick                      300 pictures to each: a look, not a result
scripts/bench latency -- --condition busy --frames 1000
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
from figures import Row, goal_text, rows_of
from measure import CONDITIONS, RATE_HZ, Delays, measure
from rich.console import Console
from rich.table import Table

from bench.common.compiled import RELEASE, built

console = Console(width=140)


def main(
    quick: Annotated[bool, typer.Option("--quick", help="300 pictures to each arm.")] = False,
    frames: Annotated[int, typer.Option(min=10, help="Pictures to each arm under each condition.")] = 3000,
    condition: Annotated[list[str] | None, typer.Option(help=f"Only this one of {', '.join(CONDITIONS)}.")] = None,
    build: Annotated[Path, typer.Option(help="The build tree, for the plain liblcm program.")] = RELEASE,
    out: Annotated[Path, typer.Option(help="Folder for latency.json.")] = Path("out"),
) -> None:
    """A picture is published: how long until the command that answers it, and how much of that is LCM?

    640x480 at 30 Hz of a leader that drives, raw and as JPEG, in turn to a real pilotfish-coordinator (line.yaml as
    shipped, real time) and to a plain liblcm program that reads the picture's header and answers with a command.

    For both the clock runs from just before publish() to the kernel's time stamp of the first command that carries the
    picture's utime. What the coordinator sends between pictures repeats an old utime and does not count; a picture
    without an answer counts as infinitely late.

    The goals: p50 at most 1.5 times LCM alone with the same picture raw, and p99.9 at most 10 ms, on two cores or on
    one; beside 4 busy loops p99.9 at most 33 ms.
    """
    if wrong := set(condition or ()) - set(CONDITIONS):
        raise typer.BadParameter(f"{', '.join(sorted(wrong))}: there is {', '.join(CONDITIONS)}")
    bare_transport = built("latency/bare_transport", build)
    rows: list[Row] = []
    raw: list[dict[str, object]] = []
    for name in condition or CONDITIONS:
        found = measure(CONDITIONS[name], 300 if quick else frames, bare_transport)
        rows += rows_of(name, found)
        raw += [{"condition": name, **asdict(arm)} for arm in found]
        console.print(_table(name, rows))
        console.print(_inside(found))
    out.mkdir(parents=True, exist_ok=True)
    machine = f"{platform.processor() or platform.machine()}, {platform.system()} {platform.release()}"
    report = {"machine": machine, "cores": os.cpu_count(), "rows": [asdict(row) for row in rows], "arms": raw}
    (out / "latency.json").write_text(json.dumps(report) + "\n")
    console.print(f"wrote {out / 'latency.json'}")


def _table(condition: str, rows: list[Row]) -> Table:
    title = f"640x480, {RATE_HZ:g} Hz, {CONDITIONS[condition].words}: publish() to command [ms]"
    table = Table(title=title, title_justify="left")
    words = ("receiver", "picture", "goal", "met")
    for column in (
        "receiver",
        "picture",
        "answered",
        "p50",
        "p99",
        "p99.9",
        "max",
        "/ same bare",
        "/ raw bare",
        "goal",
        "met",
    ):
        table.add_column(column, justify="left" if column in words else "right")
    for row in rows:
        if row.condition != condition:
            continue
        ours = row.receiver == "pilotfish"
        table.add_row(
            row.receiver,
            row.picture,
            f"{row.answered}/{row.sent}",
            *(f"{value:.3f}" for value in (row.p50_ms, row.p99_ms, row.p999_ms, row.max_ms)),
            *(f"{value:.2f}" if ours else "" for value in (row.to_same_bare, row.to_raw_bare)),
            goal_text(condition) if ours else "",
            (f"[red]not {', '.join(row.missed)}[/]" if row.missed else "[green]yes[/]") if ours else "",
        )
    return table


def _inside(found: list[Delays]) -> str:
    """What the coordinator says of itself: where a delay comes from that is too long."""
    return "\n".join(
        f"{arm.picture}: {arm.tracking / max(len(arm.milliseconds), 1):.1%} of the answers follow the leader; "
        f"{arm.other_commands} other commands; the coordinator's own p50 from arrival to command "
        f"{_median(arm.inside_ms):.3f} ms, of it vision and law {_median(arm.looked_ms):.3f} ms; "
        f"the very first picture, not counted, {arm.first_ms:.1f} ms"
        for arm in found
        if arm.receiver == "pilotfish"
    )


def _median(values: list[float]) -> float:
    return sorted(values)[len(values) // 2] if values else float("nan")


if __name__ == "__main__":
    typer.run(main)

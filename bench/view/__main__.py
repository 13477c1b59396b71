"""The robot in a browser: what the server costs, and how old a picture is when Chromium shows it.

Takes: 6 minutes; half a minute with --quick.
scripts/bench view
scripts/bench view -- --quick
"""

from __future__ import annotations

import json
import os
import platform
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import typer
from measure import ages, load, page_of, viewing
from rich.console import Console
from rich.table import Table
from tabs import PREVIEW_HZ, latencies_ms

from bench.common.statistics import quantile

console = Console(width=120)

IDLE_GOAL, AGE_GOAL_MS = 0.03, 150.0
TABS = 5


@dataclass(frozen=True)
class Condition:
    """What is sent: messages (three kinds each) and pictures a second."""

    words: str
    rate_hz: float
    picture_kind: str
    picture_hz: float
    goal: bool  # whether the goals refer to it


CONDITIONS = (
    Condition("messages and previews (JPEG) at 10 Hz", 10, "PREVIEW", 10, goal=True),
    Condition("messages at 30 Hz, the camera's own raw pictures at 30 Hz", 30, "IMAGE", 30, goal=False),
)


def main(
    quick: Annotated[bool, typer.Option("--quick", help="A few seconds of each: a look, not a result.")] = False,
    seconds: Annotated[float, typer.Option(min=1, help="So long the processor time is counted.")] = 20.0,
    pictures: Annotated[int, typer.Option(min=10, help="So many are followed from exposure to page.")] = 200,
    tab_seconds: Annotated[float, typer.Option(min=1, help="Of each arm with and without pages.")] = 35.0,
    out: Annotated[Path, typer.Option(help="Folder for view.json.")] = Path("out"),
) -> None:
    """A real `pilotfish view` beside a process that sends a robot's messages and 640x480 pictures of a leader.

    Processor time of the server without a page and with one; and the age of a picture when headless Chromium's page has
    drawn it, and when the browser composes its next frame. The clock starts just before the picture is published;
    exposure, readout and the camera's transfer come before. Server, sender and browser share this computer.
    """
    seconds, pictures = (4.0, 30) if quick else (seconds, pictures)
    table = Table(title="640x480, one page on this host", title_justify="left")
    for column in ("sent", "nobody watches", "one page", "drawn p50", "composed p50", "p95", "max [ms]", "met"):
        table.add_column(column, justify="left" if column == "sent" else "right")
    rows = []
    for condition in CONDITIONS:
        with viewing(condition.rate_hz, condition.picture_kind, condition.picture_hz) as child:
            idle = load(child, seconds)
            with page_of(child) as page:
                drawn, composed = ages(page, pictures)
                watched = load(child, seconds / 2)
        p50, p95 = quantile(composed, 0.5), quantile(composed, 0.95)
        met = idle <= IDLE_GOAL and p95 <= AGE_GOAL_MS
        rows.append(asdict(condition) | {"idle": idle, "watched": watched, "drawn_ms": drawn, "composed_ms": composed})
        table.add_row(
            condition.words,
            f"{idle:.1%} of a core",
            f"{watched:.1%}",
            *(f"{value:.0f}" for value in (quantile(drawn, 0.5), p50, p95, max(composed))),
            ("[green]yes[/]" if met else "[red]no[/]") if condition.goal else "",
        )
    console.print(table)
    commands = _commands(6.0 if quick else tab_seconds, 1 if quick else 3)
    console.print(f"goals: at most {IDLE_GOAL:.0%} of a core while nobody watches, p95 at most {AGE_GOAL_MS:g} ms")
    out.mkdir(parents=True, exist_ok=True)
    machine = f"{platform.processor() or platform.machine()}, {platform.system()} {platform.release()}"
    (out / "view.json").write_text(
        json.dumps({"machine": machine, "cores": os.cpu_count(), "rows": rows, **commands}) + "\n"
    )
    console.print(f"wrote {out / 'view.json'}")


def _commands(seconds: float, rounds: int) -> dict[str, dict[int, list[float]]]:
    """The coordinator beside the server: real programs in real time, arms in turn so that a slow minute meets both."""
    arms: dict[int, list[float]] = {0: [], TABS: []}
    for _ in range(rounds):
        for tabs, taken in arms.items():
            taken += latencies_ms(tabs, seconds)
    table = Table(title=f"picture to command, {PREVIEW_HZ:g} previews a second", title_justify="left")
    for column in ("pages", "commands", "p50 [ms]", "p99", "p99.9", "max"):
        table.add_column(column, justify="right")
    for tabs, taken in arms.items():
        table.add_row(str(tabs), str(len(taken)), *(f"{quantile(taken, q):.2f}" for q in (0.5, 0.99, 0.999, 1.0)))
    console.print(table)
    return {"command_ms": arms}


if __name__ == "__main__":
    typer.run(main)

"""Obstacles passed while following: collisions, time until the formation is kept again.

Takes: 20 minutes; 1 with --quick.
scripts/bench obstacles
scripts/bench obstacles -- --quick              50 worlds
scripts/bench obstacles -- --count 6 --count 20  other densities: obstacles in 15 square metres
scripts/bench obstacles -- --alone              the law without avoidance beside it, in the same worlds
"""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from pilotfish.harness.obstacle_worlds import ARENA_M2, SETTLE_S, Ending, Outcome, outcome

console = Console(width=120)
GOAL_COLLISIONS, GOAL_KEPT = 0, 0.95


def main(
    quick: Annotated[bool, typer.Option("--quick", help="50 worlds instead of 1000.")] = False,
    worlds: Annotated[int, typer.Option(min=1, max=1_000_000, help="Of each density.")] = 1000,
    count: Annotated[list[int] | None, typer.Option(min=0, max=100, help="Obstacles in a world.")] = None,
    first_seed: Annotated[int, typer.Option(min=0, help="The worlds are this one and the next.")] = 1,
    profile: Annotated[str, typer.Option(help="The law: paper, anticipate, pid, pbvs.")] = "anticipate",
    alone: Annotated[bool, typer.Option("--alone", help="Also the law without avoidance.")] = False,
    workers: Annotated[int, typer.Option(min=1, help="Processes.")] = os.cpu_count() or 1,
    out: Annotated[Path, typer.Option(help="Folder for obstacles.json.")] = Path("out"),
) -> None:
    """One robot follows a leader through worlds that are drawn from their seeds. Measurements and sonars are drawn;
    whether an obstacle hides the leader is computed."""
    seeds = range(first_seed, first_seed + (50 if quick else worlds))
    report: list[dict[str, object]] = []
    table = Table(title=f"{len(seeds)} worlds of each density, {profile}", title_justify="left")
    for column in ("obstacles", "per m2", "avoidance", "collided", "kept again", *_rest(), "clearance", "settled p95"):
        table.add_column(column, justify="right")
    with ProcessPoolExecutor(workers) as pool:
        for obstacles in count or [6, 12, 18]:
            for avoid in (True, False) if alone else (True,):
                play = partial(outcome, count=obstacles, avoid=avoid, profile=profile)
                found = list(_watched(pool.map(play, seeds, chunksize=4), len(seeds), f"{obstacles} obstacles"))
                table.add_row(str(obstacles), f"{obstacles / ARENA_M2:.2f}", "yes" if avoid else "no", *_cells(found))
                report.append({"obstacles": obstacles, "avoidance": avoid, "worlds": [_plain(each) for each in found]})
    console.print(table)
    console.print(
        f"kept again: d within 50 mm and theta within 5 degrees for good, {SETTLE_S:g} s after the last obstacle at "
        f"most; goals: no collision, {GOAL_KEPT:.0%} kept. clearance: the least of all, from outline to outline. "
        "settled: after the last obstacle."
    )
    out.mkdir(parents=True, exist_ok=True)
    (out / "obstacles.json").write_text(json.dumps(report, indent=1) + "\n")


def _watched(outcomes, total: int, what: str):
    return track(outcomes, what, total=total, console=Console(stderr=True))


def _rest() -> list[str]:
    return [each.value for each in (Ending.LATE, Ending.LOST, Ending.BLOCKED)]


def _cells(found: list[Outcome]) -> list[str]:
    endings = Counter(each.ending for each in found)
    share: Callable[[Ending], str] = lambda ending: f"{endings[ending] / len(found):.1%}"  # noqa: E731
    settled = sorted(each.settled_s for each in found)
    p95_s = settled[max(math.ceil(0.95 * len(settled)) - 1, 0)]
    return [
        str(endings[Ending.COLLIDED]),
        share(Ending.KEPT),
        *(share(ending) for ending in (Ending.LATE, Ending.LOST, Ending.BLOCKED)),
        f"{1e3 * min(each.clearance_m for each in found):.0f} mm",
        f"{p95_s:.1f} s",
    ]


def _plain(found: Outcome) -> dict[str, object]:
    settled_s = found.settled_s if math.isfinite(found.settled_s) else None
    return {**asdict(found), "ending": found.ending.value, "settled_s": settled_s}


if __name__ == "__main__":
    typer.run(main)

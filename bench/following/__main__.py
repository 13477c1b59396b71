"""Four laws follow a leader in eight scenarios, on a rendered camera.

Takes: 40 minutes; 1 with --quick.
scripts/bench following                   5 seeds
scripts/bench following -- --quick        1 seed, drawn measurements instead of pictures
scripts/bench following -- --hardware nonideal --scenario line    a non-ideal robot, rendered
scripts/bench following -- --robots       robots and cameras that are not ideal, all laws; 3 minutes
"""

from __future__ import annotations

import json
import platform
from pathlib import Path
from typing import Annotated

import typer
from figures import figures_of, physical_limit_m
from limits import limit_curve
from play import play
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from robots import measure, table
from rows import LAWS, SCENARIOS, Figures, Row, make_rows

from pilotfish.harness.driving import BASELINES
from pilotfish.plots.comparison import draw_comparison
from pilotfish.plots.style import save
from pilotfish.recording import Recording

console = Console(width=150)
TITLES = {
    "line": "Leader on a line (the paper's Fig. 6, simulated)",
    "circle": "Leader on a circle (the paper's Fig. 7, simulated)",
}


def main(
    quick: Annotated[bool, typer.Option("--quick", help="One seed, drawn measurements instead of pictures.")] = False,
    seeds: Annotated[int, typer.Option(min=1, help="Runs of each scenario and law.")] = 5,
    robots: Annotated[bool, typer.Option("--robots", help="Robots that are not ideal, instead.")] = False,
    hardware: Annotated[
        str | None, typer.Option(help="The robot, a file of data/hardware, not in the coordinator's configuration.")
    ] = None,
    scenario: Annotated[list[str] | None, typer.Option(help="Only this one (may be repeated).")] = None,
    out: Annotated[Path, typer.Option(help="Folder for following.json, following.png and recordings.")] = Path("out"),
) -> None:
    """Compare profile anticipate with the law as published and with tuned baselines, and with its goals."""
    if robots:
        rows = measure(seeds)
        console.print(table(rows))
        out.mkdir(parents=True, exist_ok=True)
        (out / "robots.json").write_text(json.dumps(rows, indent=1) + "\n")
        return
    scenarios = tuple(scenario or SCENARIOS)
    measured, runs = _play_all(scenarios, 1 if quick else seeds, 1.0 if quick else None, hardware)
    rows = make_rows(measured)
    console.print(_table(rows))
    console.print(f"Physical limit of the closest approach: {1000 * physical_limit_m():.1f} mm")
    limits = [] if hardware else [row for row in rows if not row.met]
    curves = {f"{row.scenario}: {row.figure}": limit_curve(row.scenario, row.figure) for row in limits}
    for words, curve in curves.items():
        console.print(f"[yellow]not met[/] {escape(words)}: " + ", ".join(f"{k} {v:.3g}" for k, v in curve.items()))
    out.mkdir(parents=True, exist_ok=True)
    report = {"machine": platform.processor() or platform.machine(), "seeds": 1 if quick else seeds, "quick": quick}
    report |= {"figures": measured, "rows": [_as_json(row) for row in rows], "limits": curves}
    (out / "following.json").write_text(json.dumps(report, indent=1) + "\n")
    drawn = {TITLES[which]: runs[which] for which in scenarios if which in TITLES}
    if drawn:
        console.print(f"wrote {save(draw_comparison(drawn), out / 'following.png')}")


def _play_all(
    scenarios: tuple[str, ...], seeds: int, noise: float | None, hardware: str | None
) -> tuple[Figures, dict[str, dict[str, Recording]]]:
    measured: Figures = {which: {law: [] for law in LAWS} for which in scenarios}
    first: dict[str, dict[str, Recording]] = {which: {} for which in scenarios}
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("", total=len(scenarios) * len(LAWS) * seeds)
        for which in scenarios:
            for law in LAWS:
                for seed in range(1, seeds + 1):
                    bar.update(task, description=f"{which}, {law}, seed {seed}")
                    run = play(which, law, seed, noise=noise, hardware=hardware)
                    measured[which][law].append(figures_of(which, run))
                    first[which].setdefault(law, run)
                    bar.advance(task)
    return measured, first


def _table(rows: list[Row]) -> Table:
    table = Table(title="Following by sight: profile anticipate against its goals", title_justify="left")
    for column in ("scenario", "figure", "goal", "ours (worst)", "paper", *BASELINES, "ours / best baseline", "met"):
        table.add_column(column, justify="left" if column in ("scenario", "figure", "met") else "right")
    for row in rows:
        goal = (
            row.goal_text
            if row.goal_text[-1].isdigit() or row.goal == float("inf")
            else f"{row.goal_text} {row.goal:.3g}"
        )
        others = [f"{row.others[law]:.3g}" for law in ("paper", *BASELINES)]
        met = "-" if row.goal == float("inf") else "[green]yes[/]" if row.met else "[red]no[/]"
        table.add_row(row.scenario, escape(row.figure), goal, f"{row.ours:.3g}", *others, f"{row.ratio:.2g}", met)
    return table


def _as_json(row: Row) -> dict[str, object]:
    return {
        "scenario": row.scenario,
        "figure": row.figure,
        "goal": row.goal if row.goal != float("inf") else None,
        "ours": row.ours,
        "others": row.others,
        "met": row.met,
    }


if __name__ == "__main__":
    typer.run(main)

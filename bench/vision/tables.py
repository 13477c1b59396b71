"""Figures as tables for the terminal."""

from __future__ import annotations

from rich.table import Table

from bench.vision.accuracy import Cells
from bench.vision.chains import Results
from bench.vision.goals import Goal
from bench.vision.summary import Figures
from bench.vision.units import fraction, mm, ms, percent
from bench.vision.without_leader import Verdict


def figures_table(title: str, figures: dict[str, Figures]) -> Table:
    """One row a tracker, one sequence."""
    table = Table(title=title, title_justify="left")
    columns = ("seen", "median", "p95", "bias", "normals > 10°", "headings > 10°", "time", "cold")
    table.add_column("tracker")
    for column in columns:
        table.add_column(column, justify="right")
    for name, f in figures.items():
        errors = (mm(f.median_mm), mm(f.p95_mm), mm(f.bias_mm, "+"))
        shares = (percent(f.normals_wrong), percent(f.headings_wrong))
        table.add_row(name, percent(f.seen), *errors, *shares, ms(f.median_ms), ms(f.cold_ms))
    return table


def accuracy_tables(cells: Cells) -> list[Table]:
    """One table a cell."""
    return [
        figures_table(f"{size}, {distance_m} m, {next(iter(figures.values())).frames} frames", figures)
        for size, by_distance in cells.items()
        for distance_m, figures in by_distance.items()
    ]


def chain_tables(results: Results) -> list[Table]:
    """One table a condition."""
    tables = []
    for name, by_distance in results.items():
        table = Table(title=name, title_justify="left")
        table.add_column("distance")
        table.add_column("tracker")
        for column in ("seen", "median", "p95", "heading", "p95", "chi2/dof", "> 8°", "> 5 sd", "time"):
            table.add_column(column, justify="right")
        for distance_m, figures in by_distance.items():
            for tracker, f in figures.items():
                chi2 = "-" if f.chi2 != f.chi2 else f"{f.chi2:.2f}"
                degrees = [f"{value:.2f}°" for value in (f.median_deg, f.p95_deg)]
                errors = (
                    mm(f.median_mm),
                    mm(f.p95_mm),
                    *degrees,
                    chi2,
                    str(f.wrong),
                    "-" if chi2 == "-" else str(f.sure_and_wrong),
                )
                table.add_row(f"{distance_m} m", tracker, percent(f.seen), *errors, ms(f.median_ms))
        tables.append(table)
    return tables


def stage_table(mode: str, by_distance: dict[float, dict[str, float]]) -> Table:
    """One row a stage, one column a distance; medians add up to about the whole."""
    table = Table(title=f"where the time goes, {mode}: median of each stage [us]", title_justify="left")
    table.add_column("stage")
    for distance_m in by_distance:
        table.add_column(f"{distance_m} m", justify="right")
    stages = next((times for times in by_distance.values() if times), {})
    for stage in stages:
        table.add_row(stage, *(f"{times[stage]:.0f}" if times else "-" for times in by_distance.values()))
    table.add_row("sum", *(f"{sum(times.values()):.0f}" if times else "-" for times in by_distance.values()))
    return table


def medians_table(title: str, medians: dict[str, dict[str, float]]) -> Table:
    """`medians`: [mm] by column and tracker."""
    table = Table(title=title, title_justify="left")
    table.add_column("tracker")
    for column in medians:
        table.add_column(column, justify="right")
    for name in next(iter(medians.values())):
        table.add_row(name, *[mm(by_tracker[name]) for by_tracker in medians.values()])
    return table


def verdict_table(verdict: Verdict) -> Table:
    """What was taken for the leader."""
    table = Table(title="clutter, noise and other tags", title_justify="left")
    table.add_column("frames")
    table.add_column("shown", justify="right")
    table.add_column("observations", justify="right")
    table.add_row("without a leader", str(verdict.frames), str(verdict.wrong))
    table.add_row("with the leader, in between", str(verdict.shown), str(verdict.seen))
    return table


def goals_table(goals: list[Goal]) -> Table:
    """One row a goal."""
    table = Table(title="goals", title_justify="left")
    for column in ("goal", "bound", "best baseline", "ours"):
        table.add_column(column)
    table.add_column("ratio", justify="right")
    table.add_column("met")
    for goal in goals:
        met = "[green]yes[/]" if goal.met else "[red]no[/]"
        table.add_row(goal.name, goal.bound, goal.baseline, goal.ours, fraction(goal.ratio), met)
    return table

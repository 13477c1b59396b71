"""Figures as tables for the terminal."""

from __future__ import annotations

import math

from rich.table import Table

from bench.vision.accuracy import Cells
from bench.vision.summary import Figures


def figures_table(title: str, figures: dict[str, Figures]) -> Table:
    """One row an eye, one sequence."""
    table = Table(title=title, title_justify="left")
    columns = ("seen", "median", "p95", "bias", "normals > 10°", "headings > 10°", "time")
    table.add_column("eye")
    for column in columns:
        table.add_column(column, justify="right")
    for name, f in figures.items():
        shares = (percent(f.normals_wrong), percent(f.headings_wrong))
        table.add_row(
            name, percent(f.seen), mm(f.median_mm), mm(f.p95_mm), mm(f.bias_mm, "+"), *shares, ms(f.median_ms)
        )
    return table


def accuracy_tables(cells: Cells) -> list[Table]:
    """One table a cell."""
    return [
        figures_table(f"{size}, {distance_m} m, {next(iter(figures.values())).frames} frames", figures)
        for size, by_distance in cells.items()
        for distance_m, figures in by_distance.items()
    ]


def mm(value: float, sign: str = "") -> str:
    return "-" if math.isnan(value) else f"{value:{sign}.2f} mm" if abs(value) < 10 else f"{value:{sign}.0f} mm"


def ms(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3f} ms" if value < 1 else f"{value:.1f} ms"


def percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{100 * share:.1f} %"

"""What came of a campaign: pictures and tables."""

from __future__ import annotations

import csv
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import console, friendly_errors, print_whole, warn
from pilotfish.cli.options import DarkOption
from pilotfish.cli.outputs import Output, output_file, output_picture
from pilotfish.errors import ConfigError

if TYPE_CHECKING:
    from rich.table import Table

    from pilotfish.sweep.results import Results

OutArgument = Annotated[Path, typer.Argument(metavar="OUT", help="The folder of a campaign's results.")]
MetricOption = Annotated[
    str, typer.Option(help="The figure: a column of the results (`pilotfish sweep --describe`), or failed_percent.")
]
PictureOption = Annotated[
    Path | None,
    typer.Option("--out", dir_okay=False, help="The picture: .png, .svg or .pdf; default: in OUT, by what it shows."),
]
ByOption = Annotated[
    str | None, typer.Option(help="A factor (the end of its name is enough) whose values are compared.")
]
WhereOption = Annotated[
    list[str] | None,
    typer.Option(metavar="FACTOR=VALUE", help="Only runs of which this is so. Can be repeated."),
]
WORST = 5


class Interval(str, Enum):
    """How intervals of confidence are made."""

    t = "t"
    bootstrap = "bootstrap"


def plot(
    folder: OutArgument,
    over: Annotated[str, typer.Option(help="The factor on the x axis; the end of its name is enough (speed_mps).")],
    metric: MetricOption = "rms_distance_mm",
    by: ByOption = None,
    where: WhereOption = None,
    interval: Annotated[
        Interval,
        typer.Option(help="95 % intervals of the mean: Student's t, or percentiles of 2000 resamples (bootstrap)."),
    ] = Interval.t,
    logarithmic: Annotated[bool, typer.Option("--log", help="Logarithmic y axis.")] = False,
    out: PictureOption = None,
    dark: DarkOption = False,
) -> None:
    """Draw a figure over a factor: means of all runs there, with 95 % intervals.

    \b
    Examples
      pilotfish sweep plot out/laws --over speed_mps --by law --where robot=nonideal --log
      pilotfish sweep plot out/laws --metric failed_percent --over law
      pilotfish sweep plot out/cameras --over camera.latency_s --by camera --out latency.svg
    """
    from pilotfish.plots.style import DARK, LIGHT, save
    from pilotfish.plots.sweep import draw_sweep
    from pilotfish.sweep.intervals import curves
    from pilotfish.sweep.results import factor_label, metric_label

    with friendly_errors():
        results = _loaded(folder, where)
        name = results.factor(over)[0]
        drawn = curves(results, metric, over, by, interval.value)
        if not any(curve.intervals for curve in drawn):
            raise ConfigError(f"no run of {folder} has {metric}: `pilotfish sweep report {folder}` says why")
        if logarithmic and any(each.mean <= 0.0 for curve in drawn for each in curve.intervals):
            raise typer.BadParameter(f"--log: {metric} is not above 0 everywhere")
        picture = _picture(out, folder, f"{metric}_over_{name.rpartition('.')[2]}")
        only = f" ({', '.join(where)})" if where else ""
        title = f"{results.identity['scenario']}{only}: {metric_label(metric).partition(' [')[0]}"
        theme = DARK if dark else LIGHT
        figure = draw_sweep(drawn, factor_label(name), metric_label(metric), title, interval.value, logarithmic, theme)
        save(figure, picture.file)
        picture.wrote()


def sensitivity(
    folder: OutArgument,
    metric: MetricOption = "rms_distance_mm",
    by: ByOption = None,
    where: WhereOption = None,
    logarithmic: Annotated[
        bool, typer.Option("--log", help="Of the figure's logarithm, which a few very large values do not rule.")
    ] = False,
    out: PictureOption = None,
    dark: DarkOption = False,
) -> None:
    """Measure how much a figure depends on each factor that was sampled: a table and a picture, with 95 % intervals.

    Campaigns with `sampling: {method: sobol}` get Sobol's first-order and total indices, the others PAWN's.

    \b
    Examples
      pilotfish sweep sensitivity out/robot --log
      pilotfish sweep sensitivity out/robot --metric rms_jerk_mps3 --by law --out jerk.pdf
    """
    from rich import box
    from rich.table import Table

    from pilotfish.plots.style import DARK, LIGHT, save
    from pilotfish.plots.sweep import draw_sensitivity
    from pilotfish.sweep.results import factor_label, metric_label
    from pilotfish.sweep.sensitivity import sensitivities

    with friendly_errors():
        results = _loaded(folder, where)
        picture = _picture(out, folder, f"sensitivity_{metric}")
        found = sensitivities(results, metric, by, logarithmic)
        what = ("logarithm of the " if logarithmic else "") + metric_label(metric).partition(" [")[0]
        heads = ["first-order index", "total index"] if found[0].method == "sobol" else ["PAWN index"]
        for each in found:
            title = f"{what}{': ' if each.group else ''}{each.group} ({each.used} points)"
            table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD)
            table.add_column("factor", overflow="fold")
            for head in heads:
                table.add_column(head, justify="right", no_wrap=True)
            for name in sorted(each.total, key=lambda name: -each.total[name].value):
                pair = [indices[name] for indices in (each.first, each.total) if indices]
                table.add_row(name, *(f"{index.value:.3f} ± {index.half_width:.3f}" for index in pair))
            console.print(table)
            if each.left_out:
                warn(f"{each.left_out} points left out: no run has {metric} there, or in a point that belongs to them")
        labels = {name: factor_label(name) for name in found[0].total}
        figure = draw_sensitivity(found, labels, f"What the {what} depends on", DARK if dark else LIGHT)
        save(figure, picture.file)
        picture.wrote()


def report(
    folder: OutArgument,
    by: ByOption = None,
    where: WhereOption = None,
    metric: Annotated[
        list[str] | None, typer.Option(help="Figures in the table; can be repeated. Default: four of them.")
    ] = None,
    csv_file: Annotated[
        Path | None, typer.Option("--csv", dir_okay=False, help="Write all rows there, as CSV.")
    ] = None,
) -> None:
    """Print how the runs came out, the figures' means with 95 % t intervals, and the worst runs.

    \b
    Examples
      pilotfish sweep report out/laws --by law --where robot=nonideal
      pilotfish sweep report out/laws --metric rms_distance_mm --metric settling_s
      pilotfish sweep report out/laws --csv laws.csv
    """
    with friendly_errors():
        table_file = output_file(csv_file) if csv_file else None
        results = _loaded(folder, where)
        chosen = metric or [name for name in _USUAL if name in results.metrics] or results.metrics[:4]
        for name in chosen:
            results.metric(name)  # there, or an error
        outcomes = ", ".join(f"{count} {name}" for name, count in results.outcomes().most_common())
        console.print(f"{len(results)} runs: {outcomes}", highlight=False)
        table = _means_table(results, by, chosen)
        if console.is_terminal:
            console.print(table)
        else:
            print_whole(table, 40 + 30 * len(chosen))
        _print_reasons(results)
        _print_worst(results, chosen[0])
        if table_file:
            from pilotfish.whole_files import written_whole

            with written_whole(table_file.file) as partial, partial.open("w", newline="", encoding="utf-8") as stream:
                writer = csv.writer(stream, lineterminator="\n")
                writer.writerow(results.columns)
                writer.writerows(zip(*(column.tolist() for column in results.columns.values()), strict=True))
            table_file.wrote()


_USUAL = ("rms_distance_mm", "rms_bearing_deg", "rms_jerk_mps3", "failed_percent")


def _loaded(folder: Path, where: list[str] | None) -> Results:
    from pilotfish.sweep.results import load_results

    return load_results(folder).where(where or [])


def _picture(out: Path | None, folder: Path, stem: str) -> Output:
    return output_picture(out or folder / f"{stem}.png")


def _means_table(results: Results, by: str | None, metrics: list[str]) -> Table:
    import numpy as np
    from rich import box
    from rich.table import Table

    from pilotfish.sweep.intervals import t_interval

    table = Table(title="Mean ± half of the 95 % t interval", title_justify="left", box=box.SIMPLE_HEAD)
    table.add_column(by or "", no_wrap=True)
    table.add_column("runs", justify="right")
    for name in metrics:
        table.add_column(name, justify="right")
    groups = results.factor(by)[1] if by else np.full(len(results), "all")
    for group in dict.fromkeys(groups.tolist()):
        mask, cells = groups == group, []
        for name in metrics:
            values = results.metric(name)[mask]
            each = t_interval(values[np.isfinite(values)])
            half = each.high - each.mean
            cells.append("-" if not each.count else f"{each.mean:.4g}" + (f" ± {half:.2g}" if half == half else ""))
        table.add_row(f"{group:g}" if isinstance(group, float) else str(group), str(int(mask.sum())), *cells)
    return table


def _print_reasons(results: Results) -> None:
    """Of runs that could not be simulated, the commonest."""
    from collections import Counter

    errors = Counter(results.columns["reason"][results.columns["outcome"] == "error"].tolist())
    for reason, count in errors.most_common(WORST):
        console.print(f"{count} could not be simulated: {reason}", soft_wrap=True, highlight=False, markup=False)


def _print_worst(results: Results, metric: str) -> None:
    """Where to look: the runs with the largest figures, and how to see them."""
    import numpy as np

    values = results.metric(metric)
    known = np.flatnonzero(np.isfinite(values))
    worst = known[np.argsort(-values[known], kind="stable")][:WORST]
    console.print(f"largest {metric} (see one: `pilotfish sweep rerun FILE RUN`):", highlight=False, markup=False)
    for row in worst:
        said = ", ".join(f"{name.rpartition('.')[2]} {_short(results.columns[name][row])}" for name in results.factors)
        outcome = results.columns["outcome"][row]
        number = results.columns["run"][row]
        console.print(
            f"  run {number}: {values[row]:.4g}, {outcome}; {said}", soft_wrap=True, highlight=False, markup=False
        )


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)

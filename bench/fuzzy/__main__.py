"""Our inference beside fuzzylite, pyfuzzylite and scikit-fuzzy.

Takes: a minute.
Needs libfuzzylite-dev, an environment with bench/requirements/fuzzy.txt and a built tree; builds its C++ part itself.
"""

from __future__ import annotations

import platform
import sys
from pathlib import Path
from typing import Annotated

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import typer
from measure import Row, Width, as_json, batches, one_evaluation, table_error, widths
from picture import draw
from rich.console import Console
from rich.table import Table

from bench.common.compiled import RELEASE, built
from pilotfish import data, fuzzy

console = Console()


def main(
    quick: Annotated[bool, typer.Option("--quick", help="A tenth of the rounds: a look, not a result.")] = False,
    build: Annotated[Path, typer.Option(help="The build tree.")] = RELEASE,
    out: Annotated[Path, typer.Option(help="Folder for fuzzy.json and fuzzy.png.")] = Path("out/bench"),
) -> None:
    """Time the shipped controller against its baselines; print goals, ratios and what was met."""
    controller = fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))
    out.mkdir(parents=True, exist_ok=True)
    fll = out / "coordination.fll"
    fll.write_text(fuzzy.to_fll(controller))
    rows = one_evaluation(built("fuzzy/fuzzy_benchmark", build), fll, 100 if quick else 1000)
    rows += batches(controller, 10 if quick else 100)
    error = table_error(controller)
    curve = widths(controller, quick)
    machine = f"{_processor()}, {platform.system()} {platform.release()}, Python {platform.python_version()}"
    console.print(_table(rows, machine))
    console.print(f"A table of 257 x 257 values, bilinear: |du| up to {error:.1e}. No substitute.\n")
    console.print(_width_table(curve))
    (out / "fuzzy.json").write_text(as_json(rows, error, curve, machine) + "\n")
    console.print(f"wrote {out / 'fuzzy.json'} and {draw(rows, curve, out / 'fuzzy.png')}")


def _processor() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()


def _table(rows: list[Row], machine: str) -> Table:
    table = Table(
        title="Ours and its baselines, per evaluation", title_justify="left", caption=f"medians of ratios; {machine}"
    )
    table.add_column("ours")
    table.add_column("baseline, resolution")
    for heading in ("ours [ns]", "baseline [ns]", "ratio", "goal", "baseline |du|"):
        table.add_column(heading, justify="right")
    table.add_column("met")
    for r in rows:
        table.add_row(
            r.what,
            r.baseline,
            f"{r.ours_ns:.0f}",
            f"{r.baseline_ns:,.0f}",
            f"{r.ratio:,.0f}",
            f"{r.goal:,.0f}",
            f"{r.baseline_error:.1e}",
            "[green]yes[/]" if r.met else "[red]no[/]",
        )
    return table


def _width_table(curve: list[Width]) -> Table:
    table = Table(
        title="Inputs k sigma wide, against singletons at the same steady-state error",
        title_justify="left",
        caption="ratios of RMS changes from frame to frame: below 1 is smoother",
    )
    headings = ("sigma [mm]", "k", "stands at [mm]", "matched scale [m]", "wanted speed", "command", "distance")
    for heading in headings:
        table.add_column(heading, justify="right")
    for w in curve:
        shown = (w.matched_scale_m, w.wanted_change_ratio, w.command_change_ratio, w.distance_ratio)
        table.add_row(
            f"{w.sigma_m * 1e3:.0f}",
            f"{w.input_sigmas:g}",
            f"{w.steady_state_error_m * 1e3:.0f}",
            *("-" if x is None else f"{x:.2f}" for x in shown),
        )
    return table


if __name__ == "__main__":
    typer.run(main)

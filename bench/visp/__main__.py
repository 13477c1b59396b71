"""TagTracker in place of ViSP's vpDetectorAprilTag, on the same pictures: time and errors.

Takes: 5 minutes; 1 with --quick.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import typer
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from bench.common.compiled import RELEASE, built
from bench.visp.figures import FLIPPED_DEG, Figures, all_figures

console = Console()
REFERENCE = "ViSP, 1:1"  # the ratios are to it


def main(
    quick: Annotated[bool, typer.Option("--quick", help="60 pictures each: a look, not a result.")] = False,
    pictures: Annotated[int, typer.Option(min=30, help="Of each sequence.")] = 300,
    seed: Annotated[int, typer.Option(min=0, help="Of background and noise. Same seed: same pictures.")] = 1,
    build: Annotated[Path, typer.Option(help="The build tree.")] = RELEASE,
    out: Annotated[Path, typer.Option(help="Folder for visp.json.")] = Path("out/bench"),
) -> None:
    """Show one tag, then three at once, to each tracker; print time and error of each, and the ratio to ViSP."""
    program = built("visp/visp_benchmark", build)
    count = 60 if quick else pictures
    result: dict[str, object] = {
        "pictures": count,
        "seed": seed,
        "machine": platform.platform(),
        "cores": os.cpu_count(),
    }
    for tags in (1, 3):
        done = subprocess.run(
            [program, str(count), str(tags), str(seed)],
            check=True,
            text=True,
            stdout=subprocess.PIPE,
            env=os.environ | {"OMP_NUM_THREADS": "1"},
        )
        rows = all_figures([json.loads(line) for line in done.stdout.splitlines()])
        title = f"{count} pictures, {tags} tag{'s' if tags > 1 else ''}"
        console.print(_times(rows, title))
        console.print(_errors(rows, title))
        result[title] = [asdict(row) for row in rows]
    out.mkdir(parents=True, exist_ok=True)
    (out / "visp.json").write_text(json.dumps(result, indent=1) + "\n")
    console.print(f"wrote {out / 'visp.json'}")


def _times(rows: list[Figures], title: str) -> Table:
    reference = next(row for row in rows if row.tracker == REFERENCE)
    caption = f"ratio: time of '{REFERENCE}' over this one's"
    table = _table(f"{title}: time per picture, in ms", caption, ("median", "ratio", "mean", "ratio", "p95"))
    for row in rows:
        table.add_row(
            row.tracker,
            f"{row.median_ms:.2f}",
            f"{reference.median_ms / row.median_ms:.1f}",
            f"{row.mean_ms:.2f}",
            f"{reference.mean_ms / row.mean_ms:.1f}",
            f"{row.p95_ms:.2f}",
        )
    return table


def _errors(rows: list[Figures], title: str) -> Table:
    caption = f"RMS and mean of translation; RMS of rotation but for flips (> {FLIPPED_DEG:g} deg)"
    headings = ("seen", "mm", "mean x, y, z, mm", "deg", "flips")
    table = _table(f"{title}: errors", caption, headings)
    for row in rows:
        table.add_row(
            row.tracker,
            f"{100 * row.seen:.1f} %",
            f"{row.translation_rms_mm:.2f}",
            " ".join(f"{value:+.2f}" for value in row.bias_mm),
            f"{row.unflipped_rms_deg:.2f}",
            f"{row.flipped}",
        )
    return table


def _table(title: str, caption: str, headings: tuple[str, ...]) -> Table:
    table = Table(title=title, title_justify="left", caption=caption, box=SIMPLE)
    table.add_column("tracker", no_wrap=True)
    for heading in headings:
        table.add_column(heading, justify="right")
    return table


if __name__ == "__main__":
    typer.run(main)

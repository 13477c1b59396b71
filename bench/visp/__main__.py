"""TagTracker in place of ViSP's vpDetectorAprilTag, on the same pictures: time and errors.

Takes: 3 minutes; half a minute with --quick.
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
from rich.console import Console
from rich.table import Table

from bench.common.compiled import RELEASE, built
from bench.visp.figures import FLIPPED_DEG, Figures, all_figures

console = Console()
REFERENCE = "vpDetectorAprilTag, decimation 1"  # the ratios are to it


def main(
    quick: Annotated[bool, typer.Option("--quick", help="60 pictures each: a look, not a result.")] = False,
    pictures: Annotated[int, typer.Option(min=30, help="Of each sequence.")] = 300,
    seed: Annotated[int, typer.Option(min=0, help="Of background and noise. Same seed: same pictures.")] = 1,
    build: Annotated[Path, typer.Option(help="The build tree.")] = RELEASE,
    out: Annotated[Path, typer.Option(help="Folder for visp.json.")] = Path("out/bench"),
) -> None:
    """Show one tag, then three at once, to each eye in turns; print time and error of each, and the ratio to ViSP."""
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
        console.print(_table(rows, title))
        result[title] = [asdict(row) for row in rows]
    out.mkdir(parents=True, exist_ok=True)
    (out / "visp.json").write_text(json.dumps(result, indent=1) + "\n")
    console.print(f"wrote {out / 'visp.json'}")


def _table(rows: list[Figures], title: str) -> Table:
    reference = next(row for row in rows if row.eye == REFERENCE)
    table = Table(title=title, title_justify="left", caption=f"ratio: of {REFERENCE}'s time to this")
    table.add_column("eye")
    headings = (
        "median [ms]",
        "mean [ms]",
        "p95 [ms]",
        "ratio of medians",
        "of means",
        "seen",
        "translation RMS [mm]",
        "bias x, y, z [mm]",
        "rotation RMS [deg]",
        f"> {FLIPPED_DEG:g} deg off",
        "RMS of the others",
    )
    for heading in headings:
        table.add_column(heading, justify="right")
    for row in rows:
        table.add_row(
            row.eye,
            f"{row.median_ms:.2f}",
            f"{row.mean_ms:.2f}",
            f"{row.p95_ms:.2f}",
            f"{reference.median_ms / row.median_ms:.1f}",
            f"{reference.mean_ms / row.mean_ms:.1f}",
            f"{100 * row.seen:.1f} %",
            f"{row.translation_rms_mm:.2f}",
            ", ".join(f"{value:+.2f}" for value in row.bias_mm),
            f"{row.rotation_rms_deg:.2f}",
            f"{row.flipped}",
            f"{row.unflipped_rms_deg:.2f}",
        )
    return table


if __name__ == "__main__":
    typer.run(main)

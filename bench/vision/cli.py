"""The command line of `python bench/vision`."""

from __future__ import annotations

import json
import os
import platform
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from bench.vision import eyes as who
from bench.vision.accuracy import DISTANCES_M, accuracy
from bench.vision.compiled import load_compiled
from bench.vision.eyes import Cast
from bench.vision.peers import Wheels
from bench.vision.summary import as_json
from bench.vision.tables import accuracy_tables
from pilotfish.cli.console import progress

app = typer.Typer(add_completion=False, pretty_exceptions_show_locals=False)
console = Console()


@app.command()
def main(
    quick: Annotated[bool, typer.Option("--quick", help="A few frames of everything: does it run?")] = False,
    out: Annotated[Path, typer.Option(help="Where vision.json and the pictures go.")] = Path("out/bench"),
    seed: Annotated[int, typer.Option(help="Of all frames.")] = 1,
) -> None:
    """Pilotfish's eye beside its peers, on the same frames in the same run."""
    frames = {"640x480": 5, "1280x720": 3} if quick else {"640x480": 100, "1280x720": 80}
    vga = [
        who.TRACKED,
        who.ACQUIRED,
        who.VISP_1,
        who.VISP_2,
        who.LIBAPRILTAG,
        who.WHEEL,
        who.ARUCO_SUBPIX,
        who.ARUCO_APRILTAG,
    ]
    hd = [name for name in vga if name != who.ARUCO_APRILTAG]  # its refinement takes half a second there
    compiled = load_compiled(console.print)
    start = time.monotonic()
    with Wheels() as wheels:
        cast = Cast(compiled, wheels)
        total = len(DISTANCES_M) * sum(frames.values())
        with progress("accuracy and time") as step:
            done = 0

            def on_frame() -> None:
                nonlocal done
                done += 1
                step(done, total)

            cells = accuracy(
                lambda camera: cast.eyes(camera, vga if camera.width == 640 else hd), frames, seed, on_frame
            )
        for table in accuracy_tables(cells):
            console.print(table)
    result = {
        "machine": {"processor": platform.processor() or platform.machine(), "cores": os.cpu_count()},
        "versions": wheels.versions,
        "accuracy": {
            size: {str(d): {name: as_json(f) for name, f in by_name.items()} for d, by_name in by_distance.items()}
            for size, by_distance in cells.items()
        },
        "took_s": time.monotonic() - start,
    }
    out.mkdir(parents=True, exist_ok=True)
    (out / "vision.json").write_text(json.dumps(result, indent=1, allow_nan=False))
    console.print(f"wrote {out / 'vision.json'}")

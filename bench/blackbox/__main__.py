"""What the black box costs the thread that records: calls, commands, pictures.

Takes: half a minute.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Annotated

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import typer

from bench.common.compiled import RELEASE, built
from pilotfish import data


def main(
    frames: Annotated[int, typer.Option(min=1, help="So many times each.")] = 900,
    build: Annotated[Path, typer.Option(help="The build tree.")] = RELEASE,
    out: Annotated[Path, typer.Option(help="Where it records; nothing is left there.")] = Path("out/bench"),
) -> None:
    """Record 100 times a second, and time each call on the thread that makes it."""
    program = built("blackbox/black_box_benchmark", build)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out) as folder:
        command = [program, data.path("config/line.yaml"), folder, str(frames)]
        raise typer.Exit(subprocess.run(command, check=False).returncode)


if __name__ == "__main__":
    typer.run(main)

"""The compiled part of a benchmark, in the tree that scripts/build made."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RELEASE = ROOT / "build" / "release"


def built(program: str, tree: Path) -> Path:
    """`program`, given below bench/, is its target's name, too; built now if anything changed."""
    file = tree / "bench" / program
    subprocess.run(["cmake", "-D", "PILOTFISH_BENCH=ON", tree], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", tree, "--target", file.name], check=True, stdout=subprocess.DEVNULL)
    return file

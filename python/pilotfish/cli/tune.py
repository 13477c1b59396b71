"""``pilotfish tune``: find a law's parameters in simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.console import check_writable, console, friendly_errors, progress, tell
from pilotfish.cli.driving_options import Tunable


def tune(
    law: Annotated[Tunable, typer.Argument(help="A profile of the fuzzy law, or a baseline.")],
    trials: Annotated[
        int, typer.Option(min=1, max=1_000_000, help="Sets of parameters to try; some 0.7 s each.")
    ] = 200,
    seed: Annotated[int, typer.Option(min=0, max=2**32 - 1, help="Of the search and of the measurements' noise.")] = 1,
    out: Annotated[Path | None, typer.Option("-o", "--out", dir_okay=False, help="YAML to write.")] = None,
) -> None:
    """Search a law's parameters on a straight, a circling, a stopping and a cornering leader.

    Every law is tuned on the same cost, with the same search and budget. The result is a file for the coordinator's
    `tuning:` or `--tuning`.

    \b
    Example
      pilotfish tune pid --trials 200 --seed 1 -o pid.yaml
      pilotfish-coordinator --config data/config/line.yaml --law pid --tuning pid.yaml
    """
    from pilotfish.tuning import tune as search

    with friendly_errors():
        if out:
            check_writable(out)
        with progress(f"tuning {law.value}") as step:
            tuned = search(law.value, trials, seed, step)
        console.print(f"cost {tuned.cost_before:.3f} -> {tuned.cost:.3f}")
        for key, value in sorted(tuned.parameters.items()):
            console.print(f"  {key}: {value:.6g}")
        if out:
            tell(f"wrote {tuned.write(out)}")

"""``pilotfish tune``: find a law's parameters in simulation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import console, friendly_errors, progress, tell, warn
from pilotfish.cli.driving_options import Tunable
from pilotfish.cli.outputs import Output, output_file

if TYPE_CHECKING:
    from pilotfish.tuning import Tuned


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
    `tuning:` or `--tuning`. Ctrl-C ends the search with the best so far.

    \b
    Example
      pilotfish tune pid --trials 200 --seed 1 -o pid.yaml
      pilotfish-coordinator --config data/config/line.yaml --law pid --tuning pid.yaml
    """
    from pilotfish.tuning import searching

    tuned: Tuned | None = None
    with friendly_errors():
        target = output_file(out) if out else None
        try:
            with progress(f"tuning {law.value}") as step:
                for tuned in searching(law.value, trials, seed):
                    step(tuned.trials, trials)
        except KeyboardInterrupt:
            done = tuned.trials if tuned else 0
            warn(f"stopped after {done} of {trials} trials{'' if done else '; nothing is written'}")
            if tuned:
                _print(tuned, target, of=f" of {done}")
            raise
        assert tuned is not None, "one trial at least"
        _print(tuned, target)


def _print(tuned: Tuned, target: Output | None, of: str = "") -> None:
    """``of``: " of 25", of a search that was stopped."""
    better = tuned.cost < tuned.cost_before
    none = f"none of {tuned.trials} was better; the file has the values it began with"
    if better:
        console.print(f"cost {tuned.cost_before:.3f} -> {tuned.cost:.3f}")
    else:
        console.print(f"cost {tuned.cost_before:.3f}, with the values it began with: none of {tuned.trials} was better")
    for key, value in sorted(tuned.parameters.items()):
        console.print(f"  {key}: {value:.6g}")
    if target:
        tuned.write(target.file)
        target.wrote((f"the best{of}" if of else "") if better else none)
    elif of:
        tell("nothing is written: there is no --out")
